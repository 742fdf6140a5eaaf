// The balance of a run's energy: what the experiment turned over, and what is missing at its end.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "app/run.h"

namespace fissure::app {

class EnergyBalance {
 public:
  explicit EnergyBalance(Experiment const& experiment);

  /// At every sample; the first is the start.
  void look();
  bool begun() const { return !start_.empty(); }
  /// The largest change of any term since the start, of those sampled [J].
  double turned_over() const { return turned_over_; }
  /// A term of the ledger at the start [J].
  double at_start(std::string const& term) const;

  /// What the residual is measured by [J], and its name: the energy turned over, for what a body flies, spins or weighs
  /// with hides nothing, and what it took and gave back again counts; else the largest term. Two limits of arithmetic:
  /// every step rounds every velocity once, at worst to the same side; and changes below half of the digits of the
  /// largest term are no experiment.
  std::pair<double, std::string> scale() const;
  /// Residual, whatever its sign, over its scale [-]; 0 for what rounding of places holds; not a number when any term
  /// is not.
  double off() const;

  /// For a restart: the terms at the start [J].
  std::vector<double> const& start() const { return start_; }
  void restore(std::vector<double> start, double turned_over);

 private:
  std::vector<double> terms() const;

  Experiment const& experiment_;
  std::vector<double> start_;
  double turned_over_ = 0;
  double const rounding_;  // rounding_energy() [J]
};

}  // namespace fissure::app
