// Section B4: the automatic step against the true limit for every combination of section, cells, law, joints, contact
// and shape. scripts/step_table makes the table of docs/theory/time_step.md of it.
#include <fstream>

#include "small_motions.h"

namespace fissure::verify {
namespace {

constexpr double h = 0.01;

/// What a mesh is like at rest, and what becomes of it.
struct Shape {
  std::string name;
  bool regular;  // else the least ratio that is asked for is smaller
  std::function<void(mesh::Mesh&)> change = [](mesh::Mesh&) {};
  double stretch = 1;  // along y, and turned
};

struct Combination {
  Kind kind;
  Stuffing law;
  double joints;  // penalty over E; 0: none
  bool contact;
  Shape shape;
  std::string name() const {
    return fmt::format("{}, {}, joints {} E{}, {}", kind.name(), law.name, joints, contact ? ", contact" : "",
                       shape.name);
  }
};

template <class Change>
void move_nodes(mesh::Mesh& mesh, Change&& change) {
  for (auto& x : mesh.nodes) x = change(x);
}

/// By node: no face of a body's surface has it.
std::vector<char> nodes_inside(mesh::Mesh const& mesh) {
  std::vector<char> inside(mesh.nodes.size(), 1);
  for (auto const& face : mesh.boundary)
    for (int node : face.node)
      if (node >= 0) inside[node] = 0;
  return inside;
}

/// Every cell grows by half of its size with each one before it.
void grade(mesh::Mesh& mesh) {
  move_nodes(mesh, [](Vec3 const& x) { return Vec3(h * (Eigen::pow(1.5, x.array() / h) - 1)); });
}

/// Twenty times as wide as high, and crooked.
void flatten(mesh::Mesh& mesh) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-0.2 * h, 0.2 * h);
  auto const inside = nodes_inside(mesh);
  for (std::size_t i = 0; i < inside.size(); ++i)
    for (int c = 0; c < D && inside[i]; ++c) mesh.nodes[i][c] += number(random);
  move_nodes(mesh, [](Vec3 const& x) { return Vec3(x[0], x[1] / 20, x[2]); });
}

/// Nodes inside, no two of them neighbours, move towards the face across one of their cells until that cell's altitude
/// is about a two-hundredth of its edges.
void squash(mesh::Mesh& mesh) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(0.2, 1);
  auto waits = nodes_inside(mesh);
  for (int k = 0; k < mesh.n_cells() * C; ++k) {
    int const first = k / C * C, node = mesh.cells[k];
    if (!waits[node]) continue;
    Vec3 target(0, 0, 0);
    double sum = 0;
    for (int b = first; b < first + C; ++b)
      if (double const share = number(random); b != k) target += share * mesh.nodes[mesh.cells[b]], sum += share;
    target /= sum;
    mesh.nodes[node] = target + 0.015 * (mesh.nodes[node] - target);
    for (int i = 0; i < mesh.n_cells() * C; i += C)
      if (std::count(&mesh.cells[i], &mesh.cells[i] + C, node))
        for (int b = i; b < i + C; ++b) waits[mesh.cells[b]] = 0;
  }
}

std::vector<Combination> combinations() {
  auto laws = stuffings();
  // has the same elastic trial
  std::erase_if(laws, [](Stuffing const& one) { return one.name == "Drucker-Prager, dilates"; });
  laws[0].name = "neo-Hookean";
  laws.push_back({"Munjiza", [](scene::Material& m) { m.bulk = material<laws::Munjiza>(steel).bulk; }});
  laws.push_back({"Johnson-Cook", [](scene::Material& m) {
                    laws::JohnsonCookFlow law;
                    law.A = 500 * MPa, law.B = 500 * MPa, law.n = 0.3, law.C = 0.02;
                    m.flow.emplace(), m.flow->law = law;
                  }});
  std::vector<Shape> const shapes{{"at rest", true},
                                  {"graded", true, grade},
                                  {"flat", false, flatten},
                                  {"slivers", false, squash},
                                  {"stretched", false, [](mesh::Mesh&) {}, 3},
                                  {"crushed", false, [](mesh::Mesh&) {}, 1 / 3.0}};
  std::vector<Combination> list;
  for (auto const& kind : kinds())
    for (auto const& law : laws)
      for (double joints : {0, 1, 20})
        for (bool contact : {false, true})
          for (auto const& shape : shapes) {
            bool const blocks = kind.cells == "block";
            // not for these
            if (law.name == "averaged pressure" && (blocks || kind.section == "plane stress")) continue;
            if (shape.name == "slivers" && blocks) continue;
            list.push_back({kind, law, joints, contact, shape});
          }
  return list;
}

