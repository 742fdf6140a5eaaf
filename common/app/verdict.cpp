#include "app/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "app/run.h"

namespace fissure::app {
namespace {

char const* word(Grade grade) {
  return grade == Grade::ok ? "ok" : grade == Grade::look_again ? "look again" : "do not trust";
}

double const single_digits = std::numeric_limits<float>::epsilon();

int corners_of_vtk(int type) { return type == 5 ? 3 : type == 12 ? 8 : 4; }

/// Speeds that bodies begin with [m/s].
double initial_speed(scene::Body const& body) {
  return body.velocity_at ? 0 : Vec3(body.velocity[0], body.velocity[1], body.velocity[2]).norm();
}

/// Joints beside soft springs: what they leave of the body's stiffness.
void judge_compliance(Experiment const& experiment, Findings& found) {
  for (auto const& body : experiment.scene.bodies) {
    auto const& material = experiment.scene.materials[body.material];
    if (!material.joint) continue;
    auto const [penalty, inserted] = std::visit(
        [&](auto const& joint) { return std::pair(joint.penalty / material.elastic().young, joint.inserted); },
        *material.joint);
    if (penalty >= 9 || inserted) continue;
    found.push_back(
        {Grade::look_again, "joints too soft",
         fmt::format("{}body \"{}\": joints of penalty {:.3g} E leave {:.2g} of its stiffness; 20 E leave 0.95",
                     body.source.prefix(), body.name, penalty, penalty / (1 + penalty))});
  }
}

/// What moves faster than sound in what it moves needs laws of shocks, which there are none of.
void judge_speed(Experiment const& experiment, Findings& found) {
  // What flies together does not load itself: speeds of bodies from one to another, and from what stands still if there
  // is such.
  auto const& scene = experiment.scene;
  bool const alone = scene.plates.empty() && scene.walls.empty() && scene.holds.empty();
  double fastest = 0;
  for (auto const& body : scene.bodies) {
    if (!alone) fastest = std::max(fastest, initial_speed(body));
    for (auto const& other : scene.bodies)
      if (!body.velocity_at && !other.velocity_at)
        fastest = std::max(fastest, (Vec3(body.velocity.data()) - Vec3(other.velocity.data())).norm());
  }
  for (std::size_t b = 0; b < experiment.scene.bodies.size(); ++b) {
    auto const& body = experiment.scene.bodies[b];
    auto const& material = experiment.scene.materials[body.material];
    double const wave = std::sqrt(material.elastic().confined() / material.density),
                 speed = std::max(fastest, loading_speed(experiment.scene, static_cast<int>(b)));
    if (speed < wave) continue;
    found.push_back({Grade::do_not_trust, "faster than waves",
                     fmt::format("{}body \"{}\" is loaded at {:.4g} m/s, and its pressure waves travel at {:.4g} m/s: "
                                 "shocks need an equation of state, which no law here has",
                                 body.source.prefix(), body.name, speed, wave)});
  }
}

/// The opening of a joint at its peak against what single precision resolves of a displacement.
void judge_precision(Experiment const& experiment, double displacement, Findings& found) {
  if (experiment.options.precision != "single") return;
  auto const quality = mesh::quality(experiment.mesh);
  for (std::size_t b = 0; b < experiment.scene.bodies.size(); ++b) {
    auto const& body = experiment.scene.bodies[b];
    auto const& material = experiment.scene.materials[body.material];
    if (!material.joint) continue;
    auto const [tension, penalty] = std::visit(
        [](auto const& joint) {
          return std::array{joint.tension, joint.penalty};
        },
        *material.joint);
    double const opening = tension * quality[b].mean_edge / 2 / penalty,
                 digits = opening / (single_digits * displacement);
    if (!(digits < 30)) continue;
    found.push_back(
        {digits < 5 ? Grade::do_not_trust : Grade::look_again, "single precision",
         fmt::format(
             "{}body \"{}\": its joints open by {:.2g} m at their peak, and single precision resolves {:.2g} m of a "
             "displacement of {:.2g} m: stress in them is good to {:.2g} %; take double precision or a smaller penalty",
             body.source.prefix(), body.name, opening, single_digits * displacement, displacement, 100 / digits)});
  }
}

/// What is stiff and has moved far bears a stress of rounding: every step rounds displacements, by 0.3 of what is
/// resolved on average, and the vibrations that this excites add up like a random walk over the steps that damping
/// remembers. Asked while bodies are loaded, against the stress of the scene.
void judge_stress_precision(Experiment const& experiment, Findings& found) {
  if (experiment.options.precision != "single") return;
  auto const topology = experiment.simulation->topology();
  auto const frame = experiment.simulation->frame({"displacement", "von_mises", "pressure", "body"});
  std::map<std::string, std::vector<double> const*> field;
  for (auto const* fields : {&frame.point_fields, &frame.cell_fields})
    for (auto const& one : *fields) field[one.name] = &one.values;
  std::size_t const bodies = experiment.scene.bodies.size();
  std::vector<double> moved(bodies, 0), squares(bodies, 0), cells(bodies, 0);
  std::size_t corner = 0;
  for (std::size_t cell = 0; cell < field.at("body")->size(); ++cell) {
    auto const b = static_cast<std::size_t>((*field.at("body"))[cell]);
    double const shear = (*field.at("von_mises"))[cell], pressure = (*field.at("pressure"))[cell];
    squares[b] += shear * shear + pressure * pressure, ++cells[b];
    for (int a = 0; a < corners_of_vtk(topology.types[cell]); ++a)
      moved[b] = std::max(moved[b], Vec3(&(*field.at("displacement"))[3 * topology.cells[corner++]]).norm());
  }
  double stress = 0;
  for (std::size_t b = 0; b < bodies; ++b) stress = std::max(stress, std::sqrt(squares[b] / cells[b]));
  auto const quality = mesh::quality(experiment.mesh);
  double const steps = static_cast<double>(experiment.simulation->step());
  for (std::size_t b = 0; b < bodies; ++b) {
    auto const& body = experiment.scene.bodies[b];
    auto const& material = experiment.scene.materials[body.material];
    if (material.flow || material.viscosity > 0 || material.critical_share > 0) continue;  // which take such vibrations
    double const remembered =
        std::min(steps, 1 / (experiment.scene.run.mass_damping * experiment.simulation->step_limit().dt + 1e-300));
    double const rounding = single_digits * moved[b] / quality[b].mean_edge * material.elastic().confined() *
                            std::max(1.0, 0.3 * std::sqrt(remembered));
    if (!(rounding > 0.05 * stress)) continue;
    found.push_back(
        {rounding > 0.2 * stress ? Grade::do_not_trust : Grade::look_again, "single precision",
         fmt::format("{}body \"{}\" has moved by {:.2g} m: rounding in single precision puts a stress of some {:.2g} "
                     "Pa into it, and stresses of the scene are {:.2g} Pa; take double precision or damping",
                     body.source.prefix(), body.name, moved[b], rounding, stress)});
  }
}

/// Root mean square of jumps of pressure between neighbouring cells over that of pressure itself, in bodies of
/// simplices that lock where volume is kept: 2 on a checkerboard, near 0 where pressure is smooth.
void judge_locking(Experiment const& experiment, Findings& found) {
  auto const& mesh = experiment.mesh;
  if (!mesh.blocks.empty()) return;  // they have remedies of their own
  // where the thickness follows nothing locks
  if (mesh::node_count(mesh.kind) == 3 && experiment.scene.two_d == "plane stress") return;
  auto const prone = [&](scene::Body const& body) {
    auto const& material = experiment.scene.materials[body.material];
    double const poisson = material.elastic().poisson;
    return material.flow ? !material.flow->averaged : poisson > 0.45;
  };
  if (std::none_of(experiment.scene.bodies.begin(), experiment.scene.bodies.end(), prone)) return;
  auto const frame = experiment.simulation->frame({"pressure", "plastic_strain"});
  std::map<std::string, std::vector<double> const*> field;
  for (auto const& one : frame.cell_fields) field[one.name] = &one.values;
  auto const across = mesh::neighbours(mesh);
  int const corners =
      mesh::node_count(mesh.kind);  // cells of a frame are those of the mesh, in order, where there are no blocks
  auto const& pressure = *field.at("pressure");
  for (std::size_t b = 0; b < experiment.scene.bodies.size(); ++b) {
    auto const& body = experiment.scene.bodies[b];
    if (!prone(body)) continue;
    auto const& flow = experiment.scene.materials[body.material].flow;
    bool const flows = flow.has_value(), may_average = flows && !std::holds_alternative<laws::DruckerPrager>(flow->law);
    double jumps = 0, squares = 0, count = 0;
    for (int cell = mesh.body_first_cell[b]; cell < mesh.body_first_cell[b + 1]; ++cell)
      for (int a = 0; a < corners; ++a) {
        int const other = across[static_cast<std::size_t>(cell) * corners + a];
        if (other <= cell || other >= mesh.body_first_cell[b + 1]) continue;
        if (flows && !(field.at("plastic_strain")->at(cell) > 0.01 && field.at("plastic_strain")->at(other) > 0.01))
          continue;  // where it does not flow nothing locks
        double const p = pressure[cell], q = pressure[other];
        jumps += (p - q) * (p - q), squares += (p * p + q * q) / 2, ++count;
      }
    if (count < 20 || !(jumps > 0.5 * squares)) continue;
    found.push_back(
        {Grade::look_again, "pressure checkerboard",
         fmt::format("{}body \"{}\": pressure jumps between neighbouring cells by {:.2g} of what it is (root mean "
                     "squares): simplices of one pressure each lock where volume is kept; {}",
                     body.source.prefix(), body.name, std::sqrt(jumps / squares),
                     may_average
                         ? "plastic{ pressure = \"averaged\" } or blocks with integration = \"b_bar\" are advised"
                         : "blocks with integration = \"b_bar\" are advised")});
  }
}

/// Whether a body's flow takes elastic strain to be small, as the Jaumann rate does.
bool small_elastic_strain(scene::Scene const& scene, scene::Body const& body) {
  auto const& flow = scene.materials[body.material].flow;
  return flow && !flow->logarithmic;
}

/// Elastic shear strain of bodies where they hold their energy [-]: the root of its mean square, each cell by the
/// square of its stress. A short neck in a long bar counts, and a corner that one cell sees does not.
std::vector<double> elastic_strain(Simulation const& simulation, scene::Scene const& scene) {
  auto const frame = simulation.frame({"von_mises", "body"});
  std::map<std::string, std::vector<double> const*> field;
  for (auto const& one : frame.cell_fields) field[one.name] = &one.values;
  std::vector<double> weights(scene.bodies.size(), 0), strains(scene.bodies.size(), 0);
  for (std::size_t cell = 0; cell < field.at("body")->size(); ++cell) {
    auto const b = static_cast<std::size_t>((*field.at("body"))[cell]);
    double const energy = std::pow((*field.at("von_mises"))[cell], 2);
    weights[b] += energy, strains[b] += energy * energy;
  }
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    strains[b] = weights[b] > 0 ? std::sqrt(strains[b] / (3 * weights[b])) /
                                      (2 * scene.materials[scene.bodies[b].material].elastic().shear())
                                : 0;
  return strains;
}

/// What stress shows of a body's mesh.
struct StressJumps {
  double ratio = 0;   // mean square of the jumps of stress between neighbouring cells over that of stress [-]
  double energy = 0;  // of that stress, about [J]; 2D: per thickness
};

/// By body, where cells are simplices of one stress each and no flow levels it. Where stress runs linearly through n
/// cells of a depth, as in bending, the ratio falls with 1/n^2, like the error of energy, whose simplest estimator it
/// is (O. C. Zienkiewicz, J. Z. Zhu 1987, doi 10.1002/nme.1620240206).
std::vector<StressJumps> stress_jumps(Experiment const& experiment, std::vector<int> const& across,
                                      std::vector<mesh::Quality> const& quality) {
  auto const& mesh = experiment.mesh;
  auto const frame = experiment.simulation->frame({"stress"});
  auto const& stress = frame.cell_fields.front().values;
  int const corners = mesh::node_count(mesh.kind);
  std::vector<StressJumps> found(experiment.scene.bodies.size());
  for (std::size_t b = 0; b < found.size(); ++b) {
    auto const& material = experiment.scene.materials[experiment.scene.bodies[b].material];
    if (material.flow) continue;
    double whole = 0, jumps = 0, counted = 0;
    std::vector<std::array<double, 2>> faces;  // of each: square of the jump, mean square of the stresses [Pa^2]
    for (int cell = mesh.body_first_cell[b]; cell < mesh.body_first_cell[b + 1]; ++cell)
      for (int a = 0; a < corners; ++a) {
        int const other = across[static_cast<std::size_t>(cell) * corners + a];
        if (other <= cell || other >= mesh.body_first_cell[b + 1]) continue;
        auto& [jump, square] = faces.emplace_back();
        for (int k = 0; k < 6; ++k) {
          double const p = stress[6 * static_cast<std::size_t>(cell) + k];
          double const q = stress[6 * static_cast<std::size_t>(other) + k];
          double const both_ways = k < 3 ? 1 : 2;  // shear stands twice in the tensor
          jump += both_ways * (p - q) * (p - q), square += both_ways * (p * p + q * q) / 2;
        }
        whole += square;
      }
    if (faces.size() < 4) continue;  // a cell or two, of a fragment
    // Under a point's load stress is never resolved: no face counts for more than four faces of the mean stress.
    double const mean = whole / static_cast<double>(faces.size());
    for (auto const& [jump, square] : faces) {
      double const share = square > 4 * mean ? 4 * mean / square : 1;
      jumps += share * jump, counted += share * square;
    }
    if (counted > 0) found[b] = {jumps / counted, mean * quality[b].measure / (2 * material.elastic().young)};
  }
  return found;
}

}  // namespace

double rounding_energy(Experiment const& experiment) {
  double reach = 0, energy = 0;
  for (Vec3 const& node : experiment.mesh.nodes) reach = std::max(reach, node.cwiseAbs().maxCoeff());
  auto const quality = mesh::quality(experiment.mesh);
  for (std::size_t b = 0; b < quality.size(); ++b) {
    double const strain = std::numeric_limits<double>::epsilon() * reach / quality[b].mean_edge;
    energy += experiment.scene.materials[experiment.scene.bodies[b].material].elastic().confined() *
              quality[b].measure * strain * strain;
  }
  return energy;
}

Grade Verdict::grade() const {
  Grade worst = Grade::ok;
  for (auto const& finding : findings) worst = std::max(worst, finding.grade);
  return worst;
}

std::string Verdict::line() const {
  std::string text = word(grade());
  std::vector<std::string> said;
  for (Grade const grade : {Grade::do_not_trust, Grade::look_again})
    for (auto const& finding : findings)
      if (finding.grade == grade && std::find(said.begin(), said.end(), finding.what) == said.end()) {
        text += (said.empty() ? ": " : ", ") + finding.what;
        said.push_back(finding.what);
      }
  return text;
}

output::Json Verdict::json() const {
  output::Json record = output::Json::object();
  record["grade"] = word(grade());
  output::Json reasons = output::Json::array();
  for (auto const& finding : findings) {
    output::Json reason = output::Json::object();
    reason["what"] = finding.what, reason["grade"] = word(finding.grade), reason["why"] = finding.why;
    reasons.push(reason);
  }
  record["reasons"] = reasons;
  return record;
}

double loading_speed(scene::Scene const& scene, int body) {
  std::vector<scene::Directions> movers;
  for (auto const& plate : scene.plates) movers.push_back(plate.velocity);
  for (auto const& hold : scene.holds)
    if (hold.body == body && !hold.around) movers.push_back(hold.velocity);
  double fastest = 0;
  constexpr int moments = 1000;
  for (int i = 0; i <= moments; ++i) {
    std::vector<Vec3> now;
    for (auto const& velocity : movers) {
      now.push_back(Vec3::Zero());
      for (int c = 0; c < 3; ++c)
        if (velocity[c]) now.back()[c] = (*velocity[c])(scene.run.time * i / moments);
    }
    for (auto const& hold : scene.holds)
      if (hold.body == body && hold.around) {
        double const t = scene.run.time * i / moments;
        now.emplace_back(hold.around->turning(t) * hold.around->reach + hold.around->outward(t), 0, 0);
      }
    for (std::size_t a = 0; a < now.size(); ++a) {
      fastest = std::max(fastest, now[a].norm());
      for (std::size_t b = 0; b < a; ++b) fastest = std::max(fastest, (now[a] - now[b]).norm());
    }
  }
  return fastest;
}

Findings foreseen(Experiment const& experiment) {
  auto const& scene = experiment.scene;
  Findings found = experiment.unresolved;
  judge_compliance(experiment, found);
  judge_speed(experiment, found);
  double path = 0;  // no body is moved further by what drives it
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    path =
        std::max(path, (loading_speed(scene, static_cast<int>(b)) + initial_speed(scene.bodies[b])) * scene.run.time);
  judge_precision(experiment, path, found);
  auto const& limit = experiment.simulation->step_limit();
  if (scene.run.dt && *scene.run.dt > limit.stable)
    found.push_back({Grade::do_not_trust, "step above its limit",
                     fmt::format("{}dt = {:.4g} s, and steps above {:.4g} s are not stable", scene.run.source.prefix(),
                                 *scene.run.dt, limit.stable)});
  return found;
}

void Watch::look(Experiment const& experiment) {
  auto const& scene = experiment.scene;
  auto const& simulation = *experiment.simulation;
  double const springs = simulation.now().energy("hourglass"), elastic = simulation.now().energy("elastic"),
               joints = simulation.now().energy("joint");
  double const kinetic = simulation.now().energy("kinetic");
  most_.hourglass = std::max(most_.hourglass, springs);
  most_.inside = std::max(most_.inside, springs + elastic + simulation.now().energy("plastic"));
  most_.kinetic = std::max(most_.kinetic, kinetic);
  most_.given = std::max(most_.given, std::max(-joints, 0.0) + std::max(-simulation.now().energy("contact"), 0.0));
  if (double const stored = elastic + joints; stored > most_.stored)
    most_.stored = stored, most_.inertia = kinetic + simulation.now().energy("mass_damping"),
    most_.spent = simulation.now().energy("fracture") + simulation.now().energy("plastic");
  auto const& limit = simulation.step_limit();
  most_.step = std::max(most_.step, limit.dt / limit.stable);
  if (most_.drive < 0) most_.drive = simulation.now().extreme("velocity");
  strain_.resize(scene.bodies.size(), 0), jumps_.resize(scene.bodies.size(), 0);
  // Stress tells most where most of it is; asked again when there is a quarter more, so that it costs no more than some
  // frames. Of the mesh in slow loading alone: the front of a wave is as sharp as the mesh lets it be.
  if (experiment.mesh.blocks.empty() && elastic > 1.25 * most_.jumped && kinetic < 0.1 * elastic) {
    if (across_.empty()) across_ = mesh::neighbours(experiment.mesh);
    most_.jumped = elastic;
    auto const found = stress_jumps(experiment, across_, mesh::quality(experiment.mesh));
    double all = 0;
    for (auto const& of_body : found) all += of_body.energy;
    for (std::size_t b = 0; b < found.size(); ++b)
      jumps_[b] = found[b].energy > 0.01 * all ? found[b].ratio : 0;  // what holds nothing tells nothing
  }
  bool const asked = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                 [&](auto const& body) { return small_elastic_strain(scene, body); });
  if (!asked || !(elastic > 1.25 * most_.strained)) return;
  most_.strained = elastic;
  auto const strain = elastic_strain(simulation, scene);
  for (std::size_t b = 0; b < strain.size(); ++b) strain_[b] = std::max(strain_[b], strain[b]);
}

