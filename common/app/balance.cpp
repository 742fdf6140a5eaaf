// The balance of a run's energy.
#include "app/balance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fissure::app {

EnergyBalance::EnergyBalance(Experiment const& experiment)
    : experiment_(experiment), rounding_(rounding_energy(experiment)) {}

/// All of the ledger but what is missing [J].
std::vector<double> EnergyBalance::terms() const {
  std::vector<double> terms;
  for (auto const& name : scene::energy_names())
    if (name != "residual") terms.push_back(experiment_.simulation->now().energy(name));
  return terms;
}

void EnergyBalance::look() {
  auto const now = terms();
  if (start_.empty()) start_ = now;
  for (std::size_t k = 0; k < now.size(); ++k) turned_over_ = std::max(turned_over_, std::abs(now[k] - start_[k]));
}

double EnergyBalance::at_start(std::string const& term) const {
  std::size_t k = 0;
  for (auto const& name : scene::energy_names()) {
    if (name == term && k < start_.size()) return start_[k];
    if (name != "residual") ++k;
  }
  return 0;
}

std::pair<double, std::string> EnergyBalance::scale() const {
  auto const& simulation = *experiment_.simulation;
  double const unit = experiment_.options.precision == "single" ? std::numeric_limits<float>::epsilon()
                                                                : std::numeric_limits<double>::epsilon();
  double largest = 0;
  for (double term : terms()) largest = std::max(largest, std::abs(term));
  double const rounding = unit * static_cast<double>(simulation.step() + 1) * largest;
  bool const resolved =
      turned_over_ > std::sqrt(unit) * largest && std::abs(simulation.now().energy("residual")) > rounding;
  if ((turned_over_ < largest && resolved) || turned_over_ > 1.001 * largest)
    return {turned_over_, "energy turned over"};
  return {largest, "largest term"};
}

double EnergyBalance::off() const {
  double const residual = std::abs(experiment_.simulation->now().energy("residual"));
  return residual <= rounding_ ? 0 : residual / scale().first;
}

void EnergyBalance::restore(std::vector<double> start, double turned_over) {
  start_ = std::move(start), turned_over_ = turned_over;
}

}  // namespace fissure::app
