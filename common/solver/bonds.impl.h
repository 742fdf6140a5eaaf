// Which elements hang together, so that they must not touch, and which lie bare, so that they may; a part of
// contact_stage.impl.h.
#pragma once
#include <algorithm>
#include <numeric>
#include <span>

#include "solver/contact_stage.h"

namespace fissure {

/// Every element with a corner at one of the nodes may touch: a face or only a corner of it is bare.
template <int D, class Real>
void ContactStage<D, Real>::expose_around(std::span<int const> nodes) {
  for (int node : nodes)
    for (Index k = node_first_[node]; k < node_first_[node + 1]; ++k) {
      Index const e = node_element_[k];
      exposed_[e] = changed_[e] = 1;
    }
}

template <int D, class Real>
Index ContactStage<D, Real>::root_of(Index corner) {
  while (parent_[corner] != corner) corner = parent_[corner] = parent_[parent_[corner]];
  return corner;
}

template <int D, class Real>
void ContactStage<D, Real>::connect_everything() {
  parent_.resize(static_cast<std::size_t>(model_.n_elements) * C);
  std::iota(parent_.begin(), parent_.end(), 0);
  loosened_nodes_.resize(node_first_.size() - 1);
  std::iota(loosened_nodes_.begin(), loosened_nodes_.end(), 0);
}

/// Corners at one node hang together when a chain of undamaged joints leads from one to the other: told anew for nodes
/// where a joint has softened.
template <int D, class Real>
void ContactStage<D, Real>::connect() {
  std::sort(loosened_nodes_.begin(), loosened_nodes_.end());
  loosened_nodes_.erase(std::unique(loosened_nodes_.begin(), loosened_nodes_.end()), loosened_nodes_.end());
  auto const corner_at = [&](Index e, int node) {
    int const* const nodes = &model_.corner_node[static_cast<std::size_t>(e) * C];
    return static_cast<Index>(std::lower_bound(nodes, nodes + C, node) - nodes);
  };
  for (int node : loosened_nodes_) {
    std::span const elements(&node_element_[node_first_[node]],
                             static_cast<std::size_t>(node_first_[node + 1] - node_first_[node]));
    for (Index e : elements) {
      Index const mine = e * C + corner_at(e, node);
      parent_[mine] = mine;
      for (Index f : elements)  // parts of a block share its corner
        if (f < e && model_.block_of(e) >= 0 && model_.block_of(f) == model_.block_of(e)) {
          parent_[mine] = root_of(f * C + corner_at(f, node));
          break;
        }
    }
    for (Index e : elements)
      for (Index a = 0, mine = corner_at(e, node); a < C; ++a) {
        Index const other = model_.host_link[kernels::blocked(e, a, C)] >> 2;
        if (a == mine || other <= e || loose_[static_cast<std::size_t>(e) * C + a]) continue;
        Index const one = root_of(e * C + mine), two = root_of(other * C + corner_at(other, node));
        parent_[std::max(one, two)] = std::min(one, two);
      }
  }
  loosened_nodes_.clear();
}

/// Two elements that must not touch: of a body that cannot touch itself, sides of a joint or of a crack that still
/// presses as one, or hanging together at a node.
template <int D, class Real>
bool ContactStage<D, Real>::joined(Index a, Index b) {
  bool const alike = model_.body_of_element[a] == model_.body_of_element[b];
  if (!alike && model_.host_bond.empty()) return false;
  if (alike && !touches_itself_[model_.body_of_element[a]]) return true;
  Index const one = model_.cell_head(a), other = model_.cell_head(b);
  for (Index part = one; model_.groups[model_.body_of_element[a]].split && part < one + model_.cell_parts(one); ++part)
    for (int i = 0; i < C; ++i)
      if (Index const across = model_.host_link[kernels::blocked(part, i, C)] >> 2;
          across != part && model_.cell_head(across) == other)
        return true;
  return std::binary_search(facing_.begin(), facing_.end(), std::pair<Index, Index>(std::minmax(one, other))) ||
         hang_together(a, b);
}

/// Two elements share a node, and a chain of undamaged joints leads from one to the other there.
template <int D, class Real>
bool ContactStage<D, Real>::hang_together(Index a, Index b) {
  bool const whole = !model_.groups[model_.body_of_element[a]].split;
  int const* const mine = &model_.corner_node[static_cast<std::size_t>(a) * C];
  int const* const theirs = &model_.corner_node[static_cast<std::size_t>(b) * C];
  for (int i = 0, j = 0; i < C && j < C;) {
    if (mine[i] == theirs[j]) {
      if (whole || root_of(a * C + i) == root_of(b * C + j)) return true;
      ++i, ++j;
    } else if (mine[i] < theirs[j]) {
      ++i;
    } else {
      ++j;
    }
  }
  return false;
}

/// A joint that has begun to soften holds no neighbourhood together any more: its elements may meet others across it
/// (each other they meet through the joint), before anything could have moved far enough to start with an overlap.
template <int D, class Real>
void ContactStage<D, Real>::loosen(Index e, Index a) {
  char& loose = loose_[static_cast<std::size_t>(e) * C + a];
  if (loose) return;
  loose = 1;
  Index const link = model_.host_link[kernels::blocked(e, a, C)];
  bare_[static_cast<std::size_t>(e) * C + a] = bare_[static_cast<std::size_t>(link >> 2) * C + (link & 3)] = 1;
  int nodes[D];
  for (int i = 0; i < D; ++i) nodes[i] = model_.corner_node[static_cast<std::size_t>(e) * C + i + (i >= a)];
  expose_around(nodes);
  loosened_nodes_.insert(loosened_nodes_.end(), nodes, nodes + D);
  stale_ = true;
}

/// Tells pairs whose forces make up one contact: those of corners that hang together at a node with the same piece,
/// elements that a chain of undamaged joints holds together.
template <int D, class Real>
void ContactStage<D, Real>::group_slots() {
  if (!rubs_) return;
  std::vector<Index> piece(model_.n_elements);
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
      if (model_.cell_of_element[e] < 0) continue;
      unite(e, group.split ? model_.cell_head(e) : group.first);
      for (Index a = 0; group.split && a < C; ++a)
        if (Index const other = model_.host_link[kernels::blocked(e, a, C)] >> 2;
            other > e && !loose_[static_cast<std::size_t>(e) * C + a])
          unite(e, other);
    }
  std::vector<std::uint64_t> keys;
  keys.reserve(pairs_.size() * 2 * C);
  for (auto const& [a, b] : pairs_)
    for (auto const& [mine, other] : {std::pair(a, b), std::pair(b, a)})
      for (Index c = 0; c < C; ++c) {
        Index const corner = model_.plan.joints ? root_of(mine * C + c) : mine * C + c;
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