namespace {

void add(Findings& found, bool bad, std::string what, std::string why) {
  found.push_back({bad ? Grade::do_not_trust : Grade::look_again, std::move(what), std::move(why)});
}

void judge_contact(Simulation& simulation, Findings& found) {
  if (double const deepest = simulation.largest_penetration(); deepest > 0.95)
    add(found, true, "contact too soft",
        "contacts went past an element's centre, from where they push to the other side: pieces may have gone through "
        "each other, and contact holds energy that never comes back: do not trust this run; a larger contact penalty "
        "is needed");
  else if (deepest > 0.25)
    add(found, false, "contact too soft",
        fmt::format("contacts went {:.0f} % of the way to an element's centre; a larger contact penalty is advised",
                    100 * deepest));
}

}  // namespace

Findings Watch::findings(Experiment const& experiment, double turned_over) const {
  auto& simulation = *experiment.simulation;
  Findings found;
  judge_steps(experiment, found);
  judge_shares(experiment, turned_over, found);
  judge_contact(simulation, found);
  judge_locking(experiment, found);
  judge_strains(experiment, found);
  judge_precision(experiment, simulation.now().extreme("displacement"), found);
  if (simulation.now().energy("elastic") > 0.1 * most_.stored) judge_stress_precision(experiment, found);
  judge_jumps(experiment, found);
  judge_flying(experiment, found);
  return found;
}

