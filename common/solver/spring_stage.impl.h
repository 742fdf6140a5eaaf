// Instantiated by src2d and src3d.
#pragma once
#include <fmt/format.h>

#include <algorithm>

#include "solver/spring_stage.h"

namespace fissure {

template <int D, class Real>
SpringStage<D, Real>::SpringStage(Device&, scene::Scene const& scene, model::Model<D, Real>& model, Ledger& ledger)
    : scene_(scene), model_(model), ledger_(ledger), broken_(model.springs.size(), 0), now_(model.springs.size()) {
  for (auto const& set : model_.springs) {
    double const drawn = between(set).norm();
    length_.push_back(scene_.springs[length_.size()].length.value_or(drawn));
  }
}

/// Of its end, by the shares of its vertices; 0 where it is a fixed place.
template <int D, class Real>
Vec<double, D> SpringStage<D, Real>::mean(Set const& set, int which, Buffer<Real> const& of) const {
  Vec<double, D> sum = Vec<double, D>::Zero();
  for (auto const& at : set.ends[which])
    for (int c = 0; c < D; ++c)
      sum[c] += static_cast<double>(at.share[c]) *
                static_cast<double>(of.download_one(static_cast<std::size_t>(at.vertex) * D + c));
  return sum;
}

/// From its first end to its second [m].
template <int D, class Real>
Vec<double, D> SpringStage<D, Real>::between(Set const& set) const {
  return set.place[1] + mean(set, 1, model_.vertices.u) - set.place[0] - mean(set, 0, model_.vertices.u);
}

template <int D, class Real>
double SpringStage<D, Real>::rate(Set const& set, Vec<double, D> const& along) const {
  return along.dot(mean(set, 1, model_.vertices.v) - mean(set, 0, model_.vertices.v));
}

template <int D, class Real>
Vec3 SpringStage<D, Real>::end(int spring, int which) const {
  auto const& set = model_.springs.at(spring);
  Vec3 x = model_.origin;
  x.template head<D>() += set.place[which] + mean(set, which, model_.vertices.u);
  return x;
}

/// What it hangs on has left the run.
template <int D, class Real>
bool SpringStage<D, Real>::adrift(Set const& set) const {
  return std::any_of(set.ends.begin(), set.ends.end(), [this](auto const& end) {
    return !end.empty() && !(model_.vertices.inverse_mass.download_one(end.front().vertex) > 0);
  });
}

template <int D, class Real>
void SpringStage<D, Real>::add_forces(double t, double last_dt) {
  for (std::size_t s = 0; s < now_.size(); ++s) {
    auto const& set = model_.springs[s];
    auto const& spring = scene_.springs[s];
    now_[s] = {};
    if (broken_[s]) continue;
    Vec<double, D> const apart = between(set);
    double const size = apart.norm();
    Now now;
    if (size > 0) now.along = apart / size;
    double const stretch = spring.slack ? std::max(size - length_[s], 0.0) : size - length_[s];
    double const speed = rate(set, now.along);
    now.pull = spring.stiffness * stretch, now.held = 0.5 * now.pull * stretch;
    if (last_dt > 0 && (!spring.slack || stretch > 0)) now.drag = spring.damping * speed;
    if (now.pull > spring.strength || adrift(set)) {
      broken_[s] = 1;
      model_.warnings.push_back(
          now.pull > spring.strength
              ? fmt::format("spring \"{}\" broke at t = {:.4g} s, at {:.4g} N", spring.name, t, now.pull)
              : fmt::format("spring \"{}\" hangs on nothing from t = {:.4g} s on: its end has left", spring.name, t));
      ledger_.spring_lost += now.held - 0.5 * last_dt * now.pull * speed;  // it has pulled until now
      continue;
    }
    if (spring.slack) now.drag = std::max(now.drag, -now.pull);  // however fast it shortens, it does not push
    ledger_.spring_lost += 0.5 * last_dt * now.drag * speed;
    now.pull += now.drag;
    now_[s] = now;
    for (int which : {0, 1})
      for (auto const& at : set.ends[which])
        for (int c = 0; c < D; ++c) {
          std::size_t const i = static_cast<std::size_t>(at.vertex) * D + c;
          double const more = (which == 0 ? 1 : -1) * now.pull * now.along[c] * static_cast<double>(at.share[c]);
          model_.vertices.force.upload_one(
              i, static_cast<Real>(static_cast<double>(model_.vertices.force.download_one(i)) + more));
        }
  }
}

template <int D, class Real>
void SpringStage<D, Real>::finish_step(double dt, double share) {
  for (std::size_t s = 0; s < now_.size(); ++s)
    if (now_[s].drag != 0) ledger_.spring_lost += share * dt * now_[s].drag * rate(model_.springs[s], now_[s].along);
}

template <int D, class Real>
double SpringStage<D, Real>::stored() const {
  double sum = 0;
  for (auto const& now : now_) sum += now.held;
  return sum;
}

}  // namespace fissure
