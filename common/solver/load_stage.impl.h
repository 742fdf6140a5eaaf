// Instantiated by src2d and src3d.
#pragma once
#include <algorithm>

#include "kernels/loads.h"
#include "solver/load_stage.h"

namespace fissure {

template <int D, class Real>
std::array<double, D> LoadStage<D, Real>::value(model::LoadSet<D, Real> const& set, double t) {
  std::array<double, D> value{};
  for (int c = 0; c < D; ++c)
    if (set.value[c]) value[c] = (*set.value[c])(t);
  return value;
}

template <int D, class Real>
double LoadStage<D, Real>::work(model::LoadSet<D, Real> const& set, std::array<double, D> const& value,
                                double share_of_dt) {
  kernels::LoadWork<D, Real> work{set.list.data(), {}, model_.vertices.v.data(), share_of_dt};
  std::copy(value.begin(), value.end(), work.value);
  return sum_over<1>(device_, 0, static_cast<Index>(set.list.size()), work)[0];
}

template <int D, class Real>
void LoadStage<D, Real>::add_forces(double t, double last_dt) {
  for (auto& set : model_.loads) {
    auto const now = value(set, t);
    if (!set.corner.empty())
      for_each(device_, 0, static_cast<Index>(set.list.size()),
               kernels::FollowFaces<D, Real>{model_.view(), set.list.data(), set.first.data(), set.corner.data()});
    kernels::AddLoad<D, Real> load{set.list.data(), {}, model_.vertex_force()};
    std::copy(now.begin(), now.end(), load.value);
    for_each(device_, 0, static_cast<Index>(set.list.size()), load);
    ledger_.external += work(set, now, 0.5 * last_dt);
  }
}

template <int D, class Real>
void LoadStage<D, Real>::finish_step(double t, double dt, double share) {
  for (auto const& set : model_.loads) ledger_.external += work(set, value(set, t), share * dt);
}

}  // namespace fissure
