// What a run has recorded so far, for questions about what was: means over a time, whether it has come to rest.
#pragma once
#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace fissure {

/// Rows of the history: times, and values of columns, of which the last row may lack some yet.
class Recorded {
 public:
  void begin_row(double time) { time_.push_back(time); }
  void add(std::string const& column, double value) { values_[column].push_back(value); }
  bool has(std::string const& column) const { return values_.count(column) > 0 && !values_.at(column).empty(); }

  /// Mean over the last `duration` [s] of what has been recorded, straight between rows; its last value where that is
  /// all there is. Of a column that has() a value.
  double mean(std::string const& column, double duration) const {
    auto const& y = values_.at(column);
    std::size_t k = y.size() - 1;
    double const end = time_[k], begin = std::max(end - duration, time_[0]);
    if (!(end > begin)) return y[k];
    double sum = 0;
    for (; k > 0 && time_[k] > begin; --k) {
      double const share = std::min((time_[k] - begin) / (time_[k] - time_[k - 1]), 1.0),  // of the piece within
          first = y[k] + share * (y[k - 1] - y[k]);
      sum += share * (time_[k] - time_[k - 1]) * (first + y[k]) / 2;
    }
    return sum / (end - begin);
  }

  /// Whether a column has been at most this share of the largest that it ever was, for the last tenth of the time and
  /// ten rows: what swings is still for a moment.
  bool calm(std::string const& column, double share) const {
    if (!has(column)) return false;
    auto const& y = values_.at(column);
    double const since = 0.9 * time_[y.size() - 1], largest = *std::max_element(y.begin(), y.end());
    std::size_t k = y.size();
    while (k > 0 && (time_[k - 1] >= since || y.size() - k < 10)) {
      if (!(y[k - 1] <= share * largest)) return false;
      --k;
    }
    return largest > 0 && k > 0;
  }

 private:
  std::vector<double> time_;                           // [s]
  std::map<std::string, std::vector<double>> values_;  // by name
};

}  // namespace fissure
