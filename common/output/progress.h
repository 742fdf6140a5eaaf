// One line on a terminal: simulated time, share done, speed and time left. Silent when nobody watches.
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
  /// From simulated time `start` to `end` [s], over `elements` elements; draws on `stream` only when it is a terminal.
  Progress(double start, double end, long step, double elements, std::FILE* stream = stderr);
  ~Progress();
  Progress(Progress const&) = delete;
  Progress& operator=(Progress const&) = delete;

  /// Call as often as is handy: it redraws at most five times a second.
  void update(double time, long step);
  /// Clears the line, so that a message can be printed.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  double start_, end_, elements_;
  long first_step_;
  std::FILE* stream_;
  bool watched_, drawn_ = false;
  Clock::time_point began_, drawn_at_;
};

}  // namespace fissure::output
