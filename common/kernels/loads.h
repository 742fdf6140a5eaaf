// Forces and prescribed motions on few vertices, each with the work it does.
// Work over a step is the trapezoid of the forces at its ends times the displacement between: half is booked with the
// velocity before the step, half with the one after it, which balances the leapfrog's kinetic energy exactly.
#pragma once
#include "backend/for_each.h"
#include "kernels/views.h"

namespace fissure::kernels {

/// A vertex that a load or a prescribed motion acts on.
template <int D, class Real>
struct LoadedVertex {
  Index vertex = 0;
  Real share[D] = {};  // traction: reference area per direction [m^2]; hold: 1 where prescribed, 0 where free
};

/// Adds value(t) * share to the force of each listed vertex.
template <int D, class Real_>
struct AddLoad {
  static constexpr char const* name = "loads";
  static constexpr bool packed = false;
  using Real = Real_;

  LoadedVertex<D, Real> const* list = nullptr;
  double value[D] = {};  // [Pa]
  Real* force = nullptr;

  template <class S>
  FISSURE_HD void operator()(Index k) const {
    for (int c = 0; c < D; ++c) force[static_cast<std::size_t>(list[k].vertex) * D + c] += static_cast<Real>(value[c]) * list[k].share[c];
  }
};

/// Work of a load over half a step: dt/2 f.v [J].
template <int D, class Real_>
struct LoadWork {
  static constexpr char const* name = "load work";
  static constexpr bool packed = false;
  using Real = Real_;

  LoadedVertex<D, Real> const* list = nullptr;
  double value[D] = {};
  Real const* v = nullptr;
  double half_dt = 0;

  template <class S>
  FISSURE_HD void operator()(Index k, Sums<1>& work) const {
    for (int c = 0; c < D; ++c)
      work[0] += half_dt * value[c] * static_cast<double>(list[k].share[c]) * v[static_cast<std::size_t>(list[k].vertex) * D + c];
  }
};

/// The force that keeps a vertex on its prescribed motion: r = m (a_target - a_free); added to the force. Sums: its total by
/// direction [N], then the half-step work with the velocity before [J].
template <int D, class Real_>
struct HoldReaction {
  static constexpr char const* name = "hold reaction";
  static constexpr bool packed = false;
  using Real = Real_;

  LoadedVertex<D, Real> const* list = nullptr;
  Real* reaction = nullptr;     // [listed][D] [N]
  double target[D] = {};        // velocity after this step [m/s]
  Real const* v = nullptr;
  Real* force = nullptr;
  Real const* inverse_mass = nullptr;
  double gravity[D] = {};
  double last_dt = 0, kick = 0;  // of the step that led here; from half step to half step [s]
  double damping = 0;            // [1/s]

  template <class S>
  FISSURE_HD void operator()(Index k, Sums<D + 1>& sums) const {
    double const a = 0.5 * damping * kick;
    for (int c = 0; c < D; ++c) {
      reaction[k * D + c] = 0;
      if (!(list[k].share[c] > 0)) continue;
      std::size_t const i = static_cast<std::size_t>(list[k].vertex) * D + c;
      double const m = 1 / static_cast<double>(inverse_mass[list[k].vertex]);
      double const r = m * (((1 + a) * target[c] - (1 - a) * v[i]) / kick - gravity[c]) - force[i];
      force[i] += static_cast<Real>(r);
      reaction[k * D + c] = static_cast<Real>(r);
      sums[c] += r;
      sums[D] += 0.5 * last_dt * r * v[i];
    }
  }
};

/// After the step: puts held vertices exactly where they must be; sums the half-step work with the velocity after [J].
template <int D, class Real_>
struct HoldMotion {
  static constexpr char const* name = "hold motion";
  static constexpr bool packed = false;
  using Real = Real_;

  LoadedVertex<D, Real> const* list = nullptr;
  Real const* reaction = nullptr;
  double target[D] = {};
  Real* held = nullptr;  // [listed][D] displacement that prescribed directions have reached [m]
  Real* u = nullptr;
  Real* v = nullptr;
  double dt = 0;

  template <class S>
  FISSURE_HD void operator()(Index k, Sums<1>& work) const {
    for (int c = 0; c < D; ++c) {
      if (!(list[k].share[c] > 0)) continue;
      std::size_t const i = static_cast<std::size_t>(list[k].vertex) * D + c;
      held[k * D + c] += static_cast<Real>(dt * target[c]);
      u[i] = held[k * D + c];
      v[i] = static_cast<Real>(target[c]);
      work[0] += 0.5 * dt * reaction[k * D + c] * target[c];
    }
  }
};

}  // namespace fissure::kernels
