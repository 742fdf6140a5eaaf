// Which cells share a face, found by sorting: linear memory, no hashing, the same answer every time.
#pragma once
#include <array>
#include <span>
#include <utility>
#include <vector>

namespace fissure::mesh {

/// A face's nodes in ascending order, the same for both its sides. Nodes it does not have are -1.
inline std::array<int, 3> sorted(std::array<int, 3> n) {
  if (n[0] > n[1]) std::swap(n[0], n[1]);
  if (n[1] > n[2]) std::swap(n[1], n[2]);
  if (n[0] > n[1]) std::swap(n[0], n[1]);
  return n;
}

/// Face a of a cell, by its sorted nodes; `use` is cell * corners + a.
struct FaceUse {
  std::array<int, 3> nodes;
  int use;
};

/// Faces of all cells in ascending order of their nodes, then of `use`.
std::vector<FaceUse> sorted_faces(std::span<int const> cells, int corners);

/// For every use of a face the cell on its other side, or -1. Expects at most two uses of every face.
std::vector<int> neighbours(std::vector<FaceUse> const& faces, int corners);

}  // namespace fissure::mesh
