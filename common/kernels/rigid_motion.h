// Bodies that do not deform: what pushes them in all, and the motion that all their vertices share.
// A vertex stands at x = c + R r: c the centre of mass, R the rotation, r its arm at rest.
#pragma once
#include "backend/for_each.h"
#include "kernels/views.h"

namespace fissure::kernels {

/// The vertices of a rigid body, and which directions holds move for it.
template <int D>
struct RigidView {
  Index const* list = nullptr;
  double const* arm = nullptr;  // [listed][D] from the centre of mass at rest [m]
  bool held[D] = {};

  /// A vector of the body at rest, turned.
  FISSURE_HD Vec<double, D> times(double const (&turn)[D * D], Index k) const {
    Vec<double, D> x = Vec<double, D>::Zero();
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j) x[i] += turn[i * D + j] * arm[k * D + j];
    return x;
  }
};

/// Sums over the vertices: force [N], then moment about the centre of mass [N m].
template <int D, class Real_>
struct RigidPush {
  static constexpr char const* name = "rigid bodies";
  static constexpr bool packed = false;
  using Real = Real_;

  RigidView<D> body;
  double turn[D * D] = {};  // R
  Real const* force = nullptr;

  template <class S>
  FISSURE_HD void operator()(Index k, Sums<D + 3>& sums) const {
    Vec<double, 3> f = Vec<double, 3>::Zero(), r = f;
    Vec<double, D> const arm = body.times(turn, k);
    for (int c = 0; c < D; ++c) {
      f[c] = force[static_cast<std::size_t>(body.list[k]) * D + c], r[c] = arm[c];
      sums[c] += f[c];
    }
    Vec<double, 3> const moment = r.cross(f);
    for (int c = 0; c < 3; ++c) sums[D + c] += moment[c];
  }
};

/// Puts at each vertex the force that takes it along with its body: m times the acceleration of the body there, less
/// gravity. Only what works on the body from outside is in the sum of these, so they book nothing.
template <int D, class Real_>
struct RigidReaction {
  static constexpr char const* name = "rigid bodies, reaction";
  static constexpr bool packed = false;
  using Real = Real_;

  RigidView<D> body;
  double velocity[D] = {}, spin[D * D] = {};  // after the step: of the centre [m/s], and per arm at rest [1/s]
  Real const* v = nullptr;
  Real* force = nullptr;
  Real const* inverse_mass = nullptr;
  double gravity[D] = {};
  double kick = 0, damping = 0;  // from half step to half step [s]; [1/s]

  template <class S>
  FISSURE_HD void operator()(Index k) const {
    Vec<double, D> const around = body.times(spin, k);
    double const a = 0.5 * damping * kick, m = 1 / static_cast<double>(inverse_mass[body.list[k]]);
    for (int c = 0; c < D; ++c) {
      if (body.held[c]) continue;
      std::size_t const i = static_cast<std::size_t>(body.list[k]) * D + c;
      double const gain = ((1 + a) * (velocity[c] + around[c]) - (1 - a) * v[i]) / kick;
      force[i] = static_cast<Real>(m * (gain - gravity[c]));
    }
  }
};

/// Puts every vertex where its body has it, so that no rounding adds up.
template <int D, class Real_>
struct RigidMotion {
  static constexpr char const* name = "rigid bodies, motion";
  static constexpr bool packed = false;
  using Real = Real_;

  RigidView<D> body;
  double moved[D] = {}, turned[D * D] = {};   // of the centre [m], R - 1
  double velocity[D] = {}, spin[D * D] = {};  // as above
  Real* u = nullptr;
  Real* v = nullptr;

  template <class S>
  FISSURE_HD void operator()(Index k) const {
    Vec<double, D> const around = body.times(spin, k), by_turn = body.times(turned, k);
    for (int c = 0; c < D; ++c) {
      if (body.held[c]) continue;
      std::size_t const i = static_cast<std::size_t>(body.list[k]) * D + c;
      u[i] = static_cast<Real>(moved[c] + by_turn[c]);
      v[i] = static_cast<Real>(velocity[c] + around[c]);
    }
  }
};

}  // namespace fissure::kernels
