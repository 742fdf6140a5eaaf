// What a run says at its end.
#include "app/summary.h"

#include <fmt/format.h>

namespace fissure::app {

void ContactCost::look(Simulation const& simulation) {
  auto const counts = simulation.contact_counts();
  if (counts.pairs == 0) return;
  ++samples_;
  pairs_ += static_cast<double>(counts.pairs), looked_at_ += static_cast<double>(counts.looked_at);
  touching_ += static_cast<double>(counts.touching);
}

std::string ContactCost::line(Simulation const& simulation, long timed) const {
  if (looked_at_ == 0 || timed == 0) return "";
  auto const& times = simulation.stage_times;
  double const all = times.elements + times.contact + times.loads + times.advance,
               samples = static_cast<double>(samples_), looked_at = looked_at_ / samples;
  return fmt::format(
      "contact: {:.2g} % of the time of steps; {:.3g} pairs of cells near each other, {:.3g} looked at in a step "
      "({:.0f} ns for each, all of contact together), {:.3g} touching (means of {} samples); {} lists of pairs so "
      "far\n",
      100 * times.contact / all, pairs_ / samples, looked_at,
      1e9 * times.contact / static_cast<double>(timed) / looked_at, touching_ / samples, samples_,
      simulation.contact_counts().lists);
}

double removed_share(scene::Now const& now) {
  double const gone = now.removed_mass();
  double mass = gone;
  for (auto const& piece : now.fragments(-1)) mass += piece.mass;
  return gone > 0 ? gone / mass : 0;
}

std::string energy_table(scene::Now const& now, EnergyBalance const& balance) {
  std::string text = "energy [J]\n ";
  long const gone = now.removed_pieces();
  for (auto const& name : scene::energy_names())
    if ((name != "removed" || gone > 0) &&
        ((name != "excavated" && !name.starts_with("spring")) || now.energy(name) != 0))  // few runs have any
      text += fmt::format(" {} {:.4g}", name, now.energy(name));
  if (double const fracture = now.energy("fracture"), cracks = now.crack_energy(); fracture > 0)
    text += fmt::format(
        "\n  of fracture {:.4g} went into {} joints that broke, {:.4g} into those that hold on and into friction in "
        "joints",
        cracks, now.broken_joints(), fracture - cracks > 1e-9 * fracture ? fracture - cracks : 0.0);
  if (gone > 0)
    text += fmt::format("\n  {} crushed pieces were removed, {:.3g} % of the mass", gone, 100 * removed_share(now));
  if (now.broken_joints() > 0)
    if (auto const pieces = now.fragments(-1); pieces.size() > 1) {
      double mass = 0;
      for (auto const& piece : pieces) mass += piece.mass;
      text += fmt::format("\n  {} pieces, the heaviest has {:.3g} % of the mass{}", pieces.size(),
                          100 * pieces[0].mass / mass, gone > 0 ? " that is left" : "");
    }
  return text + fmt::format("\n  balance closes to {:.2g} % of the {}\n", 100 * balance.off(), balance.scale().second);
}

}  // namespace fissure::app
