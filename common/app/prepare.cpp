// From a scene file to something that can step, and what there is to say about it before it does.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "app/run.h"

namespace fissure::app {

Precision precision_of(std::string const& name) {
  if (name == "double") return Precision::double_;
  if (name == "single") return Precision::single;
  throw Error("unknown precision \"" + name + "\" (known: double, single)" + suggestion(name, {"double", "single"}));
}

namespace {

/// A joint holds strength^2/(2 stiffness) at its peak, the stiffness being the penalty over about half an edge: with
/// less than that it cannot break.
template <class Joint>
void judge_spring(Experiment& experiment, int body, Source const& source, std::string const& what, Joint const& joint,
                  double edge) {
  auto const judge = [&](char const* key, double strength, double G) {
    double const held = strength * strength * edge / (4 * joint.penalty);
    if (held < 0.7 * G) return;
    experiment.unresolved.push_back(
        {Grade::look_again, "energy of joints",
         fmt::format("{}{}: its joints hold about {:.3g} J/m2 at their peak, and {} is {:.3g} J/m2: they take more "
                     "than that when they break; a larger penalty or smaller elements mend it",
                     source.prefix(), what, held, key, G),
         body});
  };
  judge("G1", joint.tension, joint.G1);
  if (may_slide(joint)) judge("G2", joint.shear, joint.G2);  // else it is meant never to slide
}

/// Edges of a body where cracks are expected [m].
double edge_of_cracks(scene::Body const& body, mesh::Quality const& quality) {
  double edge = quality.mean_edge;
  for (auto const& near : body.mesh.near) edge = std::min(edge, near.size);
  return edge;
}

constexpr double resolved_edges = 3;  // of elements, that a process zone must be long

/// Lengths over which joints soften ahead of a crack that opens, and of one that slides [m] (Hillerborg, Modeer &
/// Petersson 1976, doi 10.1016/0008-8846(76)90007-7; Palmer & Rice 1973, doi 10.1098/rspa.1973.0040).
template <class Joint>
double opening_zone(double confined, Joint const& joint) {
  return confined * joint.G1 / (joint.tension * joint.tension);
}
template <class Joint>
double sliding_zone(double confined, Joint const& joint) {
  return confined * joint.G2 / (joint.shear * joint.shear);
}

/// Both against edges [m] of cells; `key` of mesh mends it.
template <class Joint>
void judge_zones(Experiment& experiment, int body, Source const& source, std::string const& what, Joint const& joint,
                 double confined, double edge, char const* key) {
  auto const judge = [&](std::vector<Finding>& found, double edges, double zone, char const* name,
                         char const* mesh_decides) {
    if (zone >= edges * edge) return;
    found.push_back(
        {Grade::look_again, "process zone",
         fmt::format("{}{}: its {} = {:.3g} m is {} ({:.3g} m): {} {} depend on the mesh; a mesh.{} of {:.2g} m "
                     "resolves it",
                     source.prefix(), what, name, zone,
                     zone < edge ? "shorter than an edge" : "shorter than three edges", edge, mesh_decides,
                     zone < edge ? "will" : "may", key, zone / resolved_edges),
         body});
  };
  judge(experiment.unresolved, resolved_edges, opening_zone(confined, joint), "process zone E' G1/ft^2",
        "the strength found");
  if (may_slide(joint))
    judge(experiment.unresolved_slip, 1, sliding_zone(confined, joint), "process zone of slip E' G2/shear^2",
          "where and when it slides");
}

/// Process zones of joints against edges and bodies: what is unresolved and what is no crack any more.
void judge_process_zones(Experiment& experiment) {
  auto const quality = mesh::quality(experiment.mesh);
  for (std::size_t b = 0; b < experiment.scene.bodies.size(); ++b) {
    auto const& body = experiment.scene.bodies[b];
    auto const& material = experiment.scene.materials[body.material];
    if (!material.joint) continue;
    double const confined = material.elastic().confined();
    double const edge = edge_of_cracks(body, quality[b]), width = mesh::width(experiment.mesh, static_cast<int>(b));
    double zone = 0;
    std::visit(
        [&](auto const& joint) {
          auto const what = fmt::format("body \"{}\"", body.name);
          char const* const key = body.mesh.near.empty() ? "size" : "near.size";
          zone = opening_zone(confined, joint);
          judge_spring(experiment, static_cast<int>(b), body.source, what, joint, quality[b].mean_edge);
          judge_zones(experiment, static_cast<int>(b), body.source, what, joint, confined, edge, key);
        },
        *material.joint);
    if (zone > 100 * width)
      experiment.scene.warnings.push_back(
          fmt::format("{}body \"{}\": its process zone E' G1/ft^2 = {:.3g} m is {:.2g} times as long as the body: it "
                      "will tear, not crack; is a unit wrong in E, G1 or tension?",
                      body.source.prefix(), body.name, zone, zone / width));
  }
  for (auto const& bond : experiment.scene.bonds) {
    double edge = 0, confined = INFINITY;
    for (int const b : bond.bodies) {
      edge = std::max(edge, quality[static_cast<std::size_t>(b)].mean_edge);
      confined =
          std::min(confined, experiment.scene.materials[experiment.scene.bodies[b].material].elastic().confined());
    }
    int const of_bonds = static_cast<int>(experiment.scene.bodies.size());
    auto const what = fmt::format("bond \"{}\"", bond.name);
    judge_zones(experiment, of_bonds, bond.source, what, bond.joint, confined, edge, "size");
    judge_spring(experiment, of_bonds, bond.source, what, bond.joint, edge);
  }
  for (auto const& finding : experiment.unresolved) experiment.scene.warnings.push_back(finding.why);
}

/// The smaller friction of two holds, and a body whose material says nothing of it has none.
void judge_friction(scene::Scene& scene) {
  std::string without;
  for (auto const& body : scene.bodies)
    if (auto const& contact = scene.materials[body.material].contact; !contact || !(contact->friction > 0))
      without += fmt::format("{}\"{}\"", without.empty() ? "" : ", ", body.name);
  auto const ask = [&](auto const& rigid, char const* kind) {
    if (without.empty() || !rigid.contact || !(rigid.contact->friction > 0)) return;
    scene.warnings.push_back(fmt::format(
        "{}{} \"{}\" has friction {:g}, but {} touches without: the smaller of both holds; give the material contact = "
        "{{ friction = {:g} }}",
        rigid.source.prefix(), kind, rigid.name, rigid.contact->friction, without, rigid.contact->friction));
  };
  for (auto const& plate : scene.plates) ask(plate, "plate");
  for (auto const& wall : scene.walls) ask(wall, "wall");
}

/// Says on standard error that meshing goes on, after 10 s and then every 30 s, for as long as it lives.
class StillMeshing {
 public:
  StillMeshing() : thread_([this](std::stop_token stop) { speak(stop); }) {}

