#include "model/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fissure::model {

namespace {

/// What is decided for a scene; says why.
class Decisions {
 public:
  Decisions(scene::Scene const& scene, mesh::Mesh const& mesh) : scene_(scene), mesh_(mesh) {
    cracking_ = count([](scene::Material const& material) { return material.joint.has_value(); });
    fracture();
    cells();
    contact();
    damping();
    joints();
    loads();
  }
  Plan plan;

 private:
  void decide(bool& flag, char const* what, bool modelled, std::string why) {
    flag = modelled;
    plan.decisions.push_back({what, modelled, std::move(why)});
  }
  void note(char const* what, std::string why) { plan.decisions.push_back({what, true, std::move(why)}); }
  scene::Material const& material(scene::Body const& body) const { return scene_.materials.at(body.material); }
  /// How many bodies have a material that ...
  template <class Of>
  long count(Of&& of) const {
    return std::count_if(scene_.bodies.begin(), scene_.bodies.end(),
                         [&](scene::Body const& body) { return of(material(body)); });
  }
  long bodies() const { return static_cast<long>(scene_.bodies.size()); }

  void fracture() {
    decide(plan.joints, "joints", cracking_ > 0,
           cracking_ > 0 ? fmt::format("{} of {} bodies have a material with fracture", cracking_, bodies())
                         : "no material has a fracture part");
    long const flowing = count([](scene::Material const& material) { return material.flow.has_value(); });
    decide(plan.plastic, "plastic flow", flowing > 0,
           flowing > 0 ? fmt::format("{} of {} bodies have a material with a plastic part", flowing, bodies())
                       : "no material has a plastic part");
    bool const averaged =
        count([](scene::Material const& material) { return material.flow && material.flow->averaged; }) > 0;
    if (plan.plastic)
      decide(plan.patches, "averaged pressure", averaged,
             averaged ? "plastic{ pressure = \"averaged\" }" : "every element has its own pressure");
  }
  void cells() {
    bool const blocks = !mesh_.blocks.empty();
    decide(plan.blocks, "blocks", blocks, blocks ? "quadrilaterals or hexahedra" : "all cells are simplices");
    decide(plan.shared, "shared vertices", cracking_ < bodies(),
           cracking_ < bodies() ? "bodies that cannot crack need no vertices of their own for each cell"
                                : "every body can crack");
  }
  void contact() {
    auto const between = [&](bool modelled, std::string why) {
      decide(plan.pairs, "contact between elements", modelled, std::move(why));
    };
    if (!scene_.contact)
      between(false, "assume{ contact = false }");
    else if (bodies() > 1)
      between(true, fmt::format("{} bodies may meet", bodies()));
    else if (cracking_ > 0)
      between(true, "pieces of the body may meet");
    else if (!mesh::convex(mesh_, 0))
      between(true, "the body is not convex and may touch itself");
    else
      between(false, "one convex body that cannot crack has nothing to touch");
    decide(plan.plates, "plates", !scene_.plates.empty(), fmt::format("{} given", scene_.plates.size()));
    decide(plan.walls, "walls", !scene_.walls.empty(), fmt::format("{} given", scene_.walls.size()));
  }
  void damping() {
    bool const viscous = count([](scene::Material const& material) {
                           return material.viscosity > 0 || material.critical_share > 0;
                         }) > 0;
    decide(plan.viscous, "viscous damping", viscous, viscous ? "a material has damping" : "no material has damping");
  }
  void joints() {
    for (auto const& material : scene_.materials)
      plan.rubbing_joints =
          plan.rubbing_joints ||
          (material.joint && std::visit([](auto const& law) { return law.residual > 0; }, *material.joint));
    bool by_stress = false;
    for (int b = 0; b < mesh_.n_bodies(); ++b) {
      auto const& joint = material(scene_.bodies[b]).joint;
      by_stress = by_stress || (joint && starts_by_stress(*joint, mesh_.n_simplices(b) > 0, mesh_.n_blocks(b) > 0));
      plan.insertion = plan.insertion || (joint && std::visit([](auto const& law) { return law.inserted; }, *joint));
    }
    if (!scene_.bonds.empty())
      note("bonds", fmt::format("{} given, {} faces joined", scene_.bonds.size(),
                                std::count_if(mesh_.bonded.begin(), mesh_.bonded.end(),
                                              [](mesh::BondedFace const& face) { return face.joined; })));
    if (plan.insertion)
      note("joints on demand", "bodies are whole until they reach their strength; only there is a joint inserted");
    if (by_stress) note("Rankine's criterion", "joints begin by the stress beside them, whichever way their faces lie");
    if (plan.joints) note("joint damper", "joints that have softened lose energy while pressed; booked as viscous");
  }
  void loads() {
    bool const damped = scene_.run.mass_damping > 0, settles = scene_.settling.has_value();
    decide(plan.mass_damping, "mass-proportional damping", damped || settles,
           damped    ? "run{ mass_damping = } is given"
           : settles ? "while bodies settle"
                     : "run{} has no mass_damping");
    if (scene_.run.remove_crushed) {
      bool lone = false;
      for (int b = 0; b < mesh_.n_bodies(); ++b)
        lone = lone || (material(scene_.bodies[b]).joint && mesh_.n_simplices(b) > 0);
      plan.decisions.push_back({"removal of crushed cells", lone,
                                lone ? "run{ crushed = \"remove\" }: simplices that no joint holds any more"
                                     : "run{ crushed = \"remove\" }, but no body of simplices can crack"});
    }
    auto const& g = scene_.gravity;
    bool const heavy = g[0] != 0 || g[1] != 0 || g[2] != 0;
    decide(plan.gravity, "gravity", heavy, heavy ? "gravity{} is given" : "no gravity{}");
    std::size_t const loads =
        scene_.tractions.size() + scene_.pressures.size() + scene_.forces.size() + scene_.body_forces.size();
    decide(plan.loads, "tractions, pressures, forces", loads > 0, fmt::format("{} given", loads));
    for (auto const& excavation : scene_.excavations)
      note("excavation", fmt::format("{} of body \"{}\" leaves at {:.4g} s", excavation.within ? "a part" : "all",
                                     scene_.bodies[excavation.body].name, excavation.time));
    decide(plan.absorbs, "absorbing boundary", !scene_.absorbers.empty(),
           fmt::format("{} given", scene_.absorbers.size()));
    if (auto const rigid = std::ranges::count_if(scene_.bodies, &scene::Body::rigid); rigid > 0)
      note("rigid bodies", fmt::format("{} of {} bodies do not deform: their cells cost nothing", rigid, bodies()));
    if (!scene_.springs.empty()) note("springs", fmt::format("{} given", scene_.springs.size()));
    for (std::size_t k = 0; k < scene_.ties.size(); ++k) note("tie", tied(static_cast<int>(k)));
    if (auto const served =
            std::ranges::count_if(scene_.plates, [](scene::Plate const& plate) { return plate.servo.has_value(); });
        served > 0)
      note("servos", fmt::format("{} of {} plates", served, scene_.plates.size()));
    decide(plan.holds, "prescribed motion", !scene_.holds.empty(), fmt::format("{} given", scene_.holds.size()));
  }

  std::string tied(int tie) const {
    auto const of_tie = [tie](mesh::HungNode const& node) { return node.tie == tie; };
    auto const one = std::ranges::find_if(mesh_.hung, of_tie);
    return fmt::format("\"{}\": {} nodes of body \"{}\" hang on body \"{}\"", scene_.ties[tie].name,
                       std::ranges::count_if(mesh_.hung, of_tie), scene_.bodies[mesh_.body_of_node(one->node)].name,
                       scene_.bodies[mesh_.body_of_cell(one->cell)].name);
  }

  scene::Scene const& scene_;
  mesh::Mesh const& mesh_;
  long cracking_ = 0;  // bodies that can
};

}  // namespace

Plan make_plan(scene::Scene const& scene, mesh::Mesh const& mesh) { return Decisions(scene, mesh).plan; }

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