void Watch::judge_steps(Experiment const& experiment, Findings& found) const {
  auto const& scene = experiment.scene;
  if (most_.step > 1 && !scene.run.dt)
    add(found, false, "step above its limit",
        fmt::format("steps went up to {:.3g} times the limit of stability, which fell faster than it was looked at",
                    most_.step));
  if (scene.run.dt && most_.step > 1)
    add(found, true, "step above its limit",
        fmt::format("{}dt went up to {:.3g} times the limit of stability", scene.run.source.prefix(), most_.step));
}

/// What is large beside the energy that was turned over [J].
void Watch::judge_shares(Experiment const& experiment, double turned_over, Findings& found) const {
  auto const& scene = experiment.scene;
  auto& simulation = *experiment.simulation;
  if (double const share = most_.hourglass / most_.inside;
      most_.hourglass > 0.05 * most_.inside && most_.hourglass > 1e-6 * turned_over)
    add(found, share > 0.75, "hourglass modes",
        fmt::format("springs against hourglass modes held up to {:.3g} % of what bodies held and had spent on flow (5 "
                    "% is much); a finer mesh or integration = \"{}\" is advised",
                    100 * share, simulation.now().energy("plastic") > 0 ? "b_bar" : "assumed_strain"));
  double const scaled = simulation.mass_scaled_share();
  if (scaled > 0.05 && most_.kinetic > 0.05 * turned_over && turned_over > 1e-9 * most_.kinetic)
    add(found, scaled > 1, "mass scaling",
        fmt::format("{}mass scaling added {:.2g} times the true mass, and motion held up to {:.2g} % of the energy "
                    "that was turned over (5 % is much): inertia matters here",
                    scene.run.source.prefix(), scaled, 100 * most_.kinetic / turned_over));
  if (most_.given > 0.02 * turned_over)
    add(found, most_.given > 0.1 * turned_over, "joints too soft",
        fmt::format("{}joints that were inserted and unloaded again gave {:.2g} % of the energy that was turned over, "
                    "which bodies never had (2 % is much): a larger fracture.penalty makes it less",
                    scene.run.source.prefix(), 100 * most_.given / turned_over));
  double const work = most_.inertia + most_.stored + most_.spent;
  double driven = 0;  // what only falls or springs back is no test that was loaded too fast
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    driven = std::max(driven, loading_speed(scene, static_cast<int>(b)));
  if (scene.run.mass_damping > 0 && driven > 0 && most_.stored > 1e-6 * turned_over && most_.inertia > 0.1 * work)
    add(found, most_.inertia > 0.5 * work, "loaded too fast",
        fmt::format("{}when bodies held most, {:.2g} % of the work until then had gone into motion and its damping (10 "
                    "% is much): this is no slow test; load more slowly",
                    scene.run.source.prefix(), 100 * most_.inertia / work));
}

