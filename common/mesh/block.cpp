// Cutting blocks into simplices.
#include "mesh/block.h"

#include <algorithm>

namespace fissure::mesh {

std::vector<int> parts_of(std::span<int const> corner) {
  int const lowest = *std::min_element(corner.begin(), corner.end());
  std::vector<int> parts;
  // Adds `apex` and the two triangles of a face, each turned as the face is.
  auto const halves = [&](std::array<int, 4> face, int const* apex) {
    int const first = static_cast<int>(std::min_element(face.begin(), face.end()) - face.begin());
    for (int k : {1, 2}) {
      for (int at : {0, k, k + 1}) parts.push_back(face[(first + at) % 4]);
      if (apex) parts.push_back(*apex);
    }
  };
  if (corner.size() == 4) {
    halves({corner[0], corner[1], corner[2], corner[3]}, nullptr);
    return parts;
  }
  for (int a = 0; a < BlockShape<3>::faces; ++a) {
    std::array<int, 4> face;
    for (int i = 0; i < 4; ++i) face[i] = corner[BlockShape<3>::face(a, i)];
    if (std::find(face.begin(), face.end(), lowest) == face.end()) halves(face, &lowest);
  }
  // The apex lies on the inner side of the faces, where a tetrahedron has its last corner on the outer side of the
  // first three.
  for (std::size_t p = 0; p < parts.size(); p += 4) std::swap(parts[p], parts[p + 1]);
  return parts;
}

}  // namespace fissure::mesh
