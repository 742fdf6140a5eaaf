// What the verification ladder shares: its table of materials, a scene with its mesh and solver, and norms.
// Compiled once per dimension with FISSURE_D; coordinates are (x, y, z) and 2D ignores z.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <sstream>

#include "clip.h"
#include "dim.h"
#include "mesh/part.h"
#include "shapes.h"
#include "solver/solver.h"

namespace fissure::verify {

inline constexpr int D = FISSURE_D;
inline constexpr int C = D + 1;
inline constexpr bool flat = D == 2;
using V = Vec<double, D>;

inline constexpr double mm = 1e-3, us = 1e-6, MPa = 1e6, GPa = 1e9;

inline mesh::Mesher const& mesher() {
#if FISSURE_D == 2
  return mesh::mesher_2d();
#else
  return mesh::mesher_3d();
#endif
}
inline constexpr mesh::CellKind cells = flat ? mesh::CellKind::triangle : mesh::CellKind::tetrahedron;

/// Elastic constants and density of the ladder's table.
struct Stuff {
  double young, poisson, density;
  double bar() const { return std::sqrt(young / density); }
  double confined() const { return young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson)); }
  double c_P() const { return std::sqrt(confined() / density); }
  double shear() const { return young / (2 * (1 + poisson)); }
};
inline constexpr Stuff steel{206.9e9, 0.29, 7830}, rock{50e9, 0.25, 2700}, soft_rock{12.2e9, 0.25, 1800};

template <class Law = laws::NeoHookean>
scene::Material material(Stuff const& stuff, std::string name = "stuff") {
  scene::Material m;
  m.name = std::move(name);
  m.density = stuff.density;
  Law law;
  law.young = stuff.young;
  law.poisson = stuff.poisson;
  m.bulk = law;
  return m;
}

/// A joint whose penalty is `stiffness` times E.
inline laws::CohesiveJoint joint(double tension, double shear, double G1, double G2, double penalty) {
  laws::CohesiveJoint law;
  law.tension = tension, law.shear = shear, law.G1 = G1, law.G2 = G2, law.penalty = penalty;
  law.prepare();
  return law;
}

/// So strong that it never leaves the straight part of its curve.
inline laws::CohesiveJoint unbreakable(double penalty) {
  return joint(1e6 * penalty, 1e6 * penalty, 1e12 * penalty, 1e12 * penalty, penalty);
}

inline scene::TimeFunction constant(double value) { return {value, {}}; }
inline scene::TimeFunction of_time(std::function<double(double)> f) { return {0, std::move(f)}; }
inline scene::Region place(std::string name) { return {std::move(name), {}}; }
inline scene::Region where(std::function<bool(double, double, double)> f) { return {"", std::move(f)}; }

/// Which directions of a hold or load are given; the rest is free.
inline scene::Directions along(int c, scene::TimeFunction f) {
  scene::Directions d;
  d[c] = std::move(f);
  return d;
}
inline scene::Directions still() { return {constant(0), constant(0), constant(0)}; }

/// Cells and integration of all bodies that a mesh is made for: FISSURE_TEST_CELLS="block full" runs the ladder with
/// blocks.
inline std::array<std::string, 2> test_cells() {
  std::istringstream words(std::getenv("FISSURE_TEST_CELLS") ? std::getenv("FISSURE_TEST_CELLS") : "");
  std::array<std::string, 2> chosen{"simplex", "one_point"};
  for (auto& word : chosen)
    if (std::string given; words >> given) word = given;
  return chosen;
}

/// A scene that is filled by hand, its mesh and, once started, its solver.
template <class Real = double>
struct Rig {
  scene::Scene scene;
  mesh::Mesh mesh;
  std::string cell_name = test_cells()[0], integration = test_cells()[1];
  Device device = Device::select("auto", 1);  // FISSURE_BACKEND chooses; small cases need no threads
  std::unique_ptr<Solver<D, Real>> solver;

  Rig() { scene.file = "ladder"; }
  Rig(Rig const&) = delete;

