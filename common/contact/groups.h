// Pairs of elements whose forces make up one contact, so that friction has the surface's normal and not that of one
// pair.
#pragma once
#include <algorithm>
#include <numeric>
#include <vector>

#include "contact/bonds.h"
#include "contact/broad_phase.h"
#include "model/model.h"
#include "model/state.h"

namespace fissure {

/// Corners that hang together at a node with the same piece: elements that a chain of joints holds together.
template <int D, class Real>
class ContactGroups {
 public:
  static constexpr int C = D + 1;

  /// Pieces are as bonds have them now, and slots as many; no pair presses.
  void divide(Device& device, model::Model<D, Real> const& model, Bonds<D, Real> const& bonds, std::size_t slots);
  /// Of the pairs that press, whose places among all of them these are.
  void find(Device& device, model::Model<D, Real> const& model, Bonds<D, Real> const& bonds,
            std::vector<contact::ElementPair> const& pairs, std::vector<Index> const& pressing);

  Index count() const { return static_cast<Index>(force_.size() / D); }
  Index const* of_corner() const { return group_.data(); }  // [pressing][2][D + 1]
  Index const* first() const { return first_.data(); }      // slots of each
  Index const* slot() const { return slot_.data(); }
  Real* force() { return force_.data(); }    // [group][D] without friction [N]
  Real* weight() { return weight_.data(); }  // by slot: share of the corner in the point of action

  void save(State& state) const {
    state["contact groups"] = state_bytes(of_corner_);
    state["contact pieces"] = state_bytes(piece_);
  }
  /// `pairs`: those that are watched; none without friction. Those of `pressing` press.
  void restore(Device& device, State const& state, std::size_t pairs, std::vector<Index> const& pressing,
               std::size_t elements) {
    of_corner_ = state_values<Index>(state, "contact groups", pairs > 0 ? pressing.size() * 2 * C : 0);
    piece_ = state_values<Index>(state, "contact pieces");
    for (Index const piece : piece_) check_index("contact pieces", piece, elements);
    if (pairs > 0) check_index("contact pieces", static_cast<long>(piece_.size()), elements + 1, elements);
    for (Index const group : of_corner_) check_index("contact groups", group, of_corner_.size());
    weight_ = Buffer<Real>(device, "contact groups", pairs * 2 * C);
    place(device, pressing);
  }

 private:
  static constexpr Index none = -1;

  void place(Device& device, std::vector<Index> const& pressing) {
    Index const n = of_corner_.empty() ? 0 : *std::max_element(of_corner_.begin(), of_corner_.end()) + 1;
    auto lists = contact::slot_lists(of_corner_, n);
    for (Index& slot : lists.slot) slot = pressing[slot / (2 * C)] * 2 * C + slot % (2 * C);
    group_ = Buffer<Index>(device, "contact groups", of_corner_);
    first_ = Buffer<Index>(device, "contact groups", lists.first);
    slot_ = Buffer<Index>(device, "contact groups", lists.slot);
    force_ = Buffer<Real>(device, "contact groups", static_cast<std::size_t>(n) * D);
  }

  std::vector<Index> of_corner_;
  std::vector<Index> piece_;   // of an element: the first of those that hang together with it
  std::vector<Index> newest_;  // group of a vertex, while they are found
  Buffer<Index> group_, first_, slot_;
  Buffer<Real> force_, weight_;
};

template <int D, class Real>
void ContactGroups<D, Real>::divide(Device& device, model::Model<D, Real> const& model, Bonds<D, Real> const& bonds,
                                    std::size_t slots) {
  auto& piece = piece_;
  piece.resize(model.elements.count);
  std::iota(piece.begin(), piece.end(), 0);
  auto const root = [&](Index e) {
    while (piece[e] != e) e = piece[e] = piece[piece[e]];
    return e;
  };
  auto const unite = [&](Index a, Index b) {
    Index const one = root(a), two = root(b);
    piece[std::max(one, two)] = std::min(one, two);
  };
  for (auto const& group : model.groups)
    for (Index e = group.first; e < group.first + group.count; ++e) {
      if (model.elements.cell[e] < 0) continue;
      unite(e, group.split ? model.cell_head(e) : group.first);
      for (Index a = 0; group.split && a < C; ++a)
        if (Index const other = model.neighbour({e, a}).element; other > e && !bonds.loose({e, a})) unite(e, other);
    }
  for (Index e = 0; e < model.elements.count; ++e) piece[e] = root(e);
  weight_ = Buffer<Real>(device, "contact groups", slots);
  of_corner_.clear();
  place(device, {});
}

template <int D, class Real>
void ContactGroups<D, Real>::find(Device& device, model::Model<D, Real> const& model, Bonds<D, Real> const& bonds,
                                  std::vector<contact::ElementPair> const& pairs, std::vector<Index> const& pressing) {
  // Of a vertex, its groups in a row, each with another piece: a vertex has few.
  struct Group {
    Index piece, before, vertex;
  };
  std::vector<Group> groups;
  newest_.resize(model.vertices.count, none);
  of_corner_.clear();
  for (Index const place : pressing)
    for (auto const& [mine, other] :
         {std::pair(pairs[place].a, pairs[place].b), std::pair(pairs[place].b, pairs[place].a)})
      for (Index c = 0; c < C; ++c) {
        Index const corner = model.plan.joints ? bonds.root_of(mine * C + c) : mine * C + c,
                    vertex = model.vertex_of(corner / C, corner % C);
        Index group = newest_[vertex];
        while (group != none && groups[group].piece != piece_[other]) group = groups[group].before;
        if (group == none) {
          group = static_cast<Index>(groups.size());
          groups.push_back({piece_[other], newest_[vertex], vertex});
          newest_[vertex] = group;
        }
        of_corner_.push_back(group);
      }
  for (auto const& group : groups) newest_[group.vertex] = none;
  place(device, pressing);
}

}  // namespace fissure
