// Regular grids cut into simplices: Todd's triangulation J1 (M. J. Todd, "The Computation of Fixed Points and
// Applications", Springer 1976). Kuhn's cut of a cube takes one simplex per order of the axes, the path of edges from
// one corner to the opposite one; mirroring it in every odd cell keeps faces matching and prefers no direction.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/block_shape.h"
#include "mesh/part.h"

namespace fissure::mesh {
namespace {

std::array<double, 3> grid_counts(CellKind kind, Vec3 const& size, double spacing) {
  std::array<double, 3> n{0, 0, 0};
  for (int i = 0; i < node_count(kind) - 1; ++i) n[i] = std::max(1.0, std::round(size[i] / spacing));
  return n;
}

}  // namespace

double structured_count(CellKind kind, Vec3 const& size, double spacing) {
  std::array<double, 3> const n = grid_counts(kind, size, spacing);
  double count = 1;
  for (int i = 0; i < node_count(kind) - 1; ++i) count *= n[i] * (i + 1);  // d! simplices per grid cell
  return count;
}

Part structured_part(CellKind kind, Vec3 const& center, Vec3 const& size, double spacing, bool as_blocks) {
  auto const counts = grid_counts(kind, size, spacing);
  return structured_part(kind, center, size,
                         {static_cast<int>(counts[0]), static_cast<int>(counts[1]), static_cast<int>(counts[2])},
                         as_blocks);
}

Part structured_part(CellKind kind, Vec3 const& center, Vec3 const& size, std::array<int, 3> const& n, bool as_blocks) {
  int const axes = node_count(kind) - 1;
  auto const node = [&](std::array<int, 3> const& at) { return at[0] + (n[0] + 1) * (at[1] + (n[1] + 1) * at[2]); };

  Part part;
  for (int k = 0; k <= n[2]; ++k)
    for (int j = 0; j <= n[1]; ++j)
      for (int i = 0; i <= n[0]; ++i) {
        std::array<int, 3> const at{i, j, k};
        Vec3 p = Vec3::Zero();  // from the middle, so that the mesh is symmetric to the last bit about the origin
        for (int x = 0; x < axes; ++x) p[x] = center[x] + size[x] * ((2.0 * at[x] - n[x]) / (2.0 * n[x]));
        part.nodes.push_back(p);
      }

  std::array<int, 3> path{0, 1, 2};
  for (int k = 0; k < std::max(1, n[2]); ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        std::array<int, 3> const cell{i, j, k};
        if (as_blocks) {
          for (int a = 0; a < block_corners(kind); ++a) {
            std::array<int, 3> at = cell;
            for (int x = 0; x < axes; ++x) at[x] += BlockShape<3>::sign(a, x) > 0;
            part.blocks.push_back(node(at));
          }
          continue;
        }
        do {
          std::array<int, 3> at = cell;
          for (int x = 0; x < axes; ++x) at[x] += cell[x] % 2;
          part.cells.push_back(node(at));
          for (int step = 0; step < axes; ++step) {
            int const x = path[step];
            at[x] += cell[x] % 2 ? -1 : 1;
            part.cells.push_back(node(at));
          }
        } while (std::next_permutation(path.begin(), path.begin() + axes));
      }
  return part;
}

Mesh structured_box(CellKind kind, Vec3 const& center, Vec3 const& size, double spacing) {
  Mesh mesh = no_bodies(kind);
  add_body(mesh, structured_part(kind, center, size, spacing), "box", {});
  return mesh;
}

}  // namespace fissure::mesh