  int add_material(scene::Material m) {
    scene.materials.push_back(std::move(m));
    return static_cast<int>(scene.materials.size()) - 1;
  }
  int add_body(scene::Shape shape, double size, bool structured = true, int material = 0) {
    scene::Body body;
    body.name = "body " + std::to_string(scene.bodies.size());
    body.shape = std::move(shape);
    body.mesh.size = size;
    body.mesh.structured = structured;
    body.mesh.cells = cell_name, body.mesh.integration = integration;
    body.material = material;
    scene.bodies.push_back(std::move(body));
    return static_cast<int>(scene.bodies.size()) - 1;
  }
  int add_box(Vec3 const& center, Vec3 const& size, double spacing, int material = 0, bool structured = true) {
    return add_body({scene::Box{center, size}, {}}, spacing, structured, material);
  }
  /// Meshes all bodies; a box's nodes may then be moved, before start().
  mesh::Mesh& make() {
    mesh = mesh::make_mesh(scene, mesher());
    return mesh;
  }
  void hold(int body, scene::Region region, scene::Directions velocity) {
    scene.holds.push_back({{}, body, std::move(region), std::move(velocity)});
  }
  /// A roller: no motion along direction c. Directions that the dimension does not have are left out.
  void roller(int body, std::string name, int c) {
    if (c < D) hold(body, place(std::move(name)), along(c, constant(0)));
  }
  void pull(int body, scene::Region region, scene::Directions traction) {
    scene.tractions.push_back({{}, body, std::move(region), std::move(traction)});
  }
  void press(int body, scene::Region region, scene::TimeFunction p) {
    scene.pressures.push_back({{}, body, std::move(region), std::move(p)});
  }

  Solver<D, Real>& start() {
    if (mesh.nodes.empty()) make();
    solver = std::make_unique<Solver<D, Real>>(device, scene, mesh);
    return *solver;
  }
  void step() {
    solver->evaluate();
    solver->advance();
  }
  void run_for(double time) {
    double const until = solver->time() + time * (1 - 1e-12);
    while (solver->time() < until) step();
  }
  /// Starts and damps to rest: twice the lowest frequency, that of a wave of speed c which is four times as long as L.
  void come_to_rest(double L, double c, double periods) {
    double const omega = 2 * std::numbers::pi * c / (4 * L);
    scene.run.mass_damping = 2 * omega;
    start();
    run_for(periods * 2 * std::numbers::pi / omega);
  }

  /// Displacements put in by hand, by vertex from its reference place: for cases without dynamics.
  template <class F>
  void displace(F&& f) {
    auto& model = solver->model();
    std::vector<Real> u(static_cast<std::size_t>(model.vertices.count) * D, Real(0));
    each_corner([&](Index e, int a, Index vertex) {
      V const x = f(e, a, place_of(vertex));
      for (int c = 0; c < D; ++c) u[static_cast<std::size_t>(vertex) * D + c] = static_cast<Real>(x[c]);
    });
    model.vertices.u.upload(u);
  }
  template <class F>
  void each_corner(F&& f) const {
    auto& model = solver->model();
    for (Index e = 0; e < model.elements.count; ++e)
      for (int a = 0; a < C && model.elements.cell[e] >= 0; ++a) f(e, a, model.vertex_of(e, a));
  }
  /// Reference place of a vertex [m].
  V place_of(Index vertex) const {
    V x;
    for (int c = 0; c < D; ++c) x[c] = solver->model().vertices.reference[vertex][c] + solver->model().origin[c];
    return x;
  }
  /// Stiffness [Pa/m] and area at rest [m^2] of the joint on face a of an element; 0: there is none.
  double joint_stiffness(Index e, int a) const {
    auto& model = solver->model();
    return model.in_set(e, [&](auto const& set, Index cell) -> double {
      int const face = set.face_of({e, a}).face;
      return face < 0 ? 0 : set.of(model.interfaces).stiffness.download_one(kernels::blocked(cell, face, set.faces));
    });
  }
  double joint_area(Index e, int a) const {
    auto& model = solver->model();
    if (model.neighbour({e, a}).element == e) return 0;
    double sum = 0;
    model::BreakingView<Real> const now(model, {FaceId{e, a}});
    for (int i = 0; i < D; ++i) sum += model.joint_area(now, {e, a}, i);
    return sum;
  }
  /// Sum over the vertices of the cell that an element is or is part of.
  V sum_over_cell(std::vector<V> const& of_vertices, Index e) const {
    V sum = V::Zero();
    for (Index vertex : solver->model().cell_vertices(solver->model().cell_head(e))) sum += of_vertices[vertex];
    return sum;
  }
  /// Elements that cells are or begin with.
  std::vector<Index> heads() const {
    auto& model = solver->model();
    std::vector<Index> list;
    for (Index e = 0; e < model.elements.count; ++e)
      if (model.elements.cell[e] >= 0 && model.cell_head(e) == e) list.push_back(e);
    return list;
  }
  V centroid(Index e) const {
    V x = V::Zero();
    for (int a = 0; a < C; ++a) x += place_of(solver->model().vertex_of(e, a)) / C;
    return x;
  }
  /// [vertex] -> a vector of it, in double.
  static std::vector<V> vectors(Buffer<Real> const& buffer) {
    auto const raw = buffer.download();
    std::vector<V> list(raw.size() / D);
    for (std::size_t i = 0; i < raw.size(); ++i) list[i / D][static_cast<int>(i % D)] = static_cast<double>(raw[i]);
    return list;
  }
  std::vector<V> displacements() const { return vectors(solver->model().vertices.u); }
  std::vector<V> velocities() const { return vectors(solver->model().vertices.v); }
  std::vector<V> forces() const { return vectors(solver->model().vertices.force); }

