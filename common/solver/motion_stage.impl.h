// Instantiated by src2d and src3d.
#pragma once
#include <cmath>

#include "kernels/advance.h"
#include "kernels/hanging.h"
#include "kernels/loads.h"
#include "solver/motion_stage.h"

namespace fissure {

template <int D, class Real>
void MotionStage<D, Real>::stay_on_axis() {
  if constexpr (Dim<D>::can_revolve)
    for_each(device_, 0, static_cast<Index>(model_.vertices.on_axis.size()),
             kernels::StayOnAxis<D, Real>{model_.vertices.on_axis.data(), model_.vertex_force()});
}

template <int D, class Real>
kernels::HoldTarget<D, Real> MotionStage<D, Real>::target(model::HoldSet<D, Real> const& set, double t, double dt) {
  kernels::HoldTarget<D, Real> target;
  if (t < 0 && !set.around) return target;  // bodies settle
  if (!set.around) {
    for (int c = 0; c < D; ++c) target.uniform[c] = set.velocity[c] ? (*set.velocity[c])(t) : 0;
    return target;
  }
  double const angle = t < 0 ? 0 : set.around->turning(t) * dt, half = std::sin(angle / 2);
  target.place = set.place.data(), target.held = set.held.data();
  for (int c = 0; c < 3; ++c) target.axis[c] = set.around->axis[c];
  target.less = -2 * half * half / dt, target.ahead = std::sin(angle) / dt, target.dt = dt;
  target.outward = t < 0 ? 0 : set.around->outward(t), target.nothing = 1e-9 * set.around->reach;
  return target;
}

template <int D, class Real>
void MotionStage<D, Real>::react(double t, double last_dt, double dt, double damping) {
  for (auto& set : model_.holds) {
    kernels::HoldReaction<D, Real> kernel;
    kernel.list = set.list.data();
    kernel.impulse = set.impulse.data();
    kernel.v = model_.vertices.v.data();
    kernel.force = model_.vertex_force();
    kernel.inverse_mass = model_.vertices.inverse_mass.data();
    kernel.last_dt = last_dt;
    kernel.dt = dt;
    kernel.damping = damping;
    for (int c = 0; c < D; ++c) kernel.gravity[c] = scene_.weight_per_mass(c);
    kernel.target = target(set, t + 0.5 * dt, dt);
    auto const sums = sum_over<D + 2>(device_, 0, static_cast<Index>(set.list.size()), kernel);
    for (int c = 0; c < D; ++c) reaction_[set.hold][c] = sums[c];
    ledger_.external += sums[D];
    torque_[set.hold] = sums[D + 1];
  }
}

template <int D, class Real>
std::vector<double> MotionStage<D, Real>::asked(std::size_t set, double t, double dt) {
  auto const n = static_cast<Index>(model_.holds[set].list.size());
  Buffer<double> out(device_, "prescribed motion", static_cast<std::size_t>(n) * D);
  for_each(device_, 0, n, kernels::HoldAsks<D, Real>{target(model_.holds[set], t + 0.5 * dt, dt), out.data()});
  return out.download();
}

template <int D, class Real>
void MotionStage<D, Real>::move(double t, double dt) {
  for (auto& set : model_.holds) {
    kernels::HoldMotion<D, Real> kernel;
    kernel.list = set.list.data();
    kernel.impulse = set.impulse.data();
    kernel.held = set.held.data();
    kernel.u = model_.vertices.u.data();
    kernel.v = model_.vertices.v.data();
    kernel.dt = dt;
    kernel.target = target(set, t + 0.5 * dt, dt);
    ledger_.external += sum_over<1>(device_, 0, static_cast<Index>(set.list.size()), kernel)[0];
  }
}

}  // namespace fissure
