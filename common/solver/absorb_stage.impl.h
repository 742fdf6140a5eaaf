// Instantiated by src2d and src3d.
#pragma once
#include <algorithm>

#include "kernels/loads.h"
#include "solver/absorb_stage.h"

namespace fissure {

template <int D, class Real>
void AbsorbStage<D, Real>::add_forces(kernels::VertexView<D, Real> const& vertices) {
  auto& set = model_.absorbing;
  if (set.list.empty()) return;
  kernels::AbsorbWaves<D, Real> kernel;
  kernel.list = set.list.data(), kernel.impulse = set.impulse.data();
  kernel.v = model_.vertices.v.data(), kernel.force = model_.vertex_force();
  kernel.inverse_mass = model_.vertices.inverse_mass.data();
  kernel.kick = vertices.kick, kernel.damping = vertices.damping;
  std::copy_n(vertices.gravity, D, kernel.gravity);
  ledger_.external += sum_over<1>(device_, 0, static_cast<Index>(set.list.size()), kernel)[0];
}

template <int D, class Real>
void AbsorbStage<D, Real>::finish_step() {
  auto& set = model_.absorbing;
  if (set.list.empty()) return;
  ledger_.external +=
      sum_over<1>(device_, 0, static_cast<Index>(set.list.size()),
                  kernels::AbsorbWork<D, Real>{set.list.data(), set.impulse.data(), model_.vertices.v.data()})[0];
}

}  // namespace fissure
