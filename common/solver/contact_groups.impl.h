// Who may touch whom, and which pairs are one contact; a part of contact_stage.impl.h.
#pragma once
#include <algorithm>
#include <numeric>

#include "solver/contact_stage.h"

namespace fissure {

/// Neither bonded nor sides of a crack that still presses as a joint.
template <int D, class Real>
bool ContactStage<D, Real>::may_touch(Index a, Index b) const {
  std::pair<Index, Index> const cells = std::minmax(model_.cell_head(a), model_.cell_head(b));
  return !bonds_.joined(a, b) && !std::binary_search(facing_.begin(), facing_.end(), cells);
}

template <int D, class Real>
void ContactStage<D, Real>::loosen(FaceId face) {
  stale_ = bonds_.loosen(face) || stale_;
}

/// Tells pairs whose forces make up one contact: those of corners that hang together at a node with the same piece,
/// elements that a chain of undamaged joints holds together.
template <int D, class Real>
void ContactStage<D, Real>::group_slots() {
  if (!rubs_) return;
  std::vector<Index> piece(model_.elements.count);
  std::iota(piece.begin(), piece.end(), 0);
  auto const root = [&](Index e) {
    while (piece[e] != e) e = piece[e] = piece[piece[e]];
    return e;
  };
  auto const unite = [&](Index a, Index b) {
    Index const one = root(a), two = root(b);
    piece[std::max(one, two)] = std::min(one, two);
  };
  for (auto const& group : model_.groups)
    for (Index e = group.first; e < group.first + group.count; ++e) {
      if (model_.elements.cell[e] < 0) continue;
      unite(e, group.split ? model_.cell_head(e) : group.first);
      for (Index a = 0; group.split && a < C; ++a)
        if (Index const other = model_.neighbour({e, a}).element; other > e && !bonds_.loose({e, a})) unite(e, other);
    }
  std::vector<std::uint64_t> keys;
  keys.reserve(pairs_.size() * 2 * C);
  for (auto const& [a, b] : pairs_)
    for (auto const& [mine, other] : {std::pair(a, b), std::pair(b, a)})
      for (Index c = 0; c < C; ++c) {
        Index const corner = model_.plan.joints ? bonds_.root_of(mine * C + c) : mine * C + c;
        keys.push_back(static_cast<std::uint64_t>(model_.vertex_of(corner / C, corner % C)) << 32 |
                       static_cast<std::uint64_t>(root(other)));
      }
  auto sorted = keys;
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  group_of_slot_.clear();
  for (auto const key : keys)
    group_of_slot_.push_back(static_cast<Index>(std::lower_bound(sorted.begin(), sorted.end(), key) - sorted.begin()));
  place_groups();
}

template <int D, class Real>
void ContactStage<D, Real>::place_groups() {
  if (!rubs_) return;
  Index const n = group_of_slot_.empty() ? 0 : *std::max_element(group_of_slot_.begin(), group_of_slot_.end()) + 1;
  auto const lists = solver::slot_lists(group_of_slot_, n);
  group_ = Buffer<Index>(device_, "contact groups", group_of_slot_);
  group_first_ = Buffer<Index>(device_, "contact groups", lists.first);
  group_slot_ = Buffer<Index>(device_, "contact groups", lists.slot);
  group_force_ = Buffer<Real>(device_, "contact groups", static_cast<std::size_t>(n) * D);
  pair_weight_ = Buffer<Real>(device_, "contact groups", group_of_slot_.size());
}

}  // namespace fissure
