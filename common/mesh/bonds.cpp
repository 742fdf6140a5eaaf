// Bodies that are bonded: which of their faces meet, and which nodes are at one place.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "mesh/part.h"

namespace fissure::mesh {
namespace {

/// The face of its cell that a boundary face is.
int use_of(Mesh const& mesh, Face const& face) {
  int const corners = node_count(mesh.kind), first = face.cell * corners;
  int a = 0;
  while (std::find(face.node.begin(), face.node.begin() + corners - 1, mesh.cells[first + a]) !=
         face.node.begin() + corners - 1)
    ++a;
  return first + a;
}

Vec3 middle_of(Mesh const& mesh, Face const& face) {
  int const points = node_count(mesh.kind) - 1;
  Vec3 middle = Vec3::Zero();
  for (int i = 0; i < points; ++i) middle += mesh.nodes[face.node[i]] / points;
  return middle;
}

/// Nodes at one place, found pair by pair.
class Twins {
 public:
  explicit Twins(std::size_t nodes) : lowest_(nodes) { std::iota(lowest_.begin(), lowest_.end(), 0); }
  void unite(int a, int b) {
    int const one = lowest(a), other = lowest(b);
    lowest_[std::max(one, other)] = std::min(one, other);
  }
  int lowest(int node) const {
    while (lowest_[node] != node) node = lowest_[node];
    return node;
  }

 private:
  std::vector<int> lowest_;
};

/// Takes faces from the boundary and from the places that have them.
void drop_from_boundary(Mesh& mesh, std::set<int> const& dropped) {
  std::vector<int> number(mesh.boundary.size(), -1);
  std::vector<Face> kept;
  for (int f = 0; f < static_cast<int>(mesh.boundary.size()); ++f)
    if (!dropped.contains(f)) number[f] = static_cast<int>(kept.size()), kept.push_back(mesh.boundary[f]);
  mesh.boundary = std::move(kept);
  for (auto& places : mesh.named_faces)
    for (auto& [name, faces] : places) {
      for (int& face : faces) face = number[face];
      std::erase(faces, -1);
    }
}

/// Bonds at work on a mesh.
class Bonding {
 public:
  Bonding(Mesh& mesh, scene::Scene const& scene) : mesh_(mesh), scene_(scene), twins_(mesh.nodes.size()) {}

  void join(std::size_t k) {
    auto const& bond = scene_.bonds[k];
    for (int const b : bond.bodies)
      if (mesh_.n_blocks(b) > 0)
        refuse(k, name(b) + " has cells that are blocks; bonds are for bodies of simplices (cells = \"simplex\")");
    std::vector<char> meets(bond.bodies.size(), false);
    std::size_t meeting = 0, first = mesh_.bonded.size();
    for (std::size_t i = 0; i < bond.bodies.size(); ++i)
      for (std::size_t j = i + 1; j < bond.bodies.size(); ++j) {
        auto const pairs = common_faces(k, bond.bodies[i], bond.bodies[j]);
        meeting += pairs.size();
        if (!pairs.empty()) meets[i] = meets[j] = true;
        for (auto const& pair : pairs) {
          Vec3 const at = middle_of(mesh_, mesh_.boundary[pair[0]]);
          if (!bond.inside || bond.inside(at.x(), at.y(), at.z())) add(k, pair, true);
        }
      }
    for (std::size_t i = 0; i < meets.size(); ++i)
      if (!meets[i])
        refuse(k, name(bond.bodies[i]) +
                      " meets none of the others; bodies must touch, face to face, where they are bonded");
    if (mesh_.bonded.size() == first)
      refuse(k, fmt::format("its function said true for none of the {} faces where its bodies meet", meeting));
  }
  /// Faces where bodies that bonds hold together meet without a bond: their corners may be joined, so that they cannot
  /// be told apart from a crack's.
  void leave_cracks() {
    std::map<int, std::size_t> bond_of_body;
    for (std::size_t k = 0; k < scene_.bonds.size(); ++k)
      for (int const b : scene_.bonds[k].bodies) bond_of_body.emplace(b, k);
    for (auto const& [a, k] : bond_of_body)
      for (auto const& [b, other] : bond_of_body)
        if (a < b && near(a, b))
          for (auto const& pair : doubled_faces(mesh_, a, b).pairs)
            if (!bond_of_.contains(pair[0])) add(k, pair, false);
  }
  void finish() {
    mesh_.twin.resize(mesh_.nodes.size());
    for (std::size_t n = 0; n < mesh_.twin.size(); ++n) {
      mesh_.twin[n] = twins_.lowest(static_cast<int>(n));
      mesh_.nodes[n] = mesh_.nodes[mesh_.twin[n]];
    }
    std::set<int> inside;
    for (auto const& [face, bond] : bond_of_) inside.insert(face);
    drop_from_boundary(mesh_, inside);
  }

