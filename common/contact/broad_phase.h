// Which elements may touch: every pair of boxes that overlap, found in linear time whatever their sizes and distances.
// The paper's DDBB (eqs. 3-8) on levels: a box lies on the level whose cells are just larger than it, so it covers at
// most 2^D cells, and meets the boxes of its own and of coarser levels there. Cells are hashed: empty space costs
// nothing. Eq. 8 lets only the cell min(up_p, up_q) report a pair; eq. 7 is read with "and" over the axes and both
// inequalities.
#pragma once
#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "base/lanes.h"

namespace fissure::contact {

/// Bounds of an element, grown by half the buffer on every side: boxes that do not overlap belong to elements
/// at least one buffer apart on some axis.
template <int D>
struct Bounds {
  std::array<double, D> low, high;  // [m]
};

struct ElementPair {
  Index a, b;  // a < b; for rigid bodies: element, body
  auto operator<=>(ElementPair const&) const = default;
};

/// What a search cost.
struct SearchCost {
  std::int64_t comparisons = 0;  // of two boxes
  std::int64_t entries = 0;      // boxes in cells
  int levels = 0;
};

/// All pairs of boxes that overlap or touch, sorted, each once; numbers are places in `boxes`.
/// `wanted`: only pairs in which one of the boxes is; empty: all. `lambda`: cell size of the middle level over the
/// boxes' mean largest extent (paper eq. 4). Throws Error when a box is not finite: the run has become unstable.
template <int D>
std::vector<ElementPair> overlapping_pairs(std::vector<Bounds<D>> const& boxes, std::vector<char> const& wanted = {},
                                           double lambda = 1.5, SearchCost* cost = nullptr);

/// Candidates of elements and rigid boxes: (place in `boxes`, place in `bodies`), sorted. Both grown by half the
/// buffer.
template <int D>
std::vector<ElementPair> pairs_with_boxes(std::vector<Bounds<D>> const& boxes, std::vector<Bounds<D>> const& bodies);

/// Candidates of elements and half-spaces: boxes that reach behind the plane through a point with a unit normal, when
/// the plane is moved out by `margin` (half the buffer) on each axis.
template <int D>
std::vector<ElementPair> pairs_with_planes(std::vector<Bounds<D>> const& boxes,
                                           std::vector<Vec<double, D>> const& points,
                                           std::vector<Vec<double, D>> const& normals, double margin);

/// What every vertex sums: kernels::AddContact reads it.
struct SlotLists {
  std::vector<Index> vertex;  // touched, ascending
  std::vector<Index> first;   // vertex.size() + 1
  std::vector<Index> slot;    // ascending within a vertex
};

/// From the vertex of every force slot; linear in slots.
SlotLists slot_lists(std::vector<Index> const& vertex_of_slot, Index n_vertices);

/// Springs [pair][kernels::spring_size<D>] of a new sorted list: those of the same pairs in the old one, `fresh` for
/// new pairs.
template <class Real>
std::vector<Real> carry_springs(std::vector<Real> const& fresh, std::vector<ElementPair> const& old_pairs,
                                std::vector<Real> const& old_springs, std::vector<ElementPair> const& new_pairs) {
  std::size_t const size = fresh.size();
  std::vector<Real> springs;
  springs.reserve(new_pairs.size() * size);
  std::size_t o = 0;
  for (auto const& pair : new_pairs) {
    while (o < old_pairs.size() && old_pairs[o] < pair) ++o;
    bool const known = o < old_pairs.size() && old_pairs[o] == pair;
    auto const from = known ? old_springs.begin() + static_cast<std::ptrdiff_t>(o * size) : fresh.begin();
    springs.insert(springs.end(), from, from + static_cast<std::ptrdiff_t>(size));
  }
  return springs;
}

}  // namespace fissure::contact