  /// Power of the elements' forces along a direction over what their energies lose along it, at the displacements u
  /// (both [vertex][D]). Differences over 1e-4 of the direction are exact to the fourth power of that.
  double force_over_slope(std::vector<Real> const& u, std::vector<Real> const& direction) {
    auto& model = solver->model();
    ElementRun const run;
    auto const go = [&](double along) {
      auto moved = u;
      for (std::size_t i = 0; i < u.size(); ++i) moved[i] += along * direction[i];
      model.vertices.u.upload(moved);
      element_forces(device, model, scene, run);
      auto const sums = element_energy(device, model, scene, run);
      return sums[0] + sums[2];
    };
    double const h = 1e-4, slope = (8 * (go(h) - go(-h)) - (go(2 * h) - go(-2 * h))) / (12 * h);
    go(0);
    for_each(device, 0, model.vertices.count,
             kernels::SumCorners<D, Real>{model.corner_force(), model.slots.first.data(), model.slots.list.data(),
                                          model.vertex_force()});
    auto const force = forces();
    double power = 0;
    for (std::size_t i = 0; i < u.size(); ++i) power += force[i / D][static_cast<int>(i % D)] * direction[i];
    return -power / slope;
  }
  /// A random number in (-size, size) for each direction of each vertex.
  std::vector<Real> random_vectors(double size, std::mt19937& random) const {
    std::uniform_real_distribution<double> number(-size, size);
    std::vector<Real> x(static_cast<std::size_t>(solver->model().vertices.count) * D);
    for (Real& one : x) one = static_cast<Real>(number(random));
    return x;
  }

  V momentum() const {
    auto const v = velocities();
    V sum = V::Zero();
    for (std::size_t i = 0; i < v.size(); ++i) sum += solver->model().vertices.mass[i] * v[i];
    return sum;
  }
  /// sum of x cross m v about the origin, padded to three directions in 2D.
  Vec3 angular_momentum() const {
    auto const u = displacements(), v = velocities();
    Vec3 sum(0, 0, 0);
    for (std::size_t i = 0; i < v.size(); ++i) {
      V const x = place_of(static_cast<Index>(i)) + u[i];
      sum += solver->model().vertices.mass[i] * padded(x).cross(padded(v[i]));
    }
    return sum;
  }
  static Vec3 padded(V const& x) {
    Vec3 y(0, 0, 0);
    for (int c = 0; c < D; ++c) y[c] = x[c];
    return y;
  }
  double mass() const {
    double sum = 0;
    for (double m : solver->model().vertices.mass) sum += m;
    return sum;
  }
  double kinetic() const {
    auto const v = velocities();
    double sum = 0;
    for (std::size_t i = 0; i < v.size(); ++i) sum += 0.5 * solver->model().vertices.mass[i] * v[i].squaredNorm();
    return sum;
  }
  /// Cauchy stress of the elements: xx yy zz xy yz zx [Pa]; by element, padding included.
  std::vector<std::array<double, 6>> stresses() {
    auto& model = solver->model();
    Buffer<double> raw(device, "stress", static_cast<std::size_t>(model.elements.count) * 6);
    element_stress(device, model, scene, ElementRun{}, raw.data());
    auto const values = raw.download();
    std::vector<std::array<double, 6>> list(model.elements.count);
    for (std::size_t i = 0; i < values.size(); ++i) list[i / 6][i % 6] = values[i];
    return list;
  }
};

