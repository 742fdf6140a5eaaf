// What flow costs: time of a whole step for the same block elastic, with a law that never yields, and yielding
// everywhere; with and without joints. Not a test, it prints a Markdown table (docs/performance.md). All take turns, so
// that a noisy machine is fair to all.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "clip.h"
#include "dim.h"
#include "mesh/mesher.h"
#include "shapes.h"
#include "solver/solver.h"

namespace fissure {
namespace {

constexpr int D = FISSURE_D;

/// A block that is stretched along x at 1000/s from the start; yield 0: elastic.
scene::Scene block(int cells, bool joints, double yield, bool logarithmic, bool averaged) {
  scene::Scene scene;
  scene::Material steel;
  steel.name = "steel";
  steel.density = 7830;
  laws::Munjiza elastic;
  elastic.young = 206.9e9, elastic.poisson = 0.29;
  steel.bulk = elastic;
  if (yield > 0) {
    laws::JohnsonCookFlow law;
    law.A = yield, law.B = 614e6, law.n = 0.168, law.C = 0.0089, law.melting = 1813;
    steel.flow.emplace();
    steel.flow->law = law;
    steel.flow->logarithmic = logarithmic, steel.flow->averaged = averaged;
  }
  if (joints) {  // that nothing breaks
    laws::CohesiveJoint joint;
    joint.tension = joint.shear = 1e15, joint.G1 = joint.G2 = 1e20, joint.penalty = 20 * elastic.young;
    joint.prepare();
    steel.joint = joint;
  }
  scene.contact = false;
  scene.materials.push_back(steel);
  scene::Body body;
  body.name = "block", body.material = 0;
  body.shape.is = scene::Box{Vec3(0, 0, 0), Vec3(1, 1, D == 3 ? 1 : 0)};
  body.mesh.structured = true;
  body.mesh.size = 1 / std::round(std::pow(cells / (D == 3 ? 6.0 : 2.0), 1.0 / D));
  body.velocity_at = [](double x, double, double) { return std::array<double, 3>{1000 * x, 0, 0}; };
  scene.bodies.push_back(body);
  scene.run.time = 1;
  return scene;
}

struct Case {
  char const* name;
  double yield;
  bool logarithmic = false, averaged = false;
};
constexpr Case cases[] = {{"elastic (Munjiza)", 0},
                          {"Johnson-Cook, nothing yields", 1e15},
                          {"Johnson-Cook, everything yields", 50e6},
                          {"the same, logarithmic strain", 50e6, true},
                          {"the same, averaged pressure", 50e6, false, true}};

template <class Real>
void measure(int cells, bool joints, char const* precision) {
  Device device = Device::select("cpu", 1);
  struct Run {
    scene::Scene scene;
    mesh::Mesh mesh;
    std::unique_ptr<Solver<D, Real>> solver;
    std::vector<double> times;
  };
  std::vector<std::unique_ptr<Run>> runs;
  for (Case const& one : cases) {
    auto run = std::make_unique<Run>();
    run->scene = block(cells, joints, one.yield, one.logarithmic, one.averaged);
    run->mesh = mesh::make_mesh(run->scene, FISSURE_MESHER());
    run->solver = std::make_unique<Solver<D, Real>>(device, run->scene, run->mesh);
    runs.push_back(std::move(run));
  }
  int const steps = std::max(30, 3'000'000 / cells);
  for (int i = 0; i < steps + 5; ++i)
    for (auto& run : runs) {
      auto const before = std::chrono::steady_clock::now();
      run->solver->evaluate();
      run->solver->advance();
      if (i >= 5)
        run->times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count());
    }
  double elastic = 0;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    auto& times = runs[k]->times;
    std::nth_element(times.begin(), times.begin() + times.size() / 2, times.end());
    double const one = times[times.size() / 2] / static_cast<double>(runs[k]->solver->element_count()) * 1e9;
    if (k == 0) elastic = one;
    fmt::print("| {} | {} | {} | {} | {:.1f} | {:.2f} | {:.3g} |\n", runs[k]->solver->element_count(),
               joints ? "yes" : "no", precision, cases[k].name, one, one / elastic,
               cases[k].yield > 0 ? runs[k]->solver->now().extreme("plastic_strain") : 0);
  }
}

}  // namespace
}  // namespace fissure

int main() {
  fmt::print(
      "One thread, {}D; whole steps, median.\n\n| elements | joints | precision | material | ns per element and step | "
      "over elastic | plastic strain at the end |\n"
      "|---|---|---|---|---|---|---|\n",
      FISSURE_D);
  for (int cells : {10'000, 130'000})
    for (bool joints : {false, true}) {
      fissure::measure<double>(cells, joints, "double");
      fissure::measure<float>(cells, joints, "single");
    }
}
