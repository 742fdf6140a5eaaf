// One kernel source: a lane is a plain scalar (a GPU thread) or a pack of scalars (a CPU's SIMD register).
// Kernels and laws are written over the lane type S with the functions below; branches become select(mask, a, b).
#pragma once
#include <cmath>
#include <type_traits>

#include "base/algebra.h"

#if !defined(__CUDACC__)
#include <experimental/simd>
#endif

namespace fissure {

using Index = int;  // vertices, elements, faces: 2^31 are enough for any one machine

/// What S is made of: its scalar, its width, its mask.
template <class S>
struct LaneTraits {
  using Scalar = S;
  using Mask = bool;
  static constexpr int width = 1;
};

template <class S>
using ScalarOf = typename LaneTraits<S>::Scalar;
template <class S>
using MaskOf = typename LaneTraits<S>::Mask;
template <class S>
inline constexpr int lane_width = LaneTraits<S>::width;

/// A constant of the host (always double) as a lane.
template <class S>
FISSURE_HD S as(double value) {
  return S(static_cast<ScalarOf<S>>(value));
}

template <class S, std::enable_if_t<std::is_floating_point_v<S>, int> = 0>
FISSURE_HD S select(bool mask, S a, S b) {
  return mask ? a : b;
}
FISSURE_HD bool any_lane(bool mask) { return mask; }
FISSURE_HD bool all_lanes(bool mask) { return mask; }
template <class S, std::enable_if_t<std::is_floating_point_v<S>, int> = 0>
FISSURE_HD S larger(S a, S b) {
  return a > b ? a : b;
}
template <class S, std::enable_if_t<std::is_floating_point_v<S>, int> = 0>
FISSURE_HD S smaller(S a, S b) {
  return a < b ? a : b;
}
template <class S, std::enable_if_t<std::is_floating_point_v<S>, int> = 0>
FISSURE_HD S root(S a) {
  return std::sqrt(a);
}

/// Contiguous lanes from and to memory; the address must be a multiple of the pack's size for packs.
template <class S, std::enable_if_t<std::is_floating_point_v<S>, int> = 0>
FISSURE_HD S load(S const* from) {
  return *from;
}
template <class S, std::enable_if_t<std::is_floating_point_v<S>, int> = 0>
FISSURE_HD void store(S a, S* to) {
  *to = a;
}

/// The value of lane l, and a lane built from f(l).
template <class S, std::enable_if_t<std::is_floating_point_v<S>, int> = 0>
FISSURE_HD S lane(S a, int) {
  return a;
}
template <class S, std::enable_if_t<std::is_floating_point_v<S>, int> = 0>
FISSURE_HD void set_lane(S& a, int, S value) {
  a = value;
}
template <class S, class F, std::enable_if_t<std::is_floating_point_v<S>, int> = 0>
FISSURE_HD S generate(F&& f) {
  return f(0);
}

#if !defined(__CUDACC__)
namespace stdx = std::experimental;

template <class T>
using Pack = stdx::native_simd<T>;

template <class T, class Abi>
struct LaneTraits<stdx::simd<T, Abi>> {
  using Scalar = T;
  using Mask = stdx::simd_mask<T, Abi>;
  static constexpr int width = static_cast<int>(stdx::simd<T, Abi>::size());
};

template <class T, class Abi>
FISSURE_HD stdx::simd<T, Abi> select(stdx::simd_mask<T, Abi> const& mask, stdx::simd<T, Abi> a, stdx::simd<T, Abi> b) {
  stdx::where(mask, b) = a;
  return b;
}
template <class T, class Abi>
FISSURE_HD bool any_lane(stdx::simd_mask<T, Abi> const& mask) {
  return stdx::any_of(mask);
}
template <class T, class Abi>
FISSURE_HD bool all_lanes(stdx::simd_mask<T, Abi> const& mask) {
  return stdx::all_of(mask);
}
template <class T, class Abi>
FISSURE_HD stdx::simd<T, Abi> larger(stdx::simd<T, Abi> a, stdx::simd<T, Abi> b) {
  return stdx::max(a, b);
}
template <class T, class Abi>
FISSURE_HD stdx::simd<T, Abi> smaller(stdx::simd<T, Abi> a, stdx::simd<T, Abi> b) {
  return stdx::min(a, b);
}
template <class T, class Abi>
FISSURE_HD stdx::simd<T, Abi> root(stdx::simd<T, Abi> a) {
  return stdx::sqrt(a);
}
template <class S, std::enable_if_t<stdx::is_simd_v<S>, int> = 0>
FISSURE_HD S load(ScalarOf<S> const* from) {
  return S(from, stdx::vector_aligned);
}
template <class T, class Abi>
FISSURE_HD void store(stdx::simd<T, Abi> a, T* to) {
  a.copy_to(to, stdx::vector_aligned);
}
template <class T, class Abi>
FISSURE_HD T lane(stdx::simd<T, Abi> const& a, int l) {
  return a[l];
}
template <class T, class Abi>
FISSURE_HD void set_lane(stdx::simd<T, Abi>& a, int l, T value) {
  a[l] = value;
}
template <class S, class F, std::enable_if_t<stdx::is_simd_v<S>, int> = 0>
FISSURE_HD S generate(F&& f) {
  return S([&](auto l) { return static_cast<ScalarOf<S>>(f(static_cast<int>(l))); });
}
#endif

/// max(a, 0)
template <class S>
FISSURE_HD S positive(S a) {
  return larger(a, S(0));
}

/// Lane l of a vector.
template <int D, class S>
FISSURE_HD Vec<ScalarOf<S>, D> lane_of(Vec<S, D> const& v, int l) {
  Vec<ScalarOf<S>, D> one;
  for (int c = 0; c < D; ++c) one[c] = lane(v[c], l);
  return one;
}

/// f applied lane by lane: for functions that are rare enough to need no vector form (exp and pow of a softening
/// joint).
template <class S, class F>
FISSURE_HD S each_lane(S a, F&& f) {
  return generate<S>([&](int l) { return f(lane(a, l)); });
}

/// cbrt(1 + j) - 1 without loss of digits near j = 0: Pade's approximant [2/2], then Halley's iteration on
/// y^3 + 3 y^2 + 3 y = j. One step of it reaches round-off for |j| < 1/4, four for 0.01 < 1 + j < 100.
template <class S>
FISSURE_HD S cbrt_minus_one(S j) {
  S y = j * (S(18) + S(9) * j) / (S(54) + (S(45) + S(5) * j) * j);
  int const steps = all_lanes(larger(j, -j) < as<S>(0.25)) ? 1 : 4;
  for (int i = 0; i < steps; ++i) {
    S const f = ((y + S(3)) * y + S(3)) * y - j;
    S const g = S(3) * (y + S(1));  // half the second derivative
    S const d = g * (y + S(1));
    y = y - f * d / (d * d - f * g);
  }
  return y;
}

}  // namespace fissure

#if !defined(__CUDACC__)
namespace Eigen {
/// Packs as Eigen scalars: matrices of packs do in one go what matrices of scalars do lane by lane.
template <class T, class Abi>
struct NumTraits<std::experimental::simd<T, Abi>> : GenericNumTraits<std::experimental::simd<T, Abi>> {
  using Self = std::experimental::simd<T, Abi>;
  using Real = Self;
  using NonInteger = Self;
  using Nested = Self;
  using Literal = Self;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
};
}  // namespace Eigen
#endif