void Watch::judge_strains(Experiment const& experiment, Findings& found) const {
  auto const& scene = experiment.scene;
  // Of a shear strain e the Jaumann rate gives sin(2e)/2: what is off grows with e^2, 0.7 % at 0.1 and 6 % at 0.3; and
  // a cycle of such strains no longer closes (docs/theory/plasticity.md).
  for (std::size_t b = 0; b < strain_.size(); ++b)
    if (auto const& body = scene.bodies[b]; small_elastic_strain(scene, body) && strain_[b] > 0.1)
      add(found, strain_[b] > 0.3, "large elastic strain",
          fmt::format("{}body \"{}\": its elastic shear strain went up to {:.2g} where it held its energy, and the "
                      "Jaumann rate is made for small ones; plastic{{ strain = \"logarithmic\" }} is advised, if the "
                      "material really bears that much",
                      body.source.prefix(), body.name, strain_[b]));
}

void Watch::judge_jumps(Experiment const& experiment, Findings& found) const {
  auto const& scene = experiment.scene;
  // Measured on beams: 0.3 where sag is 6 to 15 % too small, 0.5 and more where it is 30 to 40 %, 1 to 2 with one cell
  // over the depth.
  for (std::size_t b = 0; b < jumps_.size(); ++b)
    if (auto const& body = scene.bodies[b]; jumps_[b] > 0.5)
      add(found, false, "coarse mesh",
          fmt::format(
              "{}body \"{}\": stress jumps between neighbouring cells by {:.2g} of what it is (root mean squares), as "
              "where one or two cells lie over the depth of what bends: what bends is too stiff by a tenth to a half; "
              "a finer mesh, or blocks with integration = \"assumed_strain\", are advised",
              body.source.prefix(), body.name, std::sqrt(jumps_[b])));
}

