// How long edges are told to be.
#if defined(FISSURE_GMSH)
#include "mesh/edge_lengths.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <random>

#include "mesh/part.h"

namespace fissure::mesh {

double distance(scene::Near const& near, double x, double y) {
  double const along[] = {near.to[0] - near.from[0], near.to[1] - near.from[1]},
               away[] = {x - near.from[0], y - near.from[1]};
  double const squared = along[0] * along[0] + along[1] * along[1];
  double const t = squared > 0 ? std::clamp((away[0] * along[0] + away[1] * along[1]) / squared, 0.0, 1.0) : 0;
  return std::hypot(away[0] - t * along[0], away[1] - t * along[1]);
}

namespace {

/// Edge length at a place: `size`, less near to the places that ask for less.
double edge_at(std::vector<scene::Near> const& places, double size, double x, double y) {
  for (auto const& near : places)
    size = std::min(size, near.size + growth * std::max(0.0, distance(near, x, y) - near.radius));
  return size;
}

}  // namespace

void refuse_many_near(scene::Near const& near, double measure, double deep, scene::Body const& body,
                      Mesher const& mesher) {
  // beyond the radius as many as would fill this much more
  double const pi = std::acos(-1.0), r = near.radius + near.size / growth;
  scene::Body fine = body;
  fine.mesh.size = near.size;
  double const area = 2 * r * std::hypot(near.to[0] - near.from[0], near.to[1] - near.from[1]) + pi * r * r;
  refuse_too_many(
      std::min(area * (deep > 0 ? deep : 1), measure) / std::pow(near.size, deep > 0 ? 3 : 2) * mesher.cells_per_size(),
      fine, deep > 0 ? 3 : 2);
}

namespace {

/// 1, a little more or less from place to place and from seed to seed.
std::function<double(double, double, double)> unevenness(double size, unsigned seed) {
  std::mt19937 random(seed);
  auto const number = [&] { return static_cast<double>(random()) / 4294967296.0; };  // the same with every library
  struct Wave {
    double x, y, z, phase;
  };
  std::array<Wave, 6> waves;
  for (Wave& w : waves) w = {number() - 0.5, number() - 0.5, number() - 0.5, 6.283185307179586 * number()};
  return [=](double x, double y, double z) {
    double sum = 0;
    for (Wave const& w : waves) sum += std::sin((w.x * x + w.y * y + w.z * z) * 4 / size + w.phase);
    return 1 + 0.015 * sum;
  };
}

}  // namespace

void set_edge_lengths(Drawn const& drawn, double over) {
  auto const& first = drawn.bodies[0].mesh;
  auto const plain = [&](scene::Body const& body) {
    return !body.mesh.seed && body.mesh.near.empty() && body.mesh.size == first.size;
  };
  if (std::all_of(drawn.bodies.begin(), drawn.bodies.end(), plain)) return;
  std::vector<std::function<double(double, double, double)>> edges;
  for (auto const& body : drawn.bodies)
    edges.push_back([spec = body.mesh, over, uneven = unevenness(over * body.mesh.size, body.mesh.seed)](
                        double x, double y, double z) {
      return over * edge_at(spec.near, spec.size, x, y) * (spec.seed ? uneven(x, y, z) : 1.0);
    });
  std::map<std::pair<int, int>, std::vector<std::size_t>> bodies_at;  // of entities of all dimensions
  for (std::size_t b = 0; b < drawn.bodies.size() && drawn.bodies.size() > 1; ++b)
    for (Entities level = drawn.pieces[b]; !level.empty();) {
      std::sort(level.begin(), level.end());
      level.erase(std::unique(level.begin(), level.end()), level.end());
      for (auto const& entity : level) bodies_at[entity].push_back(b);
      if (level[0].first == 0) break;
      Entities below;
      gmsh::model::getBoundary(level, below, false, false);
      level = below;
    }
  gmsh::model::mesh::setSizeCallback([=](int dimension, int tag, double x, double y, double z) {
    auto const at = bodies_at.find({dimension, tag});
    if (at == bodies_at.end()) return edges[0](x, y, z);
    double least = INFINITY;
    for (std::size_t const b : at->second) least = std::min(least, edges[b](x, y, z));
    return least;
  });
}

int grow_inwards(double size) {
  Entities curves;
  gmsh::model::getEntities(curves, 1);
  std::map<int, std::vector<double>> by_octave;  // of size over length
  double fine = 0, whole = 0;
  int count = 0;
  for (auto const& curve : curves) {
    double const length = measure_of(curve);
    auto const [back, front] = depth({curve});
    // between both ends of a prism: as many as the outline has points, however deep it is
    if (front - back > 0.99 * length) continue;
    whole += length;
    if (length > size / 2) continue;
    by_octave[static_cast<int>(std::log2(size / length))].push_back(curve.second);
    fine += length, ++count;
  }
  if (fine < whole / 2 || count < 16) return 0;  // a body smaller than its mesh size is no fine outline
  namespace field = gmsh::model::mesh::field;
  std::vector<double> all;
  for (auto const& [octave, tags] : by_octave) {
    int const distance = field::add("Distance"), edge = field::add("MathEval");
    field::setNumbers(distance, "CurvesList", tags);
    field::setNumber(distance, "NumPointsPerCurve", 3);
    field::setString(edge, "F", fmt::format("{:.17g} + {} * F{}", std::ldexp(size, -octave), growth, distance));
    all.push_back(edge);
  }
  int const least = field::add("Min");
  field::setNumbers(least, "FieldsList", all);
  field::setAsBackgroundMesh(least);
  gmsh::option::setNumber("Mesh.MeshSizeExtendFromBoundary", 0);
  gmsh::option::setNumber("Mesh.MeshSizeMin", 0);
  return count;
}

void refuse_too_many_lines(Entities const& pieces, double over, scene::Body const& body, bool together) {
  Entities faces, curves;
  gmsh::model::getBoundary(pieces, faces, false, false);
  gmsh::model::getBoundary(faces, curves, false, false);
  std::sort(curves.begin(), curves.end());
  curves.erase(std::unique(curves.begin(), curves.end()), curves.end());
  auto const lines = std::count_if(curves.begin(), curves.end(),
                                   [&](auto const& curve) { return measure_of(curve) <= over * body.mesh.size / 2; });
  int const most = 4000;
  if (lines <= most) return;
  throw Error(
      body.source,
      fmt::format("body \"{}\": {} of its lines are less than half as long as its cells (mesh.size is {:g} m); a "
                  "solid with more than {} takes too long to mesh. Leave points out, or draw what is round as disc "
                  "or ring{}",
                  body.name, lines, body.mesh.size, most, together ? "" : ", or use mesh.cells = \"block\""));
}

}  // namespace fissure::mesh
#endif
