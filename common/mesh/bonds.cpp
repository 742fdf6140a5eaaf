// Bodies that are bonded: which of their faces meet, and which nodes are at one place.
#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "mesh/part.h"

namespace fissure::mesh {
namespace {

/// The face of its cell that a boundary face is.
int use_of(Mesh const& mesh, Face const& face) {
  int const corners = node_count(mesh.kind), first = face.cell * corners;
  int a = 0;
  while (std::find(face.node.begin(), face.node.begin() + corners - 1, mesh.cells[first + a]) != face.node.begin() + corners - 1) ++a;
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

}  // namespace

void bond_bodies(Mesh& mesh, scene::Scene const& scene) {
  if (scene.bonds.empty()) return;
  std::map<int, std::size_t> bond_of;  // boundary face
  Twins twins(mesh.nodes.size());
  for (std::size_t k = 0; k < scene.bonds.size(); ++k) {
    auto const& bond = scene.bonds[k];
    auto const name = [&](int b) { return fmt::format("body \"{}\"", scene.bodies[b].name); };
    auto const refuse = [&](std::string const& text) { throw Error(bond.source, fmt::format("bond \"{}\": {}", bond.name, text)); };
    for (int const b : bond.bodies)
      if (mesh.n_blocks(b) > 0) refuse(name(b) + " has cells that are blocks; bonds are for bodies of simplices (cells = \"simplex\")");
    std::vector<char> joined(bond.bodies.size(), false);
    std::size_t meeting = 0, first = mesh.bonded.size();
    for (std::size_t i = 0; i < bond.bodies.size(); ++i)
      for (std::size_t j = i + 1; j < bond.bodies.size(); ++j) {
        auto const [a, b] = std::minmax(bond.bodies[i], bond.bodies[j]);
        auto const common = doubled_faces(mesh, a, b);
        Vec3 const& p = common.place;
        if (common.unmatched)
          refuse(fmt::format("faces of {} and {} lie on each other near ({:.4g}, {:.4g}, {:.4g}) and their nodes do not match; regular grids need one spacing and "
                             "files one mesh, and other shapes are fitted where neither is structured or a file",
                             name(a), name(b), p.x(), p.y(), p.z()));
        meeting += common.pairs.size();
        if (!common.pairs.empty()) joined[i] = joined[j] = true;
        for (auto const& [one, other] : common.pairs) {
          Vec3 const at = middle_of(mesh, mesh.boundary[one]);
          if (bond.inside && !bond.inside(at.x(), at.y(), at.z())) continue;
          for (int const face : {one, other})
            if (auto const known = bond_of.find(face); known != bond_of.end())
              refuse(fmt::format("the face near ({:.4g}, {:.4g}, {:.4g}) is of bond \"{}\", too; a face has one bond", at.x(), at.y(), at.z(),
                                 scene.bonds[known->second].name));
          bond_of[one] = bond_of[other] = k;
          mesh.bonded.push_back({{use_of(mesh, mesh.boundary[one]), use_of(mesh, mesh.boundary[other])}, static_cast<int>(k)});
          int const points = node_count(mesh.kind) - 1;
          for (int m = 0; m < points; ++m) {
            int const node = mesh.boundary[one].node[m];
            auto const& theirs = mesh.boundary[other].node;
            twins.unite(node, *std::min_element(theirs.begin(), theirs.begin() + points, [&](int x, int y) {
              return (mesh.nodes[x] - mesh.nodes[node]).norm() < (mesh.nodes[y] - mesh.nodes[node]).norm();
            }));
          }
        }
      }
    for (std::size_t i = 0; i < joined.size(); ++i)
      if (!joined[i]) refuse(name(bond.bodies[i]) + " meets none of the others; bodies must touch, face to face, where they are bonded");
    if (mesh.bonded.size() == first) refuse(fmt::format("its function said true for none of the {} faces where its bodies meet", meeting));
  }
  mesh.twin.resize(mesh.nodes.size());
  for (std::size_t n = 0; n < mesh.twin.size(); ++n) {
    mesh.twin[n] = twins.lowest(static_cast<int>(n));
    mesh.nodes[n] = mesh.nodes[mesh.twin[n]];
  }
  std::set<int> bonded;
  for (auto const& [face, bond] : bond_of) bonded.insert(face);
  drop_from_boundary(mesh, bonded);
}

}  // namespace fissure::mesh
