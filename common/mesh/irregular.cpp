// Moving inner nodes at random: mesh generators line edges up in a few directions, and cracks that can only follow
// edges would know them. A lattice whose faces all lie 30 degrees off the loaded plane cannot open under tension with
// threefold compression across it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "mesh/faces.h"
#include "mesh/part.h"
#include "mesh/simplex.h"

namespace fissure::mesh {

void make_irregular(Part& part, CellKind kind, double share, unsigned seed) {
  int const corners = node_count(kind);
  std::size_t const cells = part.cells.size() / corners;
  std::vector<double> shortest(part.nodes.size(), std::numeric_limits<double>::infinity());
  for (std::size_t cell = 0; cell < cells; ++cell)
    for (int a = 0; a < corners; ++a)
      for (int b = 0; b < corners; ++b) {
        int const p = part.cells[cell * corners + a], q = part.cells[cell * corners + b];
        if (p != q) shortest[p] = std::min(shortest[p], (part.nodes[p] - part.nodes[q]).norm());
      }
  // Nodes of faces that stand once are the body's shape and stay.
  std::vector<char> fixed(part.nodes.size(), 0);
  auto const faces = sorted_faces(part.cells, corners);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    bool const twice = (f > 0 && faces[f - 1].nodes == faces[f].nodes) ||
                       (f + 1 < faces.size() && faces[f + 1].nodes == faces[f].nodes);
    for (int node : faces[f].nodes)
      if (!twice && node >= 0) fixed[node] = 1;
  }

  std::mt19937 random(seed + 1);
  auto const uniform = [&] { return 2 * (static_cast<double>(random()) / 4294967296.0) - 1; };
  std::vector<Vec3> const before = part.nodes;
  for (std::size_t n = 0; n < part.nodes.size(); ++n) {
    Vec3 direction(0, 0, 0);
    do
      for (int c = 0; c < corners - 1; ++c) direction[c] = uniform();
    while (direction.squaredNorm() > 1);
    if (!fixed[n] && std::isfinite(shortest[n])) part.nodes[n] += share * shortest[n] * direction;
  }
  // A cell that came out much worse takes its nodes back; that can only happen to finitely many.
  for (bool again = true; again;) {
    again = false;
    for (std::size_t cell = 0; cell < cells; ++cell) {
      std::span<int const> const nodes(&part.cells[cell * corners], corners);
      Simplex const now(nodes, part.nodes), then(nodes, before);
      if (now.measure() * then.measure() > 0 && now.shape() > std::min(0.3, 0.8 * then.shape())) continue;
      for (int node : nodes) {
        if (part.nodes[node] != before[node]) again = true;
        part.nodes[node] = before[node];
      }
    }
  }
}

}  // namespace fissure::mesh
