// Instantiated by src2d and src3d.
#pragma once
#include "kernels/advance.h"
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
double MotionStage<D, Real>::target(model::HoldSet<D, Real> const& set, int c, double t) {
  auto const& component = set.velocity[c];
  return component ? (*component)(t) : 0;
}

template <int D, class Real>
void MotionStage<D, Real>::react(double t, double last_dt, double dt) {
  for (auto& set : model_.holds) {
    kernels::HoldReaction<D, Real> kernel;
    kernel.list = set.list.data();
    kernel.impulse = set.impulse.data();
    kernel.v = model_.vertices.v.data();
    kernel.force = model_.vertex_force();
    kernel.inverse_mass = model_.vertices.inverse_mass.data();
    kernel.last_dt = last_dt;
    kernel.dt = dt;
    kernel.damping = scene_.run.mass_damping;
    for (int c = 0; c < D; ++c) {
      kernel.gravity[c] = scene_.weight_per_mass(c);
      kernel.target[c] = target(set, c, t + 0.5 * dt);
    }
    auto const sums = sum_over<D + 1>(device_, 0, static_cast<Index>(set.list.size()), kernel);
    for (int c = 0; c < D; ++c) reaction_[set.hold][c] = sums[c];
    ledger_.external += sums[D];
  }
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
    for (int c = 0; c < D; ++c) kernel.target[c] = target(set, c, t + 0.5 * dt);
    ledger_.external += sum_over<1>(device_, 0, static_cast<Index>(set.list.size()), kernel)[0];
  }
}

}  // namespace fissure