/// One body from nodes and cells of positive orientation; its faces have no names and may not be loaded by pressure.
inline mesh::Mesh mesh_by_hand(std::vector<Vec3> nodes, std::vector<int> corners) {
  mesh::Mesh mesh;
  mesh.kind = cells;
  mesh.nodes = std::move(nodes);
  mesh.cells = std::move(corners);
  mesh.body_first_cell = {0, mesh.n_cells()};
  mesh.body_first_node = {0, static_cast<int>(mesh.nodes.size())};
  mesh.named_nodes.resize(1), mesh.named_faces.resize(1);
  auto const across = mesh::neighbours(mesh);
  for (int k = 0; k < mesh.n_cells() * C; ++k) {
    if (across[k] >= 0) continue;
    mesh::Face face{k / C, {-1, -1, -1, -1}};
    for (int b = 0, i = 0; b < C; ++b)
      if (b != k % C) face.node[i++] = mesh.cells[k / C * C + b];
    mesh.boundary.push_back(face);
  }
  return mesh;
}

/// A regular simplex of edge h with another mirrored at each of its first `n` faces (face a is opposite to corner a).
inline mesh::Mesh regular_simplices(double h, int n) {
  std::vector<Vec3> nodes{
      {0, 0, 0}, {h, 0, 0}, {h / 2, h * std::sqrt(3) / 2, 0}, {h / 2, h / (2 * std::sqrt(3)), h * std::sqrt(2.0 / 3)}};
  nodes.resize(C);
  std::vector<int> corners;
  for (int a = 0; a < C; ++a) corners.push_back(a);
  std::vector<int> const first = corners;
  for (int a = 0; a < n; ++a) {
    Vec3 middle(0, 0, 0);
    for (int b = 0; b < C; ++b)
      if (b != a) middle += nodes[b] / D;
    nodes.push_back(2 * middle - nodes[a]);
    std::vector<int> mirrored = first;
    mirrored[a] = static_cast<int>(nodes.size()) - 1;
    std::swap(mirrored[(a + 1) % C], mirrored[(a + 2) % C]);
    corners.insert(corners.end(), mirrored.begin(), mirrored.end());
  }
  return mesh_by_hand(nodes, corners);
}

/// Two cells of edge h that share a face: regular simplices, or squares or cubes where the ladder runs with blocks.
inline mesh::Mesh two_cells(double h) {
  if (test_cells()[0] == "simplex") return regular_simplices(h, 1);
  mesh::Mesh mesh = mesh::no_bodies(cells);
  mesh::add_body(mesh, mesh::structured_part(cells, {h, h / 2, h / 2}, {2 * h, h, h}, {2, 1, flat ? 0 : 1}, true),
                 "two cells", {});
  return mesh;
}

/// Exact rotation by an angle in the xy plane.
inline Mat<double, D> turn(double angle) {
  Mat<double, D> Q = Mat<double, D>::Identity();
  Q(0, 0) = Q(1, 1) = std::cos(angle);
  Q(0, 1) = -std::sin(angle), Q(1, 0) = -Q(0, 1);
  return Q;
}

/// sqrt(sum (a - b)^2 / sum b^2)
inline double relative_l2(std::vector<double> const& a, std::vector<double> const& b) {
  double difference = 0, norm = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference += (a[i] - b[i]) * (a[i] - b[i]), norm += b[i] * b[i];
  return std::sqrt(difference / norm);
}

}  // namespace fissure::verify
