// How far a list of candidates looks, and whether things have moved beyond that.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <vector>

#include "contact/rigid_bodies.h"
#include "kernels/contact_sums.h"
#include "model/model.h"
#include "model/state.h"

namespace fissure {

/// A list holds what is nearer than its buffer. It is stale when anything has moved by the buffer relative to anything
/// else since it was made, or will have with the next step: what touches then must be on the list now, for it to limit
/// that step.
template <int D, class Real>
class ListAge {
 public:
  static constexpr double steps_per_list = 400, least_buffer = 0.05;  // [steps]; share of the largest buffer

  ListAge() = default;
  explicit ListAge(mesh::Mesh const& mesh) : reach_(std::numeric_limits<double>::infinity()) {
    // paper, sec. 2.3.1: a fifth of an element
    for (auto const& body : mesh::quality(mesh)) reach_ = std::min(reach_, 0.2 * body.mean_edge);
    buffer_ = least_buffer * reach_;
  }

  double buffer() const { return buffer_; }  // [m]
  /// Longest way of anything relative to anything since the list was made [m].
  double path() const { return path_; }
  long lists() const { return lists_; }
  long since_extension() const { return since_extension_; }

  /// One step more; `last_dt` led here, `dt` follows. True: the list is stale.
  bool advance(Device& device, model::Model<D, Real> const& model, RigidBodies<D, Real> const& rigid, double t,
               double last_dt, double dt);
  /// A new list follows: how far it looks.
  void begin_list();
  void begin_extension() { since_extension_ = 0; }
  /// It has these vertices, ascending.
  void follow(Device& device, std::vector<Index> const& vertices, std::span<Real const> u,
              RigidBodies<D, Real> const& rigid);
  /// And now these, too.
  void join(Device& device, std::vector<Index> const& vertices, std::span<Real const> u);

  void save(State& state) const;
  void restore(Device& device, State const& state, std::size_t vertices, std::size_t plates);

 private:
  double reach_ = 0, buffer_ = 0;   // largest buffer; that of the list [m]
  Buffer<Index> drifting_;          // vertices of the list
  Buffer<Real> start_;              // their displacements when it was made [m]
  std::vector<Vec3> plates_;        // those of plates
  std::array<double, D> middle_{};  // of the drift since [m]
  double ahead_ = 0;                // most that anything will move relative to anything in the next step [m]
  double path_ = 0;
  long lists_ = 0, since_list_ = 0, since_extension_ = 0;
};

template <int D, class Real>
bool ListAge<D, Real>::advance(Device& device, model::Model<D, Real> const& model, RigidBodies<D, Real> const& rigid,
                               double t, double last_dt, double dt) {
  ++since_list_, ++since_extension_;
  if (drifting_.empty()) return false;
  auto moved = largest_over<4 * D>(device, 0, static_cast<Index>(drifting_.size()),
                                   kernels::DriftSince<D, Real>{.vertex = drifting_.data(),
                                                                .start = start_.data(),
                                                                .u = model.vertices.u.data(),
                                                                .v = model.vertices.v.data()});
  double speed_squared = 0;
  for (int c = 0; c < D; ++c) speed_squared += std::pow(moved[2 * D + c] + moved[3 * D + c], 2);
  path_ += last_dt * std::sqrt(speed_squared);
  for (int c = 0; c < D; ++c) middle_[c] = 0.5 * (moved[D + c] - moved[c]);
  // By axis: the largest of -x and of x, for drift and for velocity.
  auto const include = [&](int c, double by, double v) {
    moved[c] = std::max(moved[c], -by), moved[D + c] = std::max(moved[D + c], by);
    moved[2 * D + c] = std::max(moved[2 * D + c], -v), moved[3 * D + c] = std::max(moved[3 * D + c], v);
  };
  for (std::size_t p = 0; p < rigid.displacements().size(); ++p) {
    auto const v = rigid.velocity(static_cast<int>(p), t);
    for (int c = 0; c < D; ++c) include(c, rigid.displacements()[p][c] - plates_[p][c], v[c]);
  }
  bool stale = false;
  ahead_ = 0;
  for (int c = 0; c < D; ++c) {
    if (!rigid.wall_forces().empty()) include(c, 0, 0);
    double const ahead = dt * (moved[2 * D + c] + moved[3 * D + c]);
    ahead_ = std::max(ahead_, ahead);
    stale = stale || moved[c] + moved[D + c] + ahead > buffer_;
  }
  return stale;
}

/// As wide as what moves in some hundred steps: a wide buffer means many candidates, a narrow one many lists.
template <int D, class Real>
void ListAge<D, Real>::begin_list() {
  if (since_list_ > 0)
    buffer_ = std::clamp(steps_per_list * path_ / static_cast<double>(since_list_), least_buffer * reach_, reach_);
  buffer_ = std::max(buffer_, 4 * ahead_);
  ++lists_;
  since_list_ = since_extension_ = 0;
  path_ = 0;
}

template <int D, class Real>
void ListAge<D, Real>::follow(Device& device, std::vector<Index> const& vertices, std::span<Real const> u,
                              RigidBodies<D, Real> const& rigid) {
  std::vector<Real> start;
  for (Index vertex : vertices)
    for (int c = 0; c < D; ++c) start.push_back(u[static_cast<std::size_t>(vertex) * D + c]);
  drifting_ = Buffer<Index>(device, "contact drift", vertices);
  start_ = Buffer<Real>(device, "contact drift", start);
  plates_ = rigid.displacements();
}

/// They start in the middle of the drift of the others: what these have moved before is none of theirs.
template <int D, class Real>
void ListAge<D, Real>::join(Device& device, std::vector<Index> const& vertices, std::span<Real const> u) {
  auto known = drifting_.download();
  auto start = start_.download();
  std::vector<Index> joining, sorted = known;
  std::sort(sorted.begin(), sorted.end());
  std::set_difference(vertices.begin(), vertices.end(), sorted.begin(), sorted.end(), std::back_inserter(joining));
  if (joining.empty()) return;
  for (Index vertex : joining) {
    known.push_back(vertex);
    for (int c = 0; c < D; ++c)
      start.push_back(static_cast<Real>(u[static_cast<std::size_t>(vertex) * D + c] - middle_[c]));
  }
  drifting_ = Buffer<Index>(device, "contact drift", known);
  start_ = Buffer<Real>(device, "contact drift", start);
}

template <int D, class Real>
void ListAge<D, Real>::save(State& state) const {
  state["drifting"] = state_bytes(drifting_.download()), state["drift start"] = state_bytes(start_.download());
  state["plates at build"] = state_bytes(plates_);
  state["list age"] = state_bytes(std::vector<long>{lists_, since_list_, since_extension_});
  state["list reach"] = state_bytes(std::vector<double>{buffer_, path_});
}

template <int D, class Real>
void ListAge<D, Real>::restore(Device& device, State const& state, std::size_t vertices, std::size_t plates) {
  auto const drifting = state_values<Index>(state, "drifting");
  for (Index const vertex : drifting) check_index("drifting", vertex, vertices);
  drifting_ = Buffer<Index>(device, "contact drift", drifting);
  start_ = Buffer<Real>(device, "contact drift", state_values<Real>(state, "drift start", drifting.size() * D));
  auto const counts = state_values<long>(state, "list age", 3);
  lists_ = counts[0], since_list_ = counts[1], since_extension_ = counts[2];
  plates_ = state_values<Vec3>(state, "plates at build", lists_ == 0 ? 0 : plates);
  auto const numbers = state_values<double>(state, "list reach", 2);
  buffer_ = numbers[0], path_ = numbers[1];
}

}  // namespace fissure