/// Strained and turned in steps, so that what flows does so.
void deform(Rig<>& rig, double stretch) {
  auto& model = rig.solver->model();
  std::vector<double> before(model.vertices.u.size(), 0);
  constexpr int steps = 40;
  double const dt = 1.0 / steps;
  for (int k = 1; k <= steps; ++k) {
    double const share = static_cast<double>(k) / steps;
    Mat<double, D> F = Mat<double, D>::Identity() * std::pow(stretch, -0.3 * share);
    F(1, 1) = std::pow(stretch, share);
    if (rig.scene.two_d != "axisymmetric") F = (turn(share) * F).eval();
    rig.displace([&](Index, int, V const& x) { return V(F * x - x); });
    auto const u = model.vertices.u.download();
    for (std::size_t i = 0; i < u.size(); ++i) before[i] = (u[i] - before[i]) / dt;
    model.vertices.v.upload(before);
    element_forces(rig.device, model, rig.scene, ElementRun{dt});
    before = u;
  }
  model.vertices.v.upload(std::vector<double>(before.size(), 0));
}

/// Automatic steps but for their safety over the true limit: with contact, without it, and with its bounds alone.
struct Ratio {
  double whole, without_contact, at_first_touch;
};
/// Of the limit 0.95 is stable and 1.02 is not.
Ratio measured(Combination const& c) {
  Rig<> rig;
  if (c.kind.section != "3D") rig.scene.two_d = c.kind.section;
  rig.cell_name = c.kind.cells, rig.integration = c.kind.integration;
  rig.scene.contact = c.contact;
  scene::Material m = material<laws::NeoHookean>(steel);
  c.law.add(m);
  if (c.joints > 0) m.joint = unbreakable(c.joints * steel.young);
  rig.add_material(m);
  double const width = flat ? 3 * h : 2 * h;  // in axisymmetry from the axis on
  if (c.contact) {                            // one on the other, aside so that no nodes meet
    rig.add_box({0.5 * width, h, h}, {width, 2 * h, 2 * h}, h);
    rig.add_box({0.5 * width + 0.37 * h, 2.995 * h, 1.21 * h}, {width, 2 * h, 2 * h}, h);
  } else {
    rig.add_box({0.5 * width, 2 * h, h}, {width, 4 * h, 2 * h}, h);
  }
  c.shape.change(rig.make());
  auto& solver = rig.start();
  if (c.shape.stretch != 1) deform(rig, c.shape.stretch);
  auto const step = [&](long at, SpringBeds<D> const& beds, double excess) {
    solver.stable_step().follow({at, 0, 1, beds, excess});
    return solver.step_limit().stable;
  };
  double const alone = step(1000, {}, 0);
  solver.contact().add_forces(0, 0, 0);
  EXPECT_EQ(solver.contact().largest_penetration() > 0, c.contact) << c.name();
  solver.stable_step().heed_contact({1001, 0, 1, solver.contact().beds(), solver.contact().excess()});
  double const unmeasured = solver.step_limit().stable;
  double const whole = step(2000, solver.contact().beds(), solver.contact().excess());
  SmallMotions motions(rig, m.flow.has_value());
  double const limit = motions.limit(whole);
  EXPECT_FALSE(motions.blows_up(0.95 * limit, 500)) << c.name();
  EXPECT_TRUE(motions.blows_up(1.02 * limit, 500)) << c.name();
  return {whole / limit, alone / limit, unmeasured / limit};
}

/// FISSURE_TEST_LONG=1 asks for all; else it is every 23rd, which meets every law, joint and shape.
///
/// The measurement has 10 % of omega^2 to spare and 1 % left over, and the step is left alone within 5 %: 0.90 to 1.00
/// of the limit, and the bisection's 0.3 %. What may press is never softer than it will be, which takes more; until it
/// is measured, its bound stands in for it. Least is Munjiza's law far from rest: its tangent is not symmetric.
TEST(Verify, B4_StepLimitOfEveryCombination) {
  char const* const path = std::getenv("FISSURE_STEP_TABLE");
  std::ofstream table(path ? path : "");
  table << "dimension,section,cells,law,joints,contact,shape,ratio,ratio without contact,ratio at first touch\n";
  auto const list = combinations();
  double least = 1, largest = 0, least_touching = 1;
  for (std::size_t i = 0; i < list.size(); i += nightly() ? 1 : 23) {
    auto const& c = list[i];
    auto const [ratio, alone, at_first_touch] = measured(c);
    EXPECT_LT(ratio, 1.003) << c.name();
    EXPECT_LT(at_first_touch, 1.003) << c.name();
    // Small faces that nothing covers yet take as much as if something did.
    bool const even = c.shape.regular && !(c.contact && c.shape.name == "graded");
    EXPECT_GT(ratio, even ? 0.8 : 0.6) << c.name();
    (c.contact ? least_touching : least) = std::min(c.contact ? least_touching : least, ratio);
    largest = std::max(largest, ratio);
    std::string const cells = c.kind.cells + (c.kind.cells == "block" ? " " + c.kind.integration : "");
    table << fmt::format("{},{},{},\"{}\",{:g},{},{},{:.4f},{:.4f},{:.4f}\n", D, c.kind.section, cells, c.law.name,
                         c.joints, c.contact ? "pressed" : "none", c.shape.name, ratio, alone, at_first_touch);
  }
  std::printf("automatic/safety over the limit by bisection: %.3f to %.3f, where bodies touch from %.3f\n", least,
              largest, least_touching);
}

}  // namespace
}  // namespace fissure::verify
