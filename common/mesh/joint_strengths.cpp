// Strengths that joints have of their own: scatter, weak planes, cracks that are there from the start, bonds.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>

#include "mesh/faces.h"
#include "mesh/part.h"
#include "mesh/plane.h"

namespace fissure::mesh {
namespace {

/// A face between two cells, simplices or blocks.
struct InnerFace {
  // cell * corners + a, from both sides; of a block's face in space, of both triangles it is cut into
  std::vector<std::size_t> uses;
  std::vector<int> nodes;  // ascending
  Vec3 middle, normal;     // the normal is a unit vector, either way
  double measure;          // length or area

  /// Takes the other triangle of a block's face.
  void add(InnerFace const& half) {
    uses.insert(uses.end(), half.uses.begin(), half.uses.end());
    std::vector<int> both;
    std::set_union(nodes.begin(), nodes.end(), half.nodes.begin(), half.nodes.end(), std::back_inserter(both));
    nodes = both;
    middle = (measure * middle + half.measure * half.middle) / (measure + half.measure);
    normal = (measure * normal + half.measure * (normal.dot(half.normal) < 0 ? -1 : 1) * half.normal).normalized();
    measure += half.measure;
  }
};

/// Faces between cells of a body and later ones of that body or another.
std::vector<InnerFace> inner_faces(Mesh const& mesh, int body, int beyond, std::vector<int> const& across) {
  int const corners = node_count(mesh.kind);
  std::vector<InnerFace> faces;
  std::map<std::pair<int, int>, std::size_t> face_of_blocks;
  for (int cell = mesh.body_first_cell[body]; cell < mesh.body_first_cell[body + 1]; ++cell)
    for (int a = 0; a < corners; ++a) {
      int const other = across[static_cast<std::size_t>(cell) * corners + a];
      bool const in_block = mesh.block_of(body, cell) >= 0;
      if (other < mesh.body_first_cell[beyond] || other >= mesh.body_first_cell[beyond + 1]) continue;
      if (other <= cell || (in_block && mesh.block_of(body, cell) == mesh.block_of(body, other))) continue;
      InnerFace face;
      for (int i = 0; i < corners; ++i)
        if (i != a) face.nodes.push_back(mesh.cells[static_cast<std::size_t>(cell) * corners + i]);
      int back = 0;
      while (across[static_cast<std::size_t>(other) * corners + back] != cell) ++back;
      face.uses = {static_cast<std::size_t>(cell) * corners + a, static_cast<std::size_t>(other) * corners + back};
      Vec3 const &p = mesh.nodes[face.nodes[0]], &q = mesh.nodes[face.nodes[1]];
      bool const flat = corners == 3;
      Vec3 const normal =
          flat ? Vec3(q.y() - p.y(), p.x() - q.x(), 0) : Vec3((q - p).cross(mesh.nodes[face.nodes[2]] - p) / 2);
      face.middle = flat ? Vec3((p + q) / 2) : Vec3((p + q + mesh.nodes[face.nodes[2]]) / 3);
      face.measure = normal.norm(), face.normal = normal / face.measure;
      std::sort(face.nodes.begin(), face.nodes.end());
      int const block = mesh.block_of(body, cell), facing = mesh.block_of(beyond, other);
      auto const known = flat || !in_block || facing < 0
                             ? std::pair{face_of_blocks.end(), true}
                             : face_of_blocks.emplace(std::minmax(block, facing), faces.size());
      if (known.second)
        faces.push_back(face);
      else
        faces[known.first->second].add(face);
    }
  return faces;
}

/// The bits of a number well mixed (splitmix64; Steele, Lea & Flood 2014, doi 10.1145/2714064.2660195).
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ull;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
  return x ^ (x >> 31);
}

/// A number of a body's own, from its name.
std::uint64_t key_of(std::string const& name) {
  std::uint64_t key = 0;
  for (char const letter : name) key = mixed(key ^ static_cast<unsigned char>(letter));
  return key;
}

/// A draw from Weibull's distribution of mean 1. It depends on the body's name, the face's nodes in the body and the
/// seed alone: not on threads, precision or other bodies; two bodies of the same mesh differ.
double drawn(scene::Scatter const& scatter, std::uint64_t body, InnerFace const& face, int first_node) {
  std::uint64_t key = mixed(scatter.seed ^ body);
  for (int const node : face.nodes) key = mixed(key ^ static_cast<std::uint64_t>(node - first_node));
  double const chance = (static_cast<double>(key >> 11) + 0.5) * 0x1p-53;
  return std::pow(-std::log(chance), 1 / scatter.modulus) / std::tgamma(1 + 1 / scatter.modulus);
}

/// Whether a face lies in a flat polygon.
bool lies_in(std::vector<std::array<double, 3>> const& corners, InnerFace const& face, Mesh const& mesh, double close) {
  Plane const plane(corners);
  return plane.inside(face.middle) && std::all_of(face.nodes.begin(), face.nodes.end(),
                                                  [&](int node) { return plane.off(mesh.nodes[node]) < close; });
}

/// Whether every node of a face lies on a seam: on a line (3D: on the plane through it along z) between its ends, or in
/// a polygon.
bool lies_on(scene::Seam const& line, InnerFace const& face, Mesh const& mesh, double close) {
  if (mesh.kind == CellKind::tetrahedron && !line.corners.empty()) return lies_in(line.corners, face, mesh, close);
  Vec3 const from(line.from[0], line.from[1], 0), along = Vec3(line.to[0], line.to[1], 0) - from,
                                                  way = along.normalized();
  return std::all_of(face.nodes.begin(), face.nodes.end(), [&](int node) {
    Vec3 offset = mesh.nodes[node] - from;
    offset.z() = 0;
    double const at = offset.dot(way);
    return (offset - at * way).norm() < close && at > -close && at < along.norm() + close;
  });
}

bool belongs(scene::JointSet const& set, InnerFace const& face, Mesh const& mesh, double close) {
  if (set.seam && !lies_on(*set.seam, face, mesh, close)) return false;
  if (set.facing && std::abs(set.facing->normalized().dot(face.normal)) < std::cos(set.within)) return false;
  return !set.inside || set.inside(face.middle.x(), face.middle.y(), face.middle.z());
}

std::string doubt_of_scatter(Source const& source, std::string const& what, double mean,
                             scene::Scatter const& scatter) {
  return fmt::format(
      "{}{}: scatter makes joints {:.3g} times as strong on average; is scatter.area = {:g} m2 meant, for a face?",
      source.prefix(), what, mean, scatter.area);
}

/// Faces that bonds join, with the scatter of the bond's own.
template <class Scattered>
void place_bonds(scene::Scene const& scene, Mesh const& mesh, std::vector<int> const& across,
                 Scattered const& scattered, JointStrengths& strengths) {
  std::map<std::size_t, BondedFace> bond_of;  // use of a face
  std::map<std::pair<int, int>, bool> meet;
  int const corners = node_count(mesh.kind);
  for (auto const& face : mesh.bonded) {
    for (int const side : face.use) bond_of[static_cast<std::size_t>(side)] = face;
    meet[{mesh.body_of_cell(face.use[0] / corners), mesh.body_of_cell(face.use[1] / corners)}] = true;
  }
  std::vector<int> faces(scene.bonds.size(), 0), free(scene.bonds.size(), 0);
  std::vector<double> measure(scene.bonds.size(), 0), least(scene.bonds.size(), 1), most(scene.bonds.size(), 1),
      sum(scene.bonds.size(), 0);
  for (auto const& [bodies, any] : meet)
    for (auto const& face : inner_faces(mesh, bodies.first, bodies.second, across)) {
      auto const k = static_cast<std::size_t>(bond_of.at(face.uses[0]).bond);
      double strength = 1;
      if (!bond_of.at(face.uses[0]).joined) {
        for (std::size_t const use : face.uses) strengths.of_face[use] = 0, strengths.any_plane[use] = 0;
        ++free[k];
        continue;
      }
      if (auto const& scatter = scene.bonds[k].scatter)
        strength = scattered(*scatter, key_of(scene.bonds[k].name) ^ key_of(scene.bodies[bodies.first].name), face,
                             mesh.body_first_node[bodies.first]);
      for (std::size_t const use : face.uses) strengths.of_face[use] = strength, strengths.any_plane[use] = 0;
      if (faces[k]++ == 0) least[k] = most[k] = strength;
      measure[k] += face.measure, sum[k] += strength, least[k] = std::min(least[k], strength),
                                                      most[k] = std::max(most[k], strength);
    }
  for (std::size_t k = 0; k < scene.bonds.size(); ++k) {
    std::string bodies;
    for (int const b : scene.bonds[k].bodies) bodies += (bodies.empty() ? "" : ", ") + scene.bodies[b].name;
    if (scene.bonds[k].bodies.size() > 4) bodies = fmt::format("{} bodies", scene.bonds[k].bodies.size());
    strengths.lines.push_back(fmt::format(
        "{}: {} faces between {}, {:.4g} {}{}{}", scene.bonds[k].name, faces[k], bodies, measure[k],
        corners == 3 ? "m" : "m2",
        scene.bonds[k].scatter ? fmt::format(", strengths from {:.3g} to {:.3g} of the bond's", least[k], most[k]) : "",
        free[k] > 0 ? fmt::format("; {} more are left out: cracks from the start", free[k]) : ""));
    if (scene.bonds[k].scatter && (sum[k] / faces[k] < 0.2 || sum[k] / faces[k] > 5))
      strengths.doubts.push_back(doubt_of_scatter(scene.bonds[k].source,
                                                  fmt::format("bond \"{}\"", scene.bonds[k].name), sum[k] / faces[k],
                                                  *scene.bonds[k].scatter));
  }
}

/// The joints{} that a face of body b belongs to; -1: none.
int set_of(scene::Scene const& scene, int b, InnerFace const& face, Mesh const& mesh, double close) {
  int known = -1;
  for (std::size_t k = 0; k < scene.joint_sets.size(); ++k) {
    auto const& set = scene.joint_sets[k];
    if (set.body != b || !belongs(set, face, mesh, close)) continue;
    if (known >= 0)
      throw Error(
          set.source,
          fmt::format(
              "joints \"{}\" and \"{}\" have the face near ({:.4g}, {:.4g}, {:.4g}) in common; a face has one "
              "strength; let their angles not meet, or leave places out of one of them with at = function(x, y, z)",
              set.name, scene.joint_sets[static_cast<std::size_t>(known)].name, face.middle.x(), face.middle.y(),
              face.middle.z()));
    known = static_cast<int>(k);
  }
  return known;
}

/// Refuses sets without faces, and doubts those whose line has none in places.
void say_what_sets_have(scene::Scene const& scene, bool flat, std::vector<int> const& faces_of_set,
                        std::vector<double> const& measure_of_set, JointStrengths& strengths) {
  for (std::size_t k = 0; k < scene.joint_sets.size(); ++k) {
    auto const& set = scene.joint_sets[k];
    if (faces_of_set[k] == 0)
      throw Error(set.source,
                  fmt::format("joints \"{}\": no face of body \"{}\" belongs to them{}", set.name,
                              scene.bodies[set.body].name, set.seam ? "; mesh.seam gives the mesh faces there" : ""));
    strengths.lines.push_back(
        fmt::format("{}: {} faces of {}, {:.4g} {}, {}", set.name, faces_of_set[k], scene.bodies[set.body].name,
                    measure_of_set[k], flat ? "m" : "m2",
                    set.strength > 0 ? fmt::format("{:g} of its strength", set.strength) : "broken from the start"));
    if (!set.seam || set.inside || set.facing || (!flat && set.seam->corners.empty())) continue;
    double const whole = flat ? std::hypot(set.seam->to[0] - set.seam->from[0], set.seam->to[1] - set.seam->from[1])
                              : Plane(set.seam->corners).area();
    if (measure_of_set[k] < 0.99 * whole)
      strengths.doubts.push_back(fmt::format(
          "{}joints \"{}\": faces lie on {:.3g} of the {}'s {:.3g} {}; the rest is outside of the body, or its mesh "
          "has no faces there",
          set.source.prefix(), set.name, measure_of_set[k], flat ? "line" : "polygon", whole, flat ? "m" : "m2"));
  }
}

}  // namespace

