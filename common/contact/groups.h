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

  void find(Device& device, model::Model<D, Real> const& model, Bonds<D, Real> const& bonds,
            std::vector<contact::ElementPair> const& pairs);

  Index count() const { return static_cast<Index>(force_.size() / D); }
  Index const* of_slot() const { return group_.data(); }  // [pair][2][D + 1]
  Index const* first() const { return first_.data(); }    // slots of each
  Index const* slot() const { return slot_.data(); }
  Real* force() { return force_.data(); }    // [group][D] without friction [N]
  Real* weight() { return weight_.data(); }  // by slot: share of the corner in the point of action

  void save(State& state) const { state["contact groups"] = state_bytes(of_slot_); }
  /// `slots`: of pairs, where they have friction, else 0.
  void restore(Device& device, State const& state, std::size_t slots) {
    of_slot_ = state_values<Index>(state, "contact groups", slots);
    for (Index const group : of_slot_) check_index("contact groups", group, slots);
    if (slots > 0) place(device);
  }

 private:
  static constexpr Index none = -1;

  void place(Device& device) {
    Index const n = of_slot_.empty() ? 0 : *std::max_element(of_slot_.begin(), of_slot_.end()) + 1;
    auto const lists = contact::slot_lists(of_slot_, n);
    group_ = Buffer<Index>(device, "contact groups", of_slot_);
    first_ = Buffer<Index>(device, "contact groups", lists.first);
    slot_ = Buffer<Index>(device, "contact groups", lists.slot);
    force_ = Buffer<Real>(device, "contact groups", static_cast<std::size_t>(n) * D);
    weight_ = Buffer<Real>(device, "contact groups", of_slot_.size());
  }

  std::vector<Index> of_slot_;
  Buffer<Index> group_, first_, slot_;
  Buffer<Real> force_, weight_;
};

template <int D, class Real>
void ContactGroups<D, Real>::find(Device& device, model::Model<D, Real> const& model, Bonds<D, Real> const& bonds,
                                  std::vector<contact::ElementPair> const& pairs) {
  std::vector<Index> piece(model.elements.count);
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
  // Of a vertex, its groups in a row, each with another piece: a vertex has few.
  struct Group {
    Index piece, before;
  };
  std::vector<Group> groups;
  std::vector<Index> last(model.vertices.count, none);  // group of a vertex
  of_slot_.clear();
  for (auto const& [a, b] : pairs)
    for (auto const& [mine, other] : {std::pair(a, b), std::pair(b, a)})
      for (Index c = 0, piece_of_other = root(other); c < C; ++c) {
        Index const corner = model.plan.joints ? bonds.root_of(mine * C + c) : mine * C + c;
        Index& newest = last[model.vertex_of(corner / C, corner % C)];
        Index group = newest;
        while (group != none && groups[group].piece != piece_of_other) group = groups[group].before;
        if (group == none) {
          group = static_cast<Index>(groups.size());
          groups.push_back({piece_of_other, newest});
          newest = group;
        }
        of_slot_.push_back(group);
      }
  place(device);
}

}  // namespace fissure
