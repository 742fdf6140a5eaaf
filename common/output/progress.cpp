#include "output/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace fissure::output {

namespace {

/// Three digits: 0.85, 12.3, 900.
std::string three_digits(double value) {
  double const size = std::abs(value);
  return fmt::format("{:.{}f}", value, size >= 99.95 ? 0 : size >= 9.995 ? 1 : 2);
}

}  // namespace

std::string short_time(double seconds) {
  double const size = std::abs(seconds);
  for (auto const& [unit, name] : {std::pair{1.0, "s"}, std::pair{1e-3, "ms"}, std::pair{1e-6, "us"}})
    if (size >= 0.9995 * unit) return three_digits(seconds / unit) + " " + name;
  return seconds == 0 ? "0 s" : three_digits(seconds / 1e-9) + " ns";
}

std::string clock_time(double seconds) {
  long const s = std::lround(std::max(0.0, std::min(seconds, 1e9)));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s % 3600 / 60);
}

std::string progress_line(double time, double end, double rate, double left) {
  constexpr int width = 24;
  double const share = end > 0 ? std::clamp(time / end, 0.0, 1.0) : 1.0;
  std::string bar(static_cast<std::size_t>(std::floor(share * width)), '=');
  bar.resize(width, ' ');
  std::string line =
      fmt::format("[{}] {:3.0f} %  {} of {}", bar, std::floor(100 * share + 1e-9), short_time(time), short_time(end));
  if (rate > 0) line += "  " + three_digits(rate) + " ns per element and step";
  if (left >= 0) line += fmt::format("  {} left", clock_time(left));
  return line;
}

Progress::Progress(double start, double end, long step, double elements, std::FILE* stream)
    : start_(start),
      end_(end),
      elements_(elements),
      first_step_(step),
      stream_(stream),
      terminal_(stream && ::isatty(::fileno(stream)) == 1),
      began_(Clock::now()),
      drawn_at_(began_) {}

Progress::~Progress() { clear(); }

/// Whether something is to be said `since_last` seconds after the last time.
bool Progress::due(double time, double since_last) {
  if (terminal_) return !drawn_ || since_last >= 0.2;
  int const tenths = end_ > start_ ? static_cast<int>(std::floor(10 * (time - start_) / (end_ - start_))) : 10;
  if (since_last < 2 || (tenths <= tenths_ && since_last < 30)) return false;
  tenths_ = tenths;
  return true;
}

void Progress::update(double time, long step) {
  if (!stream_) return;
  auto const seconds = [](Clock::duration d) { return std::chrono::duration<double>(d).count(); };
  auto const now = Clock::now();
  double const spent = seconds(now - began_), done = time - start_, left = done > 0 ? spent * (end_ - time) / done : -1;
  // The first steps have to find out much that later ones know.
  if (!judged_ && done > 0 && spent > (step - first_step_ >= 100 ? 3 : 60)) {
    judged_ = true;
    if (spent + left > 3600) {
      clear();
      std::fprintf(stream_, "this run will take about %s as it goes now; Ctrl-C ends it, and restart goes on\n",
                   clock_time(spent + left).c_str());
    }
  }
  if (!due(time, seconds(now - drawn_at_))) return;
  double const work = static_cast<double>(step - first_step_) * elements_;
  std::fprintf(stream_, terminal_ ? "\r\033[K%s" : "%s\n",
               progress_line(time, end_, work > 0 ? 1e9 * spent / work : 0, left).c_str());
  std::fflush(stream_);
  drawn_ = terminal_;
  drawn_at_ = now;
}

void Progress::clear() {
  if (!drawn_) return;
  std::fputs("\r\033[K", stream_);
  std::fflush(stream_);
  drawn_ = false;
}

}  // namespace fissure::output