 private:
  void speak(std::stop_token stop) {
    std::mutex mutex;
    std::unique_lock lock(mutex);
    std::condition_variable_any ended;
    for (int seconds = 10;; seconds += 30) {
      ended.wait_for(lock, stop, std::chrono::seconds(seconds == 10 ? 10 : 30), [] { return false; });
      if (stop.stop_requested()) return;
      fmt::print(stderr, "still meshing, since {} s\n", seconds);
    }
  }
  std::jthread thread_;
};

/// The mesh, with word of it where it takes long.
mesh::Mesh mesh_of(Program const& program, scene::Scene const& scene, bool quiet) {
  std::optional<StillMeshing> word;
  if (!quiet) word.emplace();
  return mesh::make_mesh(scene, *program.mesher);
}

}  // namespace

Experiment prepare(Program const& program, Options const& options, std::optional<StoredScene> const& stored) {
  Experiment experiment;
  experiment.options = options;
  experiment.device = Device::select(options.backend, options.threads, options.gpu);
  experiment.scene =
      stored ? lua::read_scene_text(stored->text, options.scene, program.dimension, options.settings, stored->modules)
             : lua::read_scene(options.scene, program.dimension, options.settings);
  experiment.mesh = mesh_of(program, experiment.scene, options.quiet);
  for (auto& hold : experiment.scene.holds)
    for (int const node : hold.around ? experiment.mesh.named_nodes.at(hold.body).at("all") : std::vector<int>{}) {
      Vec3 const from = experiment.mesh.nodes[node] - hold.around->through;
      hold.around->reach = std::max(hold.around->reach, from.cross(hold.around->axis).norm());
    }
  for (auto const& warning : mesh::warnings(experiment.scene, experiment.mesh))
    experiment.scene.warnings.push_back(warning);
  experiment.contact = mesh::starting_contact(experiment.scene, experiment.mesh);
  // a press fit is far below; the energy of more than that is all the run would show
  if (experiment.contact.deepest > 0.1) {
    std::string all;
    for (auto const& overlap : experiment.contact.overlaps) all += (all.empty() ? "" : "\n") + overlap;
    throw Error(all);
  }
  for (auto const& overlap : experiment.contact.overlaps) experiment.scene.warnings.push_back(overlap);
  experiment.strengths = mesh::joint_strengths(experiment.scene, experiment.mesh);
  for (auto const& doubt : experiment.strengths.doubts) experiment.scene.warnings.push_back(doubt);
  judge_process_zones(experiment);
  judge_friction(experiment.scene);
  model::require_room(experiment.device, experiment.scene, experiment.mesh,
                      precision_of(options.precision) == Precision::double_ ? sizeof(double) : sizeof(float));
  return experiment;
}

namespace {

std::string bytes_text(double bytes) {
  return bytes < 1e6   ? fmt::format("{:.0f} kB", bytes / 1e3)
         : bytes < 1e9 ? fmt::format("{:.1f} MB", bytes / 1e6)
                       : fmt::format("{:.2f} GB", bytes / 1e9);
}

/// Stress at which a bar in slow tension begins to flow [Pa].
double first_yield(scene::Flow const& flow) {
  return std::visit(
      [&]<class Law>(Law law) {
        if constexpr (std::is_base_of_v<laws::Curves, Law>) law.numbers = flow.curves.data();
        double const stress = law.yield(0.0, 0.0, 0.0).stress;
        if constexpr (std::is_same_v<Law, laws::DruckerPrager>) return stress / (1 + std::tan(law.friction_angle) / 3);
        return stress;
      },
      flow.law);
}

/// How often a wave along a bar crosses a body before slow tension would break it: strength/(density c v), as the
/// strain rate is v/length and the modulus density c^2. What is loaded in fewer crossings carries waves, not a state of
/// rest.
double crossings(double young, double density, double strength, double speed) {
  return strength / (std::sqrt(young * density) * speed);
}
constexpr double slow_crossings = 20;  // 5 % of the strength per crossing

/// Of a body's joints that hold at all, over those of its material.
double weakest(Experiment const& experiment, std::size_t body) {
  return experiment.strengths.least.empty() ? 1 : experiment.strengths.least[body];
}

/// How fast a body is loaded, for its strength.
std::string loading_line(Experiment const& experiment, std::size_t b, double tension) {
  auto const& body = experiment.scene.bodies[b];
  auto const& material = experiment.scene.materials[body.material];
  double const speed = loading_speed(experiment.scene, static_cast<int>(b));
  if (!(speed > 0)) return "";
  double strength = tension * weakest(experiment, b);
  bool glue = false;  // what breaks first may be a bond beside it
  for (auto const& bond : experiment.scene.bonds)
    if (std::find(bond.bodies.begin(), bond.bodies.end(), static_cast<int>(b)) != bond.bodies.end() &&
        bond.joint.tension < strength)
      strength = bond.joint.tension, glue = true;
  double const count = crossings(material.elastic().young, material.density, strength, speed);
  return fmt::format(
      "  {}: loaded at up to {:.3g} m/s from side to side, a wave crosses it {:.3g} times before tension would break "
      "{}{}\n",
      body.name, speed, count, glue ? "its bond" : "it",
      count < slow_crossings ? fmt::format("; from {:g} on it is a slow test", slow_crossings) : "");
}

/// What its mesh makes of a body's joints.
template <class Joint>
std::string mesh_lines(scene::Body const& body, mesh::Quality const& quality, laws::ElasticConstants const& elastic,
                       Joint const& joint) {
  double const h = edge_of_cracks(body, quality), length = opening_zone(elastic.confined(), joint),
               slip = may_slide(joint) ? sliding_zone(elastic.confined(), joint) : INFINITY;
  std::string text =
      fmt::format("  {}: process zone E' G1/ft^2 = {:.3g} mm, {:.1f} elements{}{}\n", body.name, length * 1e3,
                  length / h, body.mesh.near.empty() ? "" : " of the size that mesh.near asks for",
                  length < h                    ? ": unresolved, the strength found will depend on the mesh"
                  : length < resolved_edges * h ? ": coarse, 3 or more are advised"
                                                : "");
  if (slip < resolved_edges * h)
    text += fmt::format(
        "  {}: process zone of slip E' G2/shear^2 = {:.3g} mm, {:.1f} elements: {}\n", body.name, slip * 1e3, slip / h,
        slip < h ? "unresolved, where and when it slides will depend on the mesh" : "coarse, 3 or more are advised");
  if (joint.rankine && quality.blocks > 0 && quality.blocks < quality.cells)
    text += fmt::format(
        "  {}: blocks meet simplices in it: joints begin by their own traction, not by Rankine's criterion\n",
        body.name);
  if (joint.faster.points > 0)
    text += fmt::format(
        "  {}: joints are up to {:.3g} times as strong where their gaps grow fast; vibrations count, so damp what is "
        "slow\n",
        body.name, joint.faster.greatest());
  if (!body.mesh.regular() && body.mesh.seams.empty())  // docs/studies/mesh.md
    text += fmt::format(
        "  {}: cracks follow element faces: in 2D, bodies on meshes like this carried {} more than with a mesh.seam "
        "along the crack\n",
        body.name,
        joint.independent ? "3 to 57 %"
        : joint.rankine   ? (quality.blocks > 0 ? "up to 11 %" : "up to 12 %")
                          : (quality.blocks > 0 ? "up to 38 %" : "up to 24 %"));
  return text;
}

/// What a body's joints promise and what they cannot keep.
template <class Joint>
std::string joint_lines(Experiment const& experiment, std::size_t b, mesh::Quality const& quality, Joint const& joint) {
  auto const& body = experiment.scene.bodies[b];
  auto const& material = experiment.scene.materials[body.material];
  double const young = material.elastic().young;
  std::string text =
      joint.inserted
          ? fmt::format("  {}: whole until it reaches its strength; then joints of penalty {:.3g} E\n", body.name,
                        joint.penalty / young)
          : fmt::format("  {}: joints of penalty {:.3g} E leave about {:.3g} E of its stiffness (E/(1 + E/penalty))\n",
                        body.name, joint.penalty / young, 1 / (1 + young / joint.penalty));
  text += mesh_lines(body, quality, material.elastic(), joint);
  if (may_slide(joint))
    text += fmt::format(
        "  {}: joints open at {:.4g} MPa in tension; a slender specimen shears at {:.4g} MPa in compression (2 c "
        "cos(phi)/(1 - sin(phi)))\n",
        body.name, joint.tension / 1e6, compressive_strength(joint) / 1e6);
  text += loading_line(experiment, b, joint.tension);
  if (!material.flow) return text;
  double const yield = first_yield(*material.flow);
  return text + fmt::format(
                    "  {}: {}\n", body.name,
                    joint.tension < yield
                        ? fmt::format("it will crack before it flows: joints open at {:.4g} MPa, flow in tension "
                                      "begins at {:.4g} MPa",
                                      joint.tension / 1e6, yield / 1e6)
                        : fmt::format("it flows before it cracks: flow in tension begins at {:.4g} MPa, joints open at "
                                      "{:.4g} MPa",
                                      yield / 1e6, joint.tension / 1e6));
}

std::string material_lines(Experiment const& experiment) {
  std::string text;
  auto const quality = mesh::quality(experiment.mesh);
  for (std::size_t b = 0; b < experiment.scene.bodies.size(); ++b) {
    auto const& body = experiment.scene.bodies[b];
    auto const& material = experiment.scene.materials[body.material];
    if (material.flow && !material.flow->sampled.empty())
      text += fmt::format("  {}: {}\n", body.name, material.flow->sampled);
    if (!material.joint) continue;
    std::visit([&](auto const& joint) { text += joint_lines(experiment, b, quality[b], joint); }, *material.joint);
  }
  return text;
}

}  // namespace

std::vector<std::string> questions(Experiment const& experiment) {
  auto const& scene = experiment.scene;
  std::vector<std::string> lines;
  double const steps = scene.run.time / experiment.simulation->step_limit().dt;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    auto const& body = scene.bodies[b];
    double const width = mesh::width(experiment.mesh, static_cast<int>(b));
    if (!body.shape.mesh_file() && body.mesh.size > 2 * width)
      lines.push_back(
          fmt::format("{}body \"{}\": mesh.size = {:.3g} m, and the body is {:.3g} m wide; is a unit missing (3*mm)?",
                      body.source.prefix(), body.name, body.mesh.size, width));
    auto const& material = scene.materials[body.material];
    double const young = material.elastic().young,
                 tension =
                     material.joint ? std::visit([](auto const&joint) { return joint.tension; }, *material.joint) : 0;
    // Solids bear some thousandth of their stiffness, the best fibres a twentieth; far beyond it nothing is meant to
    // break.
    if (tension > 0.05 * young && tension < 2 * young)
      lines.push_back(fmt::format(
          "{}body \"{}\": a tensile strength of {:.3g} Pa is {:.2g} of Young's modulus, {:.3g} Pa: no solid is that "
          "strong; is a unit missing, or another (GPa for MPa)?",
          body.source.prefix(), body.name, tension, tension / young, young));
    if (steps < 10 && !scene.run.dt && width > 1)
      lines.push_back(
          fmt::format("{}body \"{}\" is {:.3g} m wide, and waves cross {:.1g} of its elements in the whole run of "
                      "{:.3g} s; are its lengths in millimetres (25*mm)?",
                      body.source.prefix(), body.name, width, steps, scene.run.time));
  }
  return lines;
}

