// What a run says at its end: where its energy went, what pieces it broke into, and what contact cost.
#pragma once
#include <string>

#include "app/balance.h"

namespace fissure::app {

/// What contact between bodies and pieces cost, by samples.
class ContactCost {
 public:
  void look(Simulation const& simulation);
  /// A line; nothing where no cells ever came near each other. `timed`: steps whose stages were timed.
  std::string line(Simulation const& simulation, long timed) const;

 private:
  long samples_ = 0;  // with pairs of cells, and sums over those
  double pairs_ = 0, looked_at_ = 0, touching_ = 0;
};

/// Share of all mass that was crushed and removed [-].
double removed_share(scene::Now const& now);

/// The ledger as it is now, pieces, and how far it closes.
std::string energy_table(scene::Now const& now, EnergyBalance const& balance);

}  // namespace fissure::app
