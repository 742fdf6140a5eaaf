// Tied bodies: vertices of one that hang on the corners of cells of another (docs/theory/loads.md, Ties).
#pragma once
#include "backend/for_each.h"
#include "kernels/loads.h"

namespace fissure::kernels {

/// What the host needs of some vertices: force [D] and velocity [D] of each.
template <int D, class Real_>
struct GatherMotion {
  static constexpr char const* name = "ties, gathered";
  static constexpr bool packed = false;
  using Real = Real_;
  static constexpr int size = 2 * D;

  Index const* list = nullptr;
  Real const *force = nullptr, *v = nullptr;  // [vertex][D] [N], [m/s]
  double* out = nullptr;                      // [listed][size]

  template <class S>
  FISSURE_HD void operator()(Index k) const {
    double* const to = out + static_cast<std::size_t>(k) * size;
    for (int c = 0; c < D; ++c) {
      std::size_t const i = static_cast<std::size_t>(list[k]) * D + c;
      to[c] = force[i], to[D + c] = v[i];
    }
  }
};

/// The forces that the host has found for them.
template <int D, class Real_>
struct PutForces {
  static constexpr char const* name = "ties, forces";
  static constexpr bool packed = false;
  using Real = Real_;

  Index const* list = nullptr;
  double const* from = nullptr;  // [listed][D] [N]
  Real* force = nullptr;

  template <class S>
  FISSURE_HD void operator()(Index k) const {
    for (int c = 0; c < D; ++c)
      force[static_cast<std::size_t>(list[k]) * D + c] = static_cast<Real>(from[static_cast<std::size_t>(k) * D + c]);
  }
};

/// Along direction c what hangs is where it hangs: no gap grows by rounding.
template <int D, class Real_>
struct HangMotion {
  static constexpr char const* name = "ties, motion";
  static constexpr bool packed = false;
  using Real = Real_;

  Index const* hung = nullptr;     // vertices
  Index const* first = nullptr;    // of each: its range in
  Index const* carrier = nullptr;  // vertices, and
  double const* share = nullptr;   // their shares
  Real *u = nullptr, *v = nullptr;
  int c = 0;

  template <class S>
  FISSURE_HD void operator()(Index k) const {
    double moved = 0, velocity = 0;
    for (Index j = first[k]; j < first[k + 1]; ++j) {
      std::size_t const from = static_cast<std::size_t>(carrier[j]) * D + c;
      moved += share[j] * static_cast<double>(u[from]), velocity += share[j] * static_cast<double>(v[from]);
    }
    std::size_t const to = static_cast<std::size_t>(hung[k]) * D + c;
    u[to] = static_cast<Real>(moved), v[to] = static_cast<Real>(velocity);
  }
};

/// Velocities that a hold asks its vertices for [listed][D].
template <int D, class Real_>
struct HoldAsks {
  static constexpr char const* name = "holds, asked";
  static constexpr bool packed = false;
  using Real = Real_;

  HoldTarget<D, Real> target;
  double* out = nullptr;

  template <class S>
  FISSURE_HD void operator()(Index k) const {
    Vec<double, D> const asked = target(k);
    for (int c = 0; c < D; ++c) out[static_cast<std::size_t>(k) * D + c] = asked[c];
  }
};

}  // namespace fissure::kernels
