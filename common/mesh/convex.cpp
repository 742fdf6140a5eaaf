// Whether a body is convex, from its surface alone and in linear time.
#include <algorithm>
#include <cmath>
#include <map>

#include "mesh/mesh.h"

namespace fissure::mesh {

namespace {

/// One face of the surface with its outward unit normal.
struct Side {
  std::array<int, 3> node;
  Vec3 normal;
};

std::vector<Side> surface(Mesh const& mesh, int body) {
  int const corners = node_count(mesh.kind);
  std::vector<Side> sides;
  for (auto const& face : mesh.boundary) {
    if (face.cell < mesh.body_first_cell[body] || face.cell >= mesh.body_first_cell[body + 1]) continue;
    Side side{{face.node[0], face.node[1], corners == 4 ? face.node[2] : -1}, {0, 0, 0}};
    Vec3 const &x = mesh.nodes[side.node[0]], along = mesh.nodes[side.node[1]] - x;
    side.normal = corners == 4 ? Vec3(along.cross(mesh.nodes[side.node[2]] - x)) : Vec3(along[1], -along[0], 0);
    side.normal /= side.normal.norm();
    // The cell lies behind its face.
    double behind = 0;
    for (int a = 0; a < corners; ++a) behind += side.normal.dot(mesh.nodes[mesh.cells[face.cell * corners + a]] - x);
    if (behind > 0) side.normal *= -1;
    sides.push_back(side);
  }
  return sides;
}

}  // namespace

bool convex(Mesh const& mesh, int body) {
  auto const sides = surface(mesh, body);
  int const corners = node_count(mesh.kind) - 1;  // of a side
  // Ridges between sides: a node in 2D, an edge in 3D; and each node's neighbours on the surface.
  std::map<std::array<int, 2>, std::vector<int>> ridges;
  std::map<int, std::vector<int>> around;
  double edges = 0;
  for (int s = 0; s < static_cast<int>(sides.size()); ++s) {
    auto const& node = sides[s].node;
    for (int a = 0; a < corners; ++a) {
      int const p = node[a], q = node[(a + 1) % corners];
      edges += (mesh.nodes[p] - mesh.nodes[q]).norm() / corners;
      around[p].push_back(q), around[q].push_back(p);
      ridges[corners == 2 ? std::array{p, -1} : std::array{std::min(p, q), std::max(p, q)}].push_back(s);
    }
  }
  double const tolerance = 0.5 * edges / static_cast<double>(sides.size());

  // Where two sides meet at a hollow, the surface rises above the plane of one: how far, if followed uphill? Triangles
  // on a round surface leave hollows, too, but such that rise little, and gently.
  auto const height = [&](Side const& side, int node) {
    return side.normal.dot(mesh.nodes[node] - mesh.nodes[side.node[0]]);
  };
  auto const above = [&](Side const& side, int node) {
    return height(side, node) > std::max(tolerance, 0.2 * (mesh.nodes[node] - mesh.nodes[side.node[0]]).norm());
  };
  auto const rises = [&](Side const& side, int node) {
    for (bool higher = true; higher && !above(side, node);) {
      higher = false;
      for (int next : around[node])
        if (height(side, next) > height(side, node)) node = next, higher = true;
    }
    return above(side, node);
  };
  for (auto const& [ridge, meeting] : ridges) {
    if (meeting.size() != 2) return false;  // the body touches itself here already
    for (int k = 0; k < 2; ++k) {
      Side const &one = sides[meeting[k]], &other = sides[meeting[1 - k]];
      double const turn = one.normal.dot(other.normal);
      if (turn < -0.99) return false;  // a slit, or as sharp as one
      for (int a = 0; a < corners; ++a) {
        int const far = other.node[a];
        if (far == ridge[0] || far == ridge[1] || !(height(one, far) > 1e-6 * tolerance)) continue;
        if (turn < 0 || rises(one, far)) return false;
      }
    }
  }

  // One surface: no voids inside, and nothing beside it.
  std::vector<int> reached;
  std::map<int, bool> known;
  if (!around.empty()) reached.push_back(around.begin()->first), known[reached[0]] = true;
  for (std::size_t k = 0; k < reached.size(); ++k)
    for (int next : around[reached[k]])
      if (!known[next]) known[next] = true, reached.push_back(next);
  return reached.size() == around.size();
}

}  // namespace fissure::mesh
