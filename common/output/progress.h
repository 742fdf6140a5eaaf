// Simulated time, share done, speed and time left: one line that changes on a terminal, lines now and then in a file or
// a pipe.
#pragma once
#include <chrono>
#include <cstdio>
#include <string>

namespace fissure::output {

/// "2.00 ms", "35.0 us", "1.20 s"
std::string short_time(double seconds);
/// "12 s", "3 min 20 s", "2 h 05 min"
std::string clock_time(double seconds);
/// The line itself; `rate` in ns per element and step, `left` in seconds, negative when not known yet.
std::string progress_line(double time, double end, double rate, double left);

class Progress {
 public:
  /// From simulated time `start` to `end` [s], over `elements` elements; says nothing when `stream` is null.
  Progress(double start, double end, long step, double elements, std::FILE* stream = stderr);
  ~Progress();
  Progress(Progress const&) = delete;
  Progress& operator=(Progress const&) = delete;

  /// Call as often as is handy: a terminal is redrawn at most five times a second, elsewhere a line is written for each
  /// tenth, but not more often than every 2 s nor less often than every 30 s. A run that will take more than an hour is
  /// told so after 3 s.
  void update(double time, long step);
  /// Clears the line, so that a message can be printed.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  bool due(double time, double since_last);

  double start_, end_, elements_;
  long first_step_;
  std::FILE* stream_;
  bool terminal_, drawn_ = false, judged_ = false;
  int tenths_ = 0;  // told of
  Clock::time_point began_, drawn_at_;
};

}  // namespace fissure::output
