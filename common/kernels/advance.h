// The explicit step of vertices: central differences (leapfrog), paper eq. 1, with mass-proportional damping:
//   v+ = ((1 - a) v- + kick (f/m + g)) / (1 + a),  a = alpha kick / 2,   u += dt v+,
// kick = (dt- + dt+)/2 the time between the two half steps at which velocities live; dt- = 0 in the first step.
#pragma once
#include "backend/for_each.h"
#include "base/rows.h"
#include "kernels/views.h"

namespace fissure::kernels {

/// What every pass over vertices sees.
template <int D, class Real>
struct VertexView {
  Real* u = nullptr;                   // [m], [vertex][D]
  Real* v = nullptr;                   // [m/s]
  Real const* force = nullptr;         // [N]
  Real const* inverse_mass = nullptr;  // [1/kg] per vertex; 0 for padding
  double gravity[D] = {};              // [m/s^2]
  double dt = 0;                       // of the step to come [s]
  double kick = 0;                     // from half step to half step [s]
  double damping = 0;                  // alpha [1/s]

  /// Velocity after this step of component i = vertex * D + c.
  FISSURE_HD Real next_velocity(Index i) const {
    Real const a = static_cast<Real>(0.5 * damping * kick), m = inverse_mass[i / D];
    Real const keep = (1 - a) / (1 + a), gain = static_cast<Real>(kick) / (1 + a);
    Real const push = m > 0 ? force[i] * m + static_cast<Real>(gravity[i % D]) : Real(0);
    return keep * v[i] + gain * push;
  }
};

/// One step of every vertex.
template <int D, class Real_>
struct Advance {
  static constexpr char const* name = "advance";
  static constexpr bool packed = true;
  using Real = Real_;

  VertexView<D, Real> vertices;
  bool heavy = false;  // gravity acts

  template <class S>
  FISSURE_HOT void operator()(Index vertex) const {
    step<S>(vertex, [](S const&, S const&, S const&) {});
  }

 protected:
  /// see(1/m, v before, v after) for each pack of components.
  template <class S, class See>
  FISSURE_HD void step(Index vertex, See const& see) const {
    S const a = as<S>(0.5 * vertices.damping * vertices.kick), dt = as<S>(vertices.dt), kick = as<S>(vertices.kick);
    S const keep = (S(1) - a) / (S(1) + a), gain = kick / (S(1) + a);
    S const inverse_mass = load<S>(vertices.inverse_mass + vertex);
    for (int k = 0; k < D; ++k) {  // D packs of components, vertex by vertex
      std::size_t const i = static_cast<std::size_t>(vertex) * D + k * lane_width<S>;
      S const m = repeat_lanes<D>(inverse_mass, k);
      S push = load<S>(vertices.force + i) * m;
      if (heavy) {
        auto const g = [&](int l) { return static_cast<Real>(vertices.gravity[(k * lane_width<S> + l) % D]); };
        push += select(m > S(0), generate<S>(g), S(0));
      }
      S const before = load<S>(vertices.v + i), v = keep * before + gain * push;
      see(m, before, v);
      store(v, vertices.v + i);
      store(load<S>(vertices.u + i) + dt * v, vertices.u + i);
    }
  }
};

/// The same, and what mass damping takes in it [J]: alpha kick m ((v- + v+)/2)^2.
template <int D, class Real_>
struct DampedAdvance : Advance<D, Real_> {
  static constexpr char const* name = "advance, damped";

  template <class S>
  FISSURE_HOT void operator()(Index vertex, Sums<1>& taken) const {
    S sum = S(0);
    this->template step<S>(vertex, [&](S const& inverse_mass, S const& before, S const& after) {
      S const mean = as<S>(0.5) * (before + after);
      sum += select(inverse_mass > S(0), mean * mean / inverse_mass, S(0));
    });
    double const alpha = this->vertices.damping * this->vertices.kick;
    for (int l = 0; l < lane_width<S>; ++l) taken[0] += alpha * static_cast<double>(lane(sum, l));
  }
};

/// Force of each vertex: the sum of its corners' in fixed order (shared vertices only).
template <int D, class Real_>
struct SumCorners {
  static constexpr char const* name = "sum corners";
  static constexpr bool packed = false;
  using Real = Real_;

  Real const* corner_force = nullptr;  // [corner][D]
  Index const* first = nullptr;        // per vertex: its range in `corner`
  Index const* corner = nullptr;
  Real* force = nullptr;  // [vertex][D]

  template <class S>
  FISSURE_HD void operator()(Index vertex) const {
    S sum[D] = {};
    for (Index k = first[vertex]; k < first[vertex + 1]; ++k)
      for (int c = 0; c < D; ++c) sum[c] += corner_force[static_cast<std::size_t>(corner[k]) * D + c];
    for (int c = 0; c < D; ++c) force[static_cast<std::size_t>(vertex) * D + c] = sum[c];
  }
};

/// Energies of vertices before their step: 0 kinetic, m v-.v+ / 2 (the form that leapfrog conserves with the energies
/// of positions), 1 potential in gravity, then momentum by component.
template <int D, class Real_>
struct VertexEnergy {
  static constexpr char const* name = "vertex energy";
  static constexpr bool packed = false;
  using Real = Real_;

  VertexView<D, Real> vertices;

  template <class S>
  FISSURE_HD void operator()(Index vertex, Sums<2 + D>& sums) const {
    if (!(vertices.inverse_mass[vertex] > 0)) return;
    double const m = 1 / static_cast<double>(vertices.inverse_mass[vertex]);
    for (int c = 0; c < D; ++c) {
      Index const i = vertex * D + c;
      double const before = vertices.v[i], after = vertices.next_velocity(i);
      sums[0] += 0.5 * m * before * after;
      sums[1] -= m * vertices.gravity[c] * vertices.u[i];
      sums[2 + c] += m * before;
    }
  }
};

}  // namespace fissure::kernels
