// Instantiated by src2d and src3d.
#pragma once
#include <fmt/format.h>

#include "kernels/rigid_motion.h"
#include "solver/rigid_rotation.h"
#include "solver/rigid_stage.h"

namespace fissure {

template <int D>
void put(double (&to)[D * D], Mat<double, 3> const& from) {
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) to[i * D + j] = from(i, j);
}

template <int D, class Real>
RigidStage<D, Real>::RigidStage(Device& device, scene::Scene const& scene, model::Model<D, Real>& model)
    : device_(device), scene_(scene), model_(model) {
  now_.resize(model_.rigid.size());
  take_velocities();
}

template <int D, class Real>
void RigidStage<D, Real>::take_velocities() {
  for (std::size_t b = 0; b < now_.size(); ++b) now_[b] = with_velocities(model_.rigid[b], now_[b]);
  next_ = now_;
  move();
}

/// The same place, and the motion that has the momentum of its vertices' velocities.
template <int D, class Real>
typename RigidStage<D, Real>::Motion RigidStage<D, Real>::with_velocities(Body const& body, Motion motion) const {
  auto const v = model_.vertices.v.download();
  auto const list = body.list.download();
  auto const arms = body.arm.download();
  Mat<double, 3> const turn = motion.turn.toRotationMatrix();
  motion.velocity = motion.momentum = Vec3::Zero();
  for (std::size_t k = 0; k < list.size(); ++k) {
    double const m = model_.vertices.mass[list[k]];
    Vec3 arm = Vec3::Zero(), velocity = Vec3::Zero();
    for (int c = 0; c < D; ++c) {
      arm[c] = arms[k * D + c];
      velocity[c] = body.moves[c] ? v[static_cast<std::size_t>(list[k]) * D + c] : 0;
    }
    motion.velocity += m / body.mass * velocity;
    if (body.turns) motion.momentum += m * (turn * arm).cross(velocity);
  }
  Vec3 const omega = (turn * body.inertia * turn.transpose()).ldlt().solve(motion.momentum);
  for (int c = 0; c < 3; ++c) motion.spin.col(c) = omega.cross(Vec3::Unit(c));
  motion.spin = motion.spin * turn;
  return motion;
}

template <int D, class Real>
typename RigidStage<D, Real>::Motion RigidStage<D, Real>::stepped(Body& body, Motion const& from,
                                                                  kernels::VertexView<D, Real> const& vertices,
                                                                  long step) {
  Mat<double, 3> const turn = from.turn.toRotationMatrix();
  kernels::RigidPush<D, Real> push{body.view(), {}, model_.vertex_force()};
  put<D>(push.turn, turn);
  auto const sums = sum_over<D + 3>(device_, 0, static_cast<Index>(body.list.size()), push);

  double const a = 0.5 * vertices.damping * vertices.kick, keep = (1 - a) / (1 + a), gain = vertices.kick / (1 + a);
  Motion next = from;
  for (int c = 0; c < D; ++c)
    next.velocity[c] = body.moves[c] ? keep * from.velocity[c] + gain * (sums[c] / body.mass + vertices.gravity[c]) : 0;
  next.moved = from.moved + vertices.dt * next.velocity;
  if (!body.turns) return next;
  next.momentum = keep * from.momentum + gain * Vec3(sums[D], sums[D + 1], sums[D + 2]);
  auto const by = step_rotation(turn * body.inertia * turn.transpose(), vertices.dt * next.momentum);
  if (!by)
    throw Error(
        fmt::format("step {}: body \"{}\" is rigid and would turn by more than 60 degrees in a step of {:.3g} "
                    "s; a smaller dt is needed",
                    step, scene_.bodies[body.body].name, vertices.dt));
  Mat<double, 3> half = Mat<double, 3>::Zero();
  for (int c = 0; c < 3; ++c) half.col(c) = by->vec().cross(Vec3::Unit(c));
  next.spin = (2 / vertices.dt) * (by->w() * half + half * half) * turn;
  next.turn = (*by * from.turn).normalized();
  return next;
}

template <int D, class Real>
void RigidStage<D, Real>::react(kernels::VertexView<D, Real> const& vertices, long step) {
  for (std::size_t b = 0; b < now_.size(); ++b) {
    auto& body = model_.rigid[b];
    if (!here(body)) continue;
    next_[b] = stepped(body, now_[b], vertices, step);
    kernels::RigidReaction<D, Real> kernel;
    kernel.body = body.view();
    put<D>(kernel.spin, next_[b].spin);
    for (int c = 0; c < D; ++c) kernel.velocity[c] = next_[b].velocity[c], kernel.gravity[c] = vertices.gravity[c];
    kernel.v = vertices.v, kernel.force = model_.vertex_force(), kernel.inverse_mass = vertices.inverse_mass;
    kernel.kick = vertices.kick, kernel.damping = vertices.damping;
    for_each(device_, 0, static_cast<Index>(body.list.size()), kernel);
  }
}

template <int D, class Real>
void RigidStage<D, Real>::move() {
  for (std::size_t b = 0; b < now_.size(); ++b) {
    auto& body = model_.rigid[b];
    if (!here(body)) continue;
    auto const& to = now_[b] = next_[b];
    kernels::RigidMotion<D, Real> kernel;
    kernel.body = body.view();
    put<D>(kernel.turned, to.turn.toRotationMatrix() - Mat<double, 3>::Identity());
    put<D>(kernel.spin, to.spin);
    for (int c = 0; c < D; ++c) kernel.moved[c] = to.moved[c], kernel.velocity[c] = to.velocity[c];
    kernel.u = model_.vertices.u.data(), kernel.v = model_.vertices.v.data();
    for_each(device_, 0, static_cast<Index>(body.list.size()), kernel);
  }
}

template <int D, class Real>
void RigidStage<D, Real>::save(State& state) const {
  std::vector<double> numbers;
  for (auto const& motion : now_) {
    for (auto const* part : {&motion.moved, &motion.velocity, &motion.momentum})
      numbers.insert(numbers.end(), part->data(), part->data() + 3);
    numbers.insert(numbers.end(), motion.turn.coeffs().data(), motion.turn.coeffs().data() + 4);
    numbers.insert(numbers.end(), motion.spin.data(), motion.spin.data() + 9);
  }
  state["rigid bodies"] = state_bytes(numbers);
}

template <int D, class Real>
void RigidStage<D, Real>::restore(State const& state) {
  auto const numbers = state_values<double>(state, "rigid bodies", 22 * now_.size());
  double const* n = numbers.data();
  for (auto& motion : now_) {
    for (auto* part : {&motion.moved, &motion.velocity, &motion.momentum}) std::copy_n(n, 3, part->data()), n += 3;
    std::copy_n(n, 4, motion.turn.coeffs().data()), n += 4;
    std::copy_n(n, 9, motion.spin.data()), n += 9;
  }
  next_ = now_;
}

}  // namespace fissure