 private:
  std::string name(int b) const { return fmt::format("body \"{}\"", scene_.bodies[b].name); }
  [[noreturn]] void refuse(std::size_t k, std::string const& text) const {
    throw Error(scene_.bonds[k].source, fmt::format("bond \"{}\": {}", scene_.bonds[k].name, text));
  }
  /// Whether boxes about two bodies meet.
  bool near(int a, int b) const {
    auto const box = [&](int body) {
      Vec3 low = mesh_.nodes[mesh_.body_first_node[body]], high = low;
      for (int n = mesh_.body_first_node[body]; n < mesh_.body_first_node[body + 1]; ++n)
        low = low.cwiseMin(mesh_.nodes[n]), high = high.cwiseMax(mesh_.nodes[n]);
      double const close = 1e-6 * (high - low).maxCoeff();
      return std::pair<Vec3, Vec3>(low.array() - close, high.array() + close);
    };
    auto const one = box(a), other = box(b);
    return (one.first.array() <= other.second.array()).all() && (other.first.array() <= one.second.array()).all();
  }
  std::vector<std::array<int, 2>> common_faces(std::size_t k, int one, int other) const {
    auto const [a, b] = std::minmax(one, other);
    if (!near(a, b)) return {};
    auto const common = doubled_faces(mesh_, a, b);
    Vec3 const& p = common.place;
    if (common.unmatched)
      refuse(k, fmt::format("faces of {} and {} lie on each other near ({:.4g}, {:.4g}, {:.4g}) and their nodes do not "
                            "match; regular grids need one spacing and files one mesh, and other shapes are fitted "
                            "where neither is structured or a file",
                            name(a), name(b), p.x(), p.y(), p.z()));
    return common.pairs;
  }
  void add(std::size_t k, std::array<int, 2> const& pair, bool joined) {
    int const points = node_count(mesh_.kind) - 1;
    auto const &one = mesh_.boundary[pair[0]], &other = mesh_.boundary[pair[1]];
    for (int const face : pair)
      if (auto const known = bond_of_.find(face); known != bond_of_.end()) {
        Vec3 const at = middle_of(mesh_, one);
        refuse(k, fmt::format("the face near ({:.4g}, {:.4g}, {:.4g}) is of bond \"{}\", too; a face has one bond",
                              at.x(), at.y(), at.z(), scene_.bonds[known->second].name));
      }
    bond_of_[pair[0]] = bond_of_[pair[1]] = k;
    mesh_.bonded.push_back({{use_of(mesh_, one), use_of(mesh_, other)}, static_cast<int>(k), joined});
    for (int m = 0; m < points; ++m)
      twins_.unite(one.node[m], *std::min_element(other.node.begin(), other.node.begin() + points, [&](int x, int y) {
                     return (mesh_.nodes[x] - mesh_.nodes[one.node[m]]).norm() <
                            (mesh_.nodes[y] - mesh_.nodes[one.node[m]]).norm();
                   }));
  }

  Mesh& mesh_;
  scene::Scene const& scene_;
  Twins twins_;
  std::map<int, std::size_t> bond_of_;  // boundary faces
};

}  // namespace

void bond_bodies(Mesh& mesh, scene::Scene const& scene) {
  if (scene.bonds.empty()) return;
  Bonding bonding(mesh, scene);
  for (std::size_t k = 0; k < scene.bonds.size(); ++k) bonding.join(k);
  bonding.leave_cracks();
  bonding.finish();
}

}  // namespace fissure::mesh
