// What blocks cost beside the simplices that they replace: the same box as triangles or tetrahedra and as
// quadrilaterals or hexahedra, forces and the step of vertices, all timed in turn in one run. A hexahedron is compared
// with the five tetrahedra that it can be cut into; the grid has six, so their time counts five sixths.
// docs/performance.md has its table.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <vector>

#include "clip.h"
#include "dim.h"
#include "shapes.h"
#include "solver/solver.h"

namespace fissure {
namespace {

constexpr int D = FISSURE_D;

struct Case {
  std::string name, cells, integration;
};

scene::Scene box(int n, Case const& which, bool joints) {
  scene::Scene scene;
  scene::Material rock;
  rock.density = 2700;
  laws::Munjiza elastic;
  elastic.young = 50e9, elastic.poisson = 0.25;
  rock.bulk = elastic;
  laws::CohesiveJoint joint;
  joint.tension = 3e6, joint.shear = 15e6, joint.friction_angle = 0.5, joint.G1 = joint.G2 = 50,
  joint.penalty = 10 * elastic.young;
  if (joints) rock.joint = joint;
  scene.materials.push_back(rock);
  scene::Body body;
  body.material = 0;
  body.shape.is = scene::Box{Vec3(0, 0, 0), Vec3(1, 1, 1)};
  body.mesh.structured = true;
  body.mesh.size = 1.0 / n;
  body.mesh.cells = which.cells, body.mesh.integration = which.integration;
  scene.bodies.push_back(body);
  scene.contact = false;
  scene.run.time = 1;
  scene.run.dt = 1e-12;  // nothing moves, nothing softens
  return scene;
}

/// Milliseconds per step of each case: the median over rounds in which all take turns. A turn is some steps, as in a
/// run: what they leave in the caches is theirs.
template <class Real>
std::vector<double> times(int n, std::vector<Case> const& cases, bool joints, double seconds) {
  Device device = Device::select("cpu", 1);
  std::vector<scene::Scene> scenes;
  std::vector<mesh::Mesh> meshes;
  std::vector<std::unique_ptr<Solver<D, Real>>> solvers;
  for (auto const& which : cases) scenes.push_back(box(n, which, joints));
  for (auto const& scene : scenes) meshes.push_back(mesh::make_mesh(scene, FISSURE_MESHER()));
  for (std::size_t k = 0; k < cases.size(); ++k)
    solvers.push_back(std::make_unique<Solver<D, Real>>(device, scenes[k], meshes[k]));
  auto const now = [] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  };
  std::vector<std::vector<double>> samples(cases.size());
  for (double const start = now(); samples[0].size() < 5 || now() - start < seconds;)
    for (std::size_t k = 0; k < cases.size(); ++k) {
      constexpr int steps = 8;
      double const before = now();
      for (int step = 0; step < steps; ++step) {
        solvers[k]->evaluate();
        solvers[k]->advance();
      }
      samples[k].push_back((now() - before) * 1e3 / steps);
    }
  std::vector<double> medians;
  for (auto& list : samples) {
    std::nth_element(list.begin(), list.begin() + list.size() / 2, list.end());
    medians.push_back(list[list.size() / 2]);
  }
  return medians;
}

template <class Real>
void table(int n, bool joints) {
  std::vector<Case> const cases{{"simplices", "simplex", "one_point"},
                                {"one point", "block", "one_point"},
                                {"assumed strain", "block", "assumed_strain"},
                                {"full", "block", "full"},
                                {"B-bar", "block", "b_bar"}};
  auto const medians = times<Real>(n, cases, joints, 4);
  double const blocks = std::pow(n, D), simplices = medians[0] * (D == 3 ? 5.0 / 6 : 1.0);
  for (std::size_t k = 0; k < cases.size(); ++k)
    fmt::print("| {:.0f} blocks{} | {} | {} | {:.4f} | {:.1f} | {:.2f} |\n", blocks, joints ? ", joints" : "",
               sizeof(Real) == 8 ? "double" : "single", cases[k].name, medians[k], medians[k] * 1e6 / blocks,
               medians[k] / simplices);
}

}  // namespace
}  // namespace fissure

int main() {
  fmt::print("| box | precision | cells | ms per step | ns per block | over {} |\n|---|---|---|---|---|---|\n",
             fissure::D == 3 ? "five tetrahedra" : "two triangles");
  for (int n : fissure::D == 3 ? std::vector<int>{12, 40} : std::vector<int>{60, 400})
    for (bool joints : {false, true}) {
      fissure::table<double>(n, joints);
      fissure::table<float>(n, joints);
    }
}
