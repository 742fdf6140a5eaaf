#include "model/plan.h"

#include <fmt/format.h>

#include <algorithm>

namespace fissure::model {

Plan make_plan(scene::Scene const& scene, mesh::Mesh const& mesh) {
  Plan plan;
  auto const decide = [&](bool& flag, char const* what, bool modelled, std::string why) {
    flag = modelled;
    plan.decisions.push_back({what, modelled, std::move(why)});
  };
  auto const material = [&](scene::Body const& body) -> scene::Material const& { return scene.materials.at(body.material); };
  auto const cracks = [&](scene::Body const& body) { return material(body).joint.has_value(); };

  auto const n_cracking = std::count_if(scene.bodies.begin(), scene.bodies.end(), cracks);
  auto const n_bodies = static_cast<long>(scene.bodies.size());
  decide(plan.joints, "joints", n_cracking > 0,
         n_cracking > 0 ? fmt::format("{} of {} bodies have a material with fracture", n_cracking, n_bodies) : "no material has a fracture part");
  auto const flows = [&](scene::Body const& body) { return material(body).flow.has_value(); };
  auto const n_flowing = std::count_if(scene.bodies.begin(), scene.bodies.end(), flows);
  decide(plan.plastic, "plastic flow", n_flowing > 0,
         n_flowing > 0 ? fmt::format("{} of {} bodies have a material with a plastic part", n_flowing, n_bodies) : "no material has a plastic part");
  auto const averages = [&](scene::Body const& body) { return flows(body) && material(body).flow->averaged; };
  bool const averaged = std::any_of(scene.bodies.begin(), scene.bodies.end(), averages);
  if (plan.plastic)
    decide(plan.patches, "averaged pressure", averaged, averaged ? "plastic{ pressure = \"averaged\" }" : "every element has its own pressure");
  bool const blocks = !mesh.blocks.empty();
  decide(plan.blocks, "blocks", blocks, blocks ? "quadrilaterals or hexahedra" : "all cells are simplices");
  decide(plan.shared, "shared vertices", n_cracking < n_bodies,
         n_cracking < n_bodies ? "bodies that cannot crack need no vertices of their own for each cell" : "every body can crack");

  if (!scene.contact)
    decide(plan.pairs, "contact between elements", false, "assume{ contact = false }");
  else if (n_bodies > 1)
    decide(plan.pairs, "contact between elements", true, fmt::format("{} bodies may meet", n_bodies));
  else if (n_cracking > 0)
    decide(plan.pairs, "contact between elements", true, "pieces of the body may meet");
  else if (!mesh::convex(mesh, 0))
    decide(plan.pairs, "contact between elements", true, "the body is not convex and may touch itself");
  else
    decide(plan.pairs, "contact between elements", false, "one convex body that cannot crack has nothing to touch");
  decide(plan.plates, "plates", !scene.plates.empty(), fmt::format("{} given", scene.plates.size()));
  decide(plan.walls, "walls", !scene.walls.empty(), fmt::format("{} given", scene.walls.size()));

  auto const damped = [&](scene::Body const& body) { return material(body).viscosity > 0 || material(body).critical_share > 0; };
  bool const viscous = std::any_of(scene.bodies.begin(), scene.bodies.end(), damped);
  decide(plan.viscous, "viscous damping", viscous, viscous ? "a material has damping" : "no material has damping");
  if (plan.joints)
    plan.decisions.push_back({"joint damper", true, "joints that have softened lose energy while pressed; booked as viscous"});
  decide(plan.mass_damping, "mass-proportional damping", scene.run.mass_damping > 0,
         scene.run.mass_damping > 0 ? "run{ mass_damping = } is given" : "run{} has no mass_damping");
  auto const& g = scene.gravity;
  bool const heavy = g[0] != 0 || g[1] != 0 || g[2] != 0;
  decide(plan.gravity, "gravity", heavy, heavy ? "gravity{} is given" : "no gravity{}");
  decide(plan.loads, "tractions and pressures", !scene.tractions.empty() || !scene.pressures.empty(),
         fmt::format("{} given", scene.tractions.size() + scene.pressures.size()));
  decide(plan.holds, "prescribed motion", !scene.holds.empty(), fmt::format("{} given", scene.holds.size()));
  return plan;
}

std::string describe(Plan const& plan) {
  std::string text;
  for (auto const& decision : plan.decisions)
    text += fmt::format("  {:<3} {:<26} {}\n", decision.modelled ? "yes" : "no", decision.what, decision.why);
  return text;
}

}  // namespace fissure::model
