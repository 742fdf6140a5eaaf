// Faces of cells, sorted by their nodes.
#include "mesh/faces.h"

#include <algorithm>
#include <tuple>

#include "mesh/simplex.h"

namespace fissure::mesh {

std::vector<FaceUse> sorted_faces(std::span<int const> cells, int corners) {
  std::vector<FaceUse> faces(cells.size());
  for (int use = 0; use < static_cast<int>(cells.size()); ++use) {
    int const a = use % corners, first = use - a;
    FaceUse face{{-1, -1, -1}, use};
    int filled = 0;
    for (int b : face_corners(corners, a)) face.nodes[filled++] = cells[first + b];
    face.nodes = sorted(face.nodes);
    faces[use] = face;
  }
  std::sort(faces.begin(), faces.end(),
            [](FaceUse const& p, FaceUse const& q) { return std::tie(p.nodes, p.use) < std::tie(q.nodes, q.use); });
  return faces;
}

std::vector<int> neighbours(std::vector<FaceUse> const& faces, int corners) {
  std::vector<int> across(faces.size(), -1);
  for (std::size_t i = 1; i < faces.size(); ++i) {
    if (faces[i].nodes != faces[i - 1].nodes) continue;
    across[faces[i].use] = faces[i - 1].use / corners;
    across[faces[i - 1].use] = faces[i].use / corners;
  }
  return across;
}

std::vector<int> neighbours(Mesh const& mesh) {
  int const corners = node_count(mesh.kind);
  auto across = neighbours(sorted_faces(mesh.cells, corners), corners);
  for (auto const& [use, bond, joined] : mesh.bonded)
    across[use[0]] = use[1] / corners, across[use[1]] = use[0] / corners;
  return across;
}

}  // namespace fissure::mesh
