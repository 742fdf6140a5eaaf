// What the contact tests share: a few elements to push about, and the overlap energy computed by cutting simplices.
#pragma once
#include <numeric>
#include <random>

#include "../../src2d/clip.h"
#include "../../src2d/dim.h"
#include "../../src3d/clip.h"
#include "../../src3d/dim.h"
#include "kernels/rigid_contact.h"

namespace fissure::contact_test {

using kernels::layout_width;

template <int D>
using Corners = std::array<Vec<double, D>, D + 1>;

/// A few elements with corners of their own, one law, and the outputs of the contact kernels.
template <int D, class Real = double>
struct Rig {
  std::vector<Real> X, u, v, spring, force, stiffness, weight, work, penetration, reaction;
  Real held = 0;
  std::uint8_t axis = kernels::no_axis;
  std::vector<kernels::ContactTable::Number> law;
  laws::ContactLaw contact;
  std::vector<Index> pair{0, 1};
  Index n = 0;

  explicit Rig(std::vector<Corners<D>> const& elements, laws::ContactLaw contact = {1.0, 0.0})
      : contact(contact), n(static_cast<Index>(elements.size())) {
    std::size_t const padded = (elements.size() + layout_width - 1) / layout_width * layout_width,
                      corners = padded * (D + 1);
    X.resize(corners * D);
    u.resize(corners * D);
    v.resize(corners * D);
    law.resize(padded);
    for (Index e = 0; e < n; ++e)
      for (int a = 0; a <= D; ++a)
        for (int c = 0; c < D; ++c) X[kernels::blocked(e, a * D + c, (D + 1) * D)] = Real(elements[e][a][c]);
    spring.resize(kernels::spring_size<D>);
    force.resize(2 * (D + 1) * D);
    stiffness.resize(2 * (D + 1));
    weight.resize(2 * (D + 1));
    work.resize(1);
    penetration.resize(1);
    reaction.resize(D);
  }
  kernels::MeshView<D, Real> mesh() { return {n, n * (D + 1), X.data(), nullptr, nullptr, u.data(), v.data()}; }
  void move(Index e, Vec<double, D> const& by) {
    for (int a = 0; a <= D; ++a)
      for (int c = 0; c < D; ++c) u[(e * (D + 1) + a) * D + c] += Real(by[c]);
  }
  void speed(Index e, Vec<double, D> const& to) {
    for (int a = 0; a <= D; ++a)
      for (int c = 0; c < D; ++c) v[(e * (D + 1) + a) * D + c] = Real(to[c]);
  }
  /// Runs the kernels of pairs; force(e, a) then holds the slots.
  void touch(double dt = 0) {
    double wake = 0;
    kernels::ContactTable const table{law.data(), &contact, 1};
    kernels::PairForces<D, Real>{mesh(),
                                 table,
                                 1,
                                 pair.data(),
                                 spring.data(),
                                 force.data(),
                                 stiffness.data(),
                                 weight.data(),
                                 work.data(),
                                 penetration.data(),
                                 0,
                                 &wake,
                                 &axis,
                                 &held}(0);
    std::vector<Index> group(2 * (D + 1));
    std::iota(group.begin(), group.end(), 0);
    auto const pressure = force;
    kernels::PairFriction<D, Real>{
        mesh(),        table,       Real(dt),           pair.data(), spring.data(), force.data(),   stiffness.data(),
        weight.data(), work.data(), penetration.data(), nullptr,     group.data(),  pressure.data()}(0);
  }
  template <class Body>
  void press(Body const& body, double dt = 0) {
    pair = {0, 0};
    kernels::RigidForces<D, Real, Body>{mesh(),
                                        {law.data(), &contact, 1},
                                        &body,
                                        Real(dt),
                                        pair.data(),
                                        spring.data(),
                                        force.data(),
                                        reaction.data(),
                                        stiffness.data(),
                                        work.data(),
                                        penetration.data(),
                                        &held}(0);
  }
  Vec<double, D> at(Index slot) const {
    Vec<double, D> f;
    for (int c = 0; c < D; ++c) f[c] = double(force[slot * D + c]);
    return f;
  }
  Vec<double, D> total(Index side) const {
    Vec<double, D> sum = Vec<double, D>::Zero();
    for (int a = 0; a <= D; ++a) sum += at(side * (D + 1) + a);
    return sum;
  }
};

// ------------------------------------------------------------------------- an independent energy: simplices cut into
// simplices
template <int D>
double volume(Corners<D> const& s) {
  Mat<double, D> edges;
  for (int a = 1; a <= D; ++a) edges.col(a - 1) = s[a] - s[0];
  return std::abs(edges.determinant()) / (D == 2 ? 2 : 6);
}

template <int D>
double barycentric(Corners<D> const& s, int i, Vec<double, D> const& x) {
  Eigen::Matrix<double, D + 1, D + 1> m;
  Eigen::Matrix<double, D + 1, 1> rhs;
  for (int a = 0; a <= D; ++a) m.col(a) << s[a], 1.0;
  rhs << x, 1.0;
  return m.fullPivLu().solve(rhs)[i];
}

/// Keeps the part where f >= 0 by putting a corner wherever an edge changes sign.
template <int D, class F>
void keep_positive(Corners<D> const& s, F const& f, std::vector<Corners<D>>& kept) {
  double value[D + 1], largest = 0;
  for (int a = 0; a <= D; ++a) value[a] = f(s[a]), largest = std::max(largest, value[a]);
  for (int a = 0; a <= D; ++a)
    for (int b = 0; b <= D; ++b)
      if (value[a] > 1e-13 && value[b] < -1e-13) {
        Vec<double, D> const middle = s[a] + (s[b] - s[a]) * (value[a] / (value[a] - value[b]));
        Corners<D> one = s, two = s;
        one[a] = middle;
        two[b] = middle;
        keep_positive<D>(one, f, kept);
        keep_positive<D>(two, f, kept);
        return;
      }
  if (largest > 1e-13) kept.push_back(s);
}

/// Integral over the overlap of of_a phi_A + of_b phi_B, fan by fan.
template <int D>
double overlap_energy(Corners<D> const& A, Corners<D> const& B, double of_a = 1, double of_b = 1) {
  auto fan = [](Corners<D> s, int i) {
    Vec<double, D> center = Vec<double, D>::Zero();
    for (auto const& x : s) center += x / (D + 1);
    s[i] = center;
    return s;
  };
  double energy = 0;
  for (int i = 0; i <= D; ++i)
    for (int j = 0; j <= D; ++j) {
      Corners<D> const a = fan(A, i), b = fan(B, j);
      if (volume<D>(a) < 1e-14 || volume<D>(b) < 1e-14) continue;
      std::vector<Corners<D>> parts{a};
      for (int k = 0; k <= D; ++k) {
        std::vector<Corners<D>> next;
        Eigen::Matrix<double, D + 1, D + 1> m;
        for (int c = 0; c <= D; ++c) m.col(c) << b[c], 1.0;
        Eigen::Matrix<double, 1, D + 1> const row = m.inverse().row(k);
        for (auto const& part : parts)
          keep_positive<D>(
              part, [&](Vec<double, D> const& x) { return row.template head<D>().dot(x) + row[D]; }, next);
        parts = next;
      }
      for (auto const& part : parts) {
        double sum = 0;
        for (auto const& x : part) sum += (of_a * barycentric<D>(a, i, x) + of_b * barycentric<D>(b, j, x)) / (D + 1);
        energy += sum * volume<D>(part);
      }
    }
  return energy;
}

template <int D>
Corners<D> moved(Corners<D> s, Vec<double, D> const& by) {
  for (auto& x : s) x += by;
  return s;
}

/// Generators of rotation: one in the plane, three in space.
template <int D>
std::vector<Mat<double, D>> spins() {
  std::vector<Mat<double, D>> all;
  for (int i = 0; i < D; ++i)
    for (int j = i + 1; j < D; ++j) {
      Mat<double, D> W = Mat<double, D>::Zero();
      W(i, j) = -1;
      W(j, i) = 1;
      all.push_back(W);
    }
  return all;
}

template <int D>
Mat<double, D> rotation(Mat<double, D> const& W, double angle) {  // W generates a turn in one plane
  return Mat<double, D>::Identity() + std::sin(angle) * W + (1 - std::cos(angle)) * W * W;
}

template <int D>
Corners<D> random_simplex(std::mt19937& rng, double spread, bool on_grid = false) {
  std::uniform_real_distribution<double> real(0, 1);
  std::uniform_int_distribution<int> whole(0, 3);
  while (true) {
    Corners<D> s;
    for (auto& x : s)
      for (int c = 0; c < D; ++c) x[c] = (on_grid ? whole(rng) / 3.0 : real(rng)) * spread;
    if (volume<D>(s) > 0.01) return s;
  }
}

}  // namespace fissure::contact_test