void Watch::judge_flying(Experiment const& experiment, Findings& found) const {
  auto const& scene = experiment.scene;
  auto& simulation = *experiment.simulation;
  double drive = most_.drive, release = 0;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    auto const& material = scene.materials[scene.bodies[b].material];
    drive = std::max(drive, loading_speed(scene, static_cast<int>(b)));
    if (!material.joint) continue;
    double const strength = std::visit(
        [](auto const& joint) { return std::max(joint.tension, may_slide(joint) ? compressive_strength(joint) : 0.0); },
        *material.joint);
    release = std::max(release, strength / std::sqrt(material.elastic().young * material.density));
  }
  auto const frame = simulation.frame({"velocity"});
  double squares = 0, fastest = 0, nodes = 0;
  Vec3 place = Vec3::Zero();
  for (auto const& field : frame.point_fields)
    for (std::size_t i = 0; field.name == "velocity" && i + 3 <= field.values.size(); i += 3, ++nodes) {
      double const squared = Vec3(&field.values[i]).squaredNorm();
      squares += squared;
      if (squared > fastest) fastest = squared, place = Vec3(&frame.points[i]);
    }
  // In resonance much moves faster than what drives it; what a bad element threw away is alone.
  if (double const speed = std::sqrt(fastest);
      drive > 0 && speed > 20 * (drive + release) && speed > 20 * std::sqrt(squares / nodes))
    add(found, false, "flying nodes",
        fmt::format("a node near ({:.4g}, {:.4g}, {:.4g}) moves at {:.3g} m/s; what drives the scene and what a break "
                    "sets free move at {:.3g} m/s, all nodes on average at {:.3g}: a bad element threw it away? A "
                    "smaller run{{ safety }} or another mesh may help",
                    place.x(), place.y(), place.z(), speed, drive + release, std::sqrt(squares / nodes)));
}

std::vector<double> Watch::numbers() const {
  std::vector<double> all{most_.hourglass, most_.inside,  most_.stored, most_.inertia,
                          most_.spent,     most_.kinetic, most_.step,   most_.drive};
  for (double const more : {most_.jumped, most_.strained, most_.given}) all.push_back(more);
  for (auto const* of_bodies : {&strain_, &jumps_}) all.insert(all.end(), of_bodies->begin(), of_bodies->end());
  return all;
}

void Watch::restore(std::vector<double> const& n) {
  most_ = {n.at(0), n.at(1), n.at(2), n.at(3), n.at(4), n.at(5), n.at(6), n.at(7)};
  most_.jumped = n.at(8), most_.strained = n.at(9), most_.given = n.at(10);
  auto const bodies = static_cast<std::ptrdiff_t>((n.size() - 11) / 2);
  strain_.assign(n.begin() + 11, n.begin() + 11 + bodies), jumps_.assign(n.begin() + 11 + bodies, n.end());
}

}  // namespace fissure::app
