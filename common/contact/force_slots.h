// Where contact forces go: every candidate's corners own slots, and every touched vertex sums those of its own that may
// have a force, in order, so that the sum has the same bits for any number of threads.
#pragma once
#include <algorithm>
#include <vector>

#include "contact/broad_phase.h"
#include "kernels/contact_sums.h"
#include "model/model.h"

namespace fissure {

template <int D, class Real>
class ForceSlots {
 public:
  /// As many slots, without forces.
  void place(Device& device, std::size_t slots) {
    count_ = slots;
    force_ = Buffer<Real>(device, "contact slots", slots * D);
    stiffness_ = Buffer<Real>(device, "contact slots", slots);
  }
  /// More slots, without forces; the others keep theirs.
  void grow(Device& device, std::size_t slots) {
    count_ = slots;
    if (slots <= stiffness_.size()) return;
    std::size_t const room = slots + slots / 2;
    auto forces = force_.download(), stiffnesses = stiffness_.download();
    forces.resize(room * D), stiffnesses.resize(room);
    force_ = Buffer<Real>(device, "contact slots", forces);
    stiffness_ = Buffer<Real>(device, "contact slots", stiffnesses);
  }
  /// Vertices sum these slots, ascending, and no others; `vertex` of each. The beds' rows at touched vertices follow.
  void list(Device& device, std::vector<Index> const& slots, std::vector<Index> const& vertex, Index n_vertices) {
    auto lists = contact::slot_lists(vertex, n_vertices);
    for (Index& slot : lists.slot) slot = slots[slot];
    touched_ = Buffer<Index>(device, "contact slots", lists.vertex);
    first_ = Buffer<Index>(device, "contact slots", lists.first);
    slot_ = Buffer<Index>(device, "contact slots", lists.slot);
    force_at_vertex_ = Buffer<Real>(device, "contact slots", lists.vertex.size() * D);
    lists_ = std::move(lists);
  }
  /// What the step has room for at each touched vertex [1/s^2].
  void set_room(Device& device, std::vector<double> const& room) {
    room_ = Buffer<double>(device, "contact slots", room);
  }

  bool empty() const { return count_ == 0; }
  std::vector<Index> const& vertices() const { return lists_.vertex; }  // touched, ascending
  /// Of all slots [slot][D] [N].
  std::vector<Real> forces() const { return force_.download(); }
  Real* force(Index slot) { return force_.data() + static_cast<std::size_t>(slot) * D; }
  Real* stiffness(Index slot) { return stiffness_.data() + slot; }

  /// Adds them to the vertices; returns by how much the stiffest touched vertex is stiffer than there is room for, over
  /// its mass [1/s^2].
  double add(Device& device, model::Model<D, Real>& model) {
    return largest_over<1>(device, 0, static_cast<Index>(touched_.size()),
                           kernels::AddContact<D, Real>{.vertex = touched_.data(),
                                                        .first = first_.data(),
                                                        .slot = slot_.data(),
                                                        .slot_force = force_.data(),
                                                        .slot_stiffness = stiffness_.data(),
                                                        .inverse_mass = model.inverse_inertia(),
                                                        .room = room_.data(),
                                                        .force = model.vertex_force(),
                                                        .sum_force = force_at_vertex_.data()})[0];
  }
  /// What these slots added last acts no more, neither on vertices nor in their work.
  void take_back(model::Model<D, Real>& model, std::vector<Index> slots) {
    std::sort(slots.begin(), slots.end());
    auto const by_slot = force_.download();
    auto total = model.vertices.force.download(), touched = force_at_vertex_.download();
    for (std::size_t t = 0; t < lists_.vertex.size(); ++t)
      for (Index k = lists_.first[t]; k < lists_.first[t + 1]; ++k) {
        Index const slot = lists_.slot[k];
        if (!std::binary_search(slots.begin(), slots.end(), slot)) continue;
        for (int c = 0; c < D; ++c) {
          Real const force = by_slot[static_cast<std::size_t>(slot) * D + c];
          total[static_cast<std::size_t>(lists_.vertex[t]) * D + c] -= force;
          touched[t * D + c] -= force;
        }
      }
    model.vertices.force.upload(total), force_at_vertex_.upload(touched);
  }
  /// Work of the forces added last over a time, with the velocities now [J].
  double work(Device& device, model::Model<D, Real> const& model, double time) const {
    return sum_over<1>(device, 0, static_cast<Index>(touched_.size()),
                       kernels::ContactVertexWork<D, Real>{.vertex = touched_.data(),
                                                           .sum_force = force_at_vertex_.data(),
                                                           .v = model.vertices.v.data(),
                                                           .share_of_dt = time})[0];
  }

 private:
  std::size_t count_ = 0;
  contact::SlotLists lists_;
  Buffer<Index> touched_, first_, slot_;
  Buffer<Real> force_, stiffness_;  // by slot [N], [N/m]
  Buffer<Real> force_at_vertex_;
  Buffer<double> room_;
};

}  // namespace fissure
