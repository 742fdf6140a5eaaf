// Kernels of the backend's own tests; backend_kernels.cu compiles them for CUDA.
#pragma once
#include "backend/for_each.h"

namespace fissure::test {

/// to = factor * from
template <class Real_>
struct Scale {
  static constexpr char const* name = "scale";
  static constexpr bool packed = true;
  using Real = Real_;
  Real const* from = nullptr;
  Real* to = nullptr;
  double factor = 1;

  template <class S>
  FISSURE_HD void operator()(Index i) const {
    store(as<S>(factor) * load<S>(from + i), to + i);
  }
};

/// to = its own index
struct Number {
  static constexpr char const* name = "number";
  static constexpr bool packed = false;
  using Real = double;
  Index* to = nullptr;

  template <class S>
  FISSURE_HD void operator()(Index i) const {
    to[i] = i;
  }
};

/// Sum of the values and of their squares.
struct Moments {
  static constexpr char const* name = "moments";
  static constexpr bool packed = false;
  using Real = double;
  double const* values = nullptr;

  template <class S>
  FISSURE_HD void operator()(Index i, Sums<2>& sums) const {
    sums[0] += values[i];
    sums[1] += values[i] * values[i];
  }
};

/// Sum of the values, pack by pack.
template <class Real_>
struct Total {
  static constexpr char const* name = "total";
  static constexpr bool packed = true;
  using Real = Real_;
  Real const* values = nullptr;

  template <class S>
  FISSURE_HD void operator()(Index i, Sums<1>& sum) const {
    add_lanes(load<S>(values + i), sum[0]);
  }
};

/// Largest value and largest of the values' negatives.
struct Range {
  static constexpr char const* name = "range";
  static constexpr bool packed = false;
  using Real = double;
  double const* values = nullptr;

  template <class S>
  FISSURE_HD void operator()(Index i, Sums<2>& most) const {
    most[0] = larger(most[0], values[i]);
    most[1] = larger(most[1], -values[i]);
  }
};

}  // namespace fissure::test
