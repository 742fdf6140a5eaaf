// Where contact forces go: every candidate's corners own slots, and every touched vertex sums those of its own, in
// order, so that the sum has the same bits for any number of threads.
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
  /// Slots for these vertices, in their order, without forces. The beds' rows at touched vertices follow.
  void place(Device& device, std::vector<Index> vertex_of_slot, Index n_vertices) {
    vertex_of_slot_ = std::move(vertex_of_slot);
    auto const lists = contact::slot_lists(vertex_of_slot_, n_vertices);
    vertices_ = lists.vertex;
    touched_ = Buffer<Index>(device, "contact slots", lists.vertex);
    first_ = Buffer<Index>(device, "contact slots", lists.first);
    slot_ = Buffer<Index>(device, "contact slots", lists.slot);
    force_at_vertex_ = Buffer<Real>(device, "contact slots", lists.vertex.size() * D);
    force_ = Buffer<Real>(device, "contact slots", vertex_of_slot_.size() * D);
    stiffness_ = Buffer<Real>(device, "contact slots", vertex_of_slot_.size());
  }
  /// What the step has room for at each touched vertex [1/s^2].
  void set_room(Device& device, std::vector<double> const& room) {
    room_ = Buffer<double>(device, "contact slots", room);
  }

  bool empty() const { return vertex_of_slot_.empty(); }
  std::vector<Index> const& vertices() const { return vertices_; }  // touched, ascending
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
  void take_back(model::Model<D, Real>& model, std::vector<Index> const& slots) {
    auto const by_slot = force_.download();
    auto total = model.vertices.force.download(), touched = force_at_vertex_.download();
    for (Index const slot : slots) {
      Index const vertex = vertex_of_slot_[slot];
      auto const at = std::lower_bound(vertices_.begin(), vertices_.end(), vertex) - vertices_.begin();
      for (int c = 0; c < D; ++c) {
        Real const force = by_slot[static_cast<std::size_t>(slot) * D + c];
        total[static_cast<std::size_t>(vertex) * D + c] -= force;
        touched[static_cast<std::size_t>(at) * D + c] -= force;
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
  std::vector<Index> vertex_of_slot_, vertices_;
  Buffer<Index> touched_, first_, slot_;
  Buffer<Real> force_, stiffness_;  // by slot [N], [N/m]
  Buffer<Real> force_at_vertex_;
  Buffer<double> room_;
};

}  // namespace fissure