Verdict foresee(Experiment& experiment) {
  Verdict verdict{foreseen(experiment)};
  auto& warnings = experiment.scene.warnings;
  auto const say = [&](std::string const& text) {
    if (std::find(warnings.begin(), warnings.end(), text) == warnings.end()) warnings.push_back(text);
  };
  for (auto const& finding : verdict.findings)
    if (finding.what != "step above its limit") say(finding.why);  // the simulation has said so
  for (auto const& question : questions(experiment)) say(question);
  return verdict;
}

std::string describe(Program const& program, Experiment const& experiment) {
  auto const& scene = experiment.scene;
  auto& simulation = *experiment.simulation;
  auto const& limit = simulation.step_limit();
  std::string text = fmt::format("{} {} on {}, {} precision\n", program.name, FISSURE_VERSION,
                                 simulation.device().describe(), experiment.options.precision);
  if (program.section) text += "section\n  " + program.section(scene) + "\n";
  text += "mesh\n";
  auto const integration_of = [&](std::size_t b) -> std::string {
    std::string const& word = scene.bodies[b].mesh.integration;
    if (experiment.mesh.n_blocks(static_cast<int>(b)) == 0) return "";
    return ", integration " + word +
           (word == "b_bar" && program.dimension == 2 && scene.two_d == "plane stress"
                ? " (full: in plane stress no cell keeps its volume)"
                : "");
  };
  auto const quality = mesh::quality(experiment.mesh);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    text += "  " + mesh::describe(scene.bodies[b].name, experiment.mesh.kind, quality[b]) + integration_of(b) + "\n";
  text += "modelled\n" + model::describe(simulation.plan());
  if (std::string const lines = material_lines(experiment); !lines.empty()) text += "materials\n" + lines;
  if (!experiment.strengths.lines.empty()) text += "joints\n";
  for (auto const& line : experiment.strengths.lines) text += "  " + line + "\n";
  if (!experiment.contact.gaps.empty()) text += "at the start\n";
  for (auto const& gap : experiment.contact.gaps) text += "  " + gap + "\n";
  double const steps = std::ceil(scene.run.time / limit.dt);
  text += fmt::format("time step\n  dt = {:.4g} s: {} (limit {:.4g} s, safety {:.2g})\n", limit.dt, limit.owner,
                      limit.stable, scene.run.safety);
  if (simulation.mass_scaled_share() > 0)
    text += fmt::format("  mass scaling adds {:.3g} times the true mass: for slow loading only\n",
                        simulation.mass_scaled_share());
  text +=
      fmt::format("memory\n  {} in {} arrays, {:.0f} bytes per element\n",
                  bytes_text(static_cast<double>(simulation.device().bytes())), simulation.device().arrays().size(),
                  static_cast<double>(simulation.device().bytes()) / static_cast<double>(simulation.element_count()));
  text += "run\n  ";
  if (scene.settling) text += fmt::format("{:.4g} s to settle, then ", simulation.settling_time());
  text += fmt::format("{:.4g} s in about {:.0f} steps", scene.run.time, steps);
  return text;
}

}  // namespace fissure::app