JointStrengths joint_strengths(scene::Scene const& scene, Mesh const& mesh) {
  JointStrengths strengths;
  bool any = !scene.joint_sets.empty() || !scene.bonds.empty();
  for (auto const& body : scene.bodies) any = any || scene.materials[body.material].scatter;
  if (!any) return strengths;
  strengths.of_face.assign(mesh.cells.size(), 1);
  strengths.any_plane.assign(mesh.cells.size(), 1);
  strengths.least.assign(mesh.n_bodies(), 1);
  auto const across = neighbours(mesh);
  bool const flat = mesh.kind == CellKind::triangle;
  std::vector<int> faces_of_set(scene.joint_sets.size(), 0);
  std::vector<double> measure_of_set(scene.joint_sets.size(), 0);
  auto const scattered = [&](scene::Scatter const& scatter, std::uint64_t key, InnerFace const& face, int first_node) {
    double const reach = !flat                           ? 1
                         : scene.two_d == "axisymmetric" ? 2 * std::numbers::pi * face.middle.x()
                                                         : mesh.thickness;
    double const over = scatter.area > 0 ? face.measure * reach / scatter.area : 1;
    return std::max(1e-3, drawn(scatter, key, face, first_node) * std::pow(over, -1 / scatter.modulus));
  };
  for (int b = 0; b < mesh.n_bodies(); ++b) {
    auto const& material = scene.materials[scene.bodies[b].material];
    if (!material.joint) continue;
    double const close = 1e-6 * width(mesh, b);
    std::uint64_t const key = key_of(scene.bodies[b].name);
    double least = INFINITY, most = 0, sum = 0;
    int faces = 0;
    for (auto const& face : inner_faces(mesh, b, b, across)) {
      double strength = 1;
      if (auto const& scatter = material.scatter) {
        strength = scattered(*scatter, key, face, mesh.body_first_node[b]);
        least = std::min(least, strength), most = std::max(most, strength), sum += strength, ++faces;
      }
      int const known = set_of(scene, b, face, mesh, close);
      if (known >= 0) {
        strength *= scene.joint_sets[known].strength;
        ++faces_of_set[known], measure_of_set[known] += face.measure;
      }
      if (strength > 0) strengths.least[b] = std::min(strengths.least[b], strength);
      for (std::size_t const use : face.uses)
        strengths.of_face[use] = strength, strengths.any_plane[use] = known >= 0 ? 0 : 1;
    }
    if (faces == 0) continue;
    auto const& scatter = *material.scatter;
    std::string const& name = scene.bodies[b].name;
    strengths.lines.push_back(fmt::format(
        "{}: strengths scatter from {:.3g} to {:.3g} of the material's, {:.3g} on average (Weibull, m = {:g}, seed {})",
        name, least, most, sum / faces, scatter.modulus, scatter.seed));
    if (sum / faces < 0.2 || sum / faces > 5)
      strengths.doubts.push_back(
          doubt_of_scatter(scene.bodies[b].source, fmt::format("body \"{}\"", name), sum / faces, scatter));
  }
  say_what_sets_have(scene, flat, faces_of_set, measure_of_set, strengths);
  place_bonds(scene, mesh, across, scattered, strengths);
  return strengths;
}

}  // namespace fissure::mesh
