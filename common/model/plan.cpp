#include "model/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fissure::model {

Plan make_plan(scene::Scene const& scene, mesh::Mesh const& mesh) {
  Plan plan;
  auto const decide = [&](bool& flag, char const* what, bool modelled, std::string why) {
    flag = modelled;
    plan.decisions.push_back({what, modelled, std::move(why)});
  };
  auto const material = [&](scene::Body const& body) -> scene::Material const& {
    return scene.materials.at(body.material);
  };
  auto const cracks = [&](scene::Body const& body) { return material(body).joint.has_value(); };

  auto const n_cracking = std::count_if(scene.bodies.begin(), scene.bodies.end(), cracks);
  auto const n_bodies = static_cast<long>(scene.bodies.size());
  decide(plan.joints, "joints", n_cracking > 0,
         n_cracking > 0 ? fmt::format("{} of {} bodies have a material with fracture", n_cracking, n_bodies)
                        : "no material has a fracture part");
  auto const flows = [&](scene::Body const& body) { return material(body).flow.has_value(); };
  auto const n_flowing = std::count_if(scene.bodies.begin(), scene.bodies.end(), flows);
  decide(plan.plastic, "plastic flow", n_flowing > 0,
         n_flowing > 0 ? fmt::format("{} of {} bodies have a material with a plastic part", n_flowing, n_bodies)
                       : "no material has a plastic part");
  auto const averages = [&](scene::Body const& body) { return flows(body) && material(body).flow->averaged; };
  bool const averaged = std::any_of(scene.bodies.begin(), scene.bodies.end(), averages);
  if (plan.plastic)
    decide(plan.patches, "averaged pressure", averaged,
           averaged ? "plastic{ pressure = \"averaged\" }" : "every element has its own pressure");
  bool const blocks = !mesh.blocks.empty();
  decide(plan.blocks, "blocks", blocks, blocks ? "quadrilaterals or hexahedra" : "all cells are simplices");
  decide(plan.shared, "shared vertices", n_cracking < n_bodies,
         n_cracking < n_bodies ? "bodies that cannot crack need no vertices of their own for each cell"
                               : "every body can crack");

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

  auto const damped = [&](scene::Body const& body) {
    return material(body).viscosity > 0 || material(body).critical_share > 0;
  };
  bool const viscous = std::any_of(scene.bodies.begin(), scene.bodies.end(), damped);
  decide(plan.viscous, "viscous damping", viscous, viscous ? "a material has damping" : "no material has damping");
  for (auto const& material : scene.materials)
    plan.rubbing_joints =
        plan.rubbing_joints ||
        (material.joint && std::visit([](auto const& law) { return law.residual > 0; }, *material.joint));
  bool by_stress = false;
  for (int b = 0; b < mesh.n_bodies(); ++b) {
    auto const& joint = material(scene.bodies[b]).joint;
    by_stress = by_stress || (joint && starts_by_stress(*joint, mesh.n_simplices(b) > 0, mesh.n_blocks(b) > 0));
  }
  if (!scene.bonds.empty())
    plan.decisions.push_back({"bonds", true,
                              fmt::format("{} given, {} faces joined", scene.bonds.size(),
                                          std::count_if(mesh.bonded.begin(), mesh.bonded.end(),
                                                        [](mesh::BondedFace const& face) { return face.joined; }))});
  for (auto const& body : scene.bodies)
    plan.insertion =
        plan.insertion ||
        (material(body).joint && std::visit([](auto const& joint) { return joint.inserted; }, *material(body).joint));
  if (plan.insertion)
    plan.decisions.push_back(
        {"joints on demand", true, "bodies are whole until they reach their strength; only there is a joint inserted"});
  if (by_stress)
    plan.decisions.push_back(
        {"Rankine's criterion", true, "joints begin by the stress beside them, whichever way their faces lie"});
  if (plan.joints)
    plan.decisions.push_back(
        {"joint damper", true, "joints that have softened lose energy while pressed; booked as viscous"});
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

std::size_t bytes_foreseen(scene::Scene const& scene, mesh::Mesh const& mesh, std::size_t real) {
  Plan const plan = make_plan(scene, mesh);
  std::size_t const corners = mesh::node_count(mesh.kind), d = corners - 1, index = sizeof(Index);
  std::size_t const block_corners = mesh::block_corners(mesh.kind), faces = 2 * d, face_corners = block_corners / 2;
  std::size_t const at_a_joint =
      laws::joint_numbers + (plan.rubbing_joints ? d : 0);  // history and friction spring of a point
  std::size_t bytes = 0;
  for (int b = 0; b < mesh.n_bodies(); ++b) {
    auto const& material = scene.materials[scene.bodies[b].material];
    std::string const& integration = scene.bodies[b].mesh.integration;
    std::size_t const cells = mesh.body_first_cell[b + 1] - mesh.body_first_cell[b];
    std::size_t const simplices = mesh.n_simplices(b), blocks = mesh.n_blocks(b);
    std::size_t const slots = simplices * corners + blocks * block_corners;
    std::size_t const vertices = material.joint ? slots : mesh.body_first_node[b + 1] - mesh.body_first_node[b];
    bytes += cells * (corners * d * real + 1);            // reference coordinates, orientation
    bytes += vertices * (3 * d + 1) * real;               // displacements, velocities, forces, inverse masses
    if (plan.viscous || plan.joints) bytes += cells * 8;  // viscous work
    if (material.joint) {
      bytes += cells * (corners * (index + real) + 8);                       // links, areas, dissipation
      bytes += simplices * corners * ((d * at_a_joint + 3) * real + index);  // and stiffness, work, events
      bytes += blocks * faces * (face_corners * ((at_a_joint + 1) * real + index) + 3 * real + index);
      bytes += blocks * block_corners * d * real;
      if (starts_by_stress(*material.joint, simplices > 0, blocks > 0))
        bytes += cells * (6 * 8 + 1) + simplices * corners * d * real + blocks * faces * (d * real + index);
      if (std::visit([](auto const& joint) { return joint.inserted; }, *material.joint))
        bytes += (simplices * corners + blocks * faces * face_corners / d) * (d * d * real + 1) + slots * (index + 1);
    } else {
      bytes += slots * (d * real + index) + cells * corners * index + vertices * index;  // forces and lists of corners
    }
    if (material.flow) {
      bool const back = std::visit([]<class Law>(Law const&) { return Law::has_back; }, material.flow->law);
      std::size_t const stresses = d * (d + 1) / 2 + (3 - d);  // those in the model's space, and normal ones out of it
      std::size_t const numbers =
          stresses * (back ? 2 : 1) + 2 + material.flow->heat.on() + (scene.two_d == "plane stress");
      bool const one_point = integration != "full" && integration != "b_bar";
      std::size_t const points = simplices + blocks * (one_point ? 1 : block_corners);
      bytes += points * numbers * real + (cells + points) * 8;
    }
    // Numbers of the blocks' shapes (kernels/blocks.h), corners, dissipation.
    bytes += blocks * (((2 * block_corners - d - 1) * d + 2) * real + block_corners * index + (material.joint ? 8 : 0));
  }
  return bytes;
}

void require_room(Device const& device, scene::Scene const& scene, mesh::Mesh const& mesh, std::size_t real) {
  double const needed = static_cast<double>(bytes_foreseen(scene, mesh, real));
  double const room = static_cast<double>(device.room());
  if (needed <= room) return;
  double const fit = room / needed, cells = mesh.n_cells();
  double const coarser = std::pow(1 / fit, 1.0 / (mesh::node_count(mesh.kind) - 1));
  throw Error(
      fmt::format("this scene needs at least {:.2g} GB on {} for {:.2g} elements, and {:.2g} GB are free: about {:.2g} "
                  "elements fit; make mesh sizes {:.3g} times as large{}?",
                  needed * 1e-9, device.describe(), cells, room * 1e-9, fit * cells, coarser,
                  real == sizeof(double) ? ", or take --precision single" : ""));
}

std::string describe(Plan const& plan) {
  std::string text;
  for (auto const& decision : plan.decisions)
    text += fmt::format("  {:<3} {:<26} {}\n", decision.modelled ? "yes" : "no", decision.what, decision.why);
  return text;
}

}  // namespace fissure::model
