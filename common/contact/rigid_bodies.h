// Rigid bodies that bodies touch: plates, which move as they are told or as a force drives them, and walls.
#pragma once
#include <cmath>
#include <vector>

#include "kernels/contact_sums.h"
#include "kernels/rigid_contact.h"
#include "model/model.h"
#include "model/state.h"

namespace fissure {

template <int D, class Real>
class RigidBodies {
 public:
  using Boxes = std::vector<kernels::RigidBox<D, Real>>;

  RigidBodies(Device& device, scene::Scene const& scene, Vec3 const& origin);

  Vec<double, D> velocity(int plate, double t) const;  // [m/s]
  Boxes boxes_at(double t) const;                      // plates where they are, as fast as at time t
  /// The same for kernels, in their array.
  kernels::RigidBox<D, Real> const* place_boxes(double t);
  kernels::HalfSpace<D, Real> const* planes() const { return planes_.data(); }
  std::vector<kernels::HalfSpace<D, Real>> host_planes() const { return planes_.download(); }
  /// What forces and bodies do at time t to the velocity of plates that forces drive; `kick` is the time from half step
  /// to half step, where velocities live.
  void push(double t, double kick);
  /// Asks servos whose time has come how fast their plates shall move from now on.
  void serve(double t, scene::Now const& now);
  /// Plates move on over a step of dt that begins at t.
  void move(double t, double dt);

  /// What bodies push them with now [N], and how far plates have come [m].
  std::vector<Vec3>& plate_forces() { return plate_force_; }
  std::vector<Vec3>& wall_forces() { return wall_force_; }
  std::vector<Vec3> const& plate_forces() const { return plate_force_; }
  std::vector<Vec3> const& wall_forces() const { return wall_force_; }
  std::vector<Vec3> const& displacements() const { return displacement_; }

  void save(State& state) const {
    state["plates now"] = state_bytes(displacement_), state["plate velocities"] = state_bytes(driven_);
    state["servos"] = state_bytes(served_);
  }
  void restore(State const& state) {
    displacement_ = state_values<Vec3>(state, "plates now", displacement_.size());
    driven_ = state_values<Vec3>(state, "plate velocities", driven_.size());
    served_ = state_values<double>(state, "servos", served_.size());
  }

 private:
  scene::Scene const& scene_;
  Vec3 origin_;
  std::vector<Vec3> plate_force_, displacement_, wall_force_;
  std::vector<Vec3> driven_;    // velocities of plates along directions that a force or a servo drives [m/s]
  std::vector<double> served_;  // of each plate's servo: how many of its intervals have begun
  Buffer<kernels::RigidBox<D, Real>> boxes_;
  Buffer<kernels::HalfSpace<D, Real>> planes_;
};

template <int D, class Real>
RigidBodies<D, Real>::RigidBodies(Device& device, scene::Scene const& scene, Vec3 const& origin)
    : scene_(scene),
      origin_(origin),
      plate_force_(scene.plates.size(), Vec3(0, 0, 0)),
      displacement_(scene.plates.size(), Vec3(0, 0, 0)),
      wall_force_(scene.walls.size(), Vec3(0, 0, 0)),
      driven_(scene.plates.size(), Vec3(0, 0, 0)),
      served_(scene.plates.size(), 0) {
  if (!scene.plates.empty()) boxes_ = Buffer<kernels::RigidBox<D, Real>>(device, "plates", scene.plates.size());
  if (scene.walls.empty()) return;
  std::vector<kernels::HalfSpace<D, Real>> planes(scene.walls.size());
  for (std::size_t w = 0; w < planes.size(); ++w)
    for (int c = 0; c < D; ++c) {
      planes[w].point[c] = static_cast<Real>(scene.walls[w].point[c] - origin[c]);
      planes[w].normal[c] = static_cast<Real>(scene.walls[w].normal[c] / scene.walls[w].normal.norm());
      planes[w].displacement[c] = planes[w].velocity[c] = 0;
    }
  planes_ = Buffer<kernels::HalfSpace<D, Real>>(device, "walls", planes);
}

template <int D, class Real>
Vec<double, D> RigidBodies<D, Real>::velocity(int plate, double t) const {
  Vec<double, D> v;
  for (int c = 0; c < D; ++c) {
    auto const& component = scene_.plates[plate].velocity[c];
    v[c] = component ? (t < 0 ? 0 : (*component)(t)) : driven_[plate][c];
  }
  return v;
}

template <int D, class Real>
typename RigidBodies<D, Real>::Boxes RigidBodies<D, Real>::boxes_at(double t) const {
  Boxes boxes(scene_.plates.size());
  for (std::size_t p = 0; p < boxes.size(); ++p) {
    auto const& box = scene_.plates[p].box;
    auto const v = velocity(static_cast<int>(p), t);
    for (int c = 0; c < D; ++c) {
      boxes[p].low[c] = static_cast<Real>(box.center[c] - origin_[c] - 0.5 * box.size[c]);
      boxes[p].high[c] = static_cast<Real>(box.center[c] - origin_[c] + 0.5 * box.size[c]);
      boxes[p].displacement[c] = static_cast<Real>(displacement_[p][c]);
      boxes[p].velocity[c] = static_cast<Real>(v[c]);
    }
  }
  return boxes;
}

template <int D, class Real>
kernels::RigidBox<D, Real> const* RigidBodies<D, Real>::place_boxes(double t) {
  boxes_.upload(boxes_at(t));
  return boxes_.data();
}

template <int D, class Real>
void RigidBodies<D, Real>::push(double t, double kick) {
  for (std::size_t p = 0; p < driven_.size(); ++p)
    for (int c = 0; c < D; ++c)
      if (auto const& plate = scene_.plates[p]; plate.force[c])
        driven_[p][c] += kick * (((*plate.force[c])(t) + plate_force_[p][c]) / plate.mass + scene_.gravity[c]);
}

template <int D, class Real>
void RigidBodies<D, Real>::serve(double t, scene::Now const& now) {
  for (std::size_t p = 0; p < served_.size(); ++p) {
    auto const& plate = scene_.plates[p];
    if (!plate.servo) continue;
    double const begun = 1 + std::floor(t / plate.servo->every * (1 + 1e-12));
    if (begun == served_[p]) continue;
    served_[p] = begun;
    auto const asked = plate.servo->velocity(now);
    for (int c = 0; c < D; ++c)
      if (!plate.velocity[c] && !plate.force[c]) driven_[p][c] = asked[c];
  }
}

template <int D, class Real>
void RigidBodies<D, Real>::move(double t, double dt) {
  for (std::size_t p = 0; p < displacement_.size(); ++p) {
    auto const v = velocity(static_cast<int>(p), t + 0.5 * dt);
    for (int c = 0; c < D; ++c) displacement_[p][c] += dt * v[c];
  }
}

}  // namespace fissure
