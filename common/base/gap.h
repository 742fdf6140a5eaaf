// How far apart two sets of corners are along an axis.
#pragma once
#include "base/lanes.h"

namespace fissure {

/// The gap between the corners of `a` and those of `b` along an axis, times the axis' length; negative where they
/// overlap.
template <class Real, int D, int n>
FISSURE_HD Real gap_along(Vec<Real, D> const& axis, Vec<Real, D> const (&a)[n], Vec<Real, D> const (&b)[n]) {
  Real low_a = axis.dot(a[0]), high_a = low_a, low_b = axis.dot(b[0]), high_b = low_b;
  for (int k = 1; k < n; ++k) {
    Real const at_a = axis.dot(a[k]), at_b = axis.dot(b[k]);
    low_a = smaller(low_a, at_a), high_a = larger(high_a, at_a);
    low_b = smaller(low_b, at_b), high_b = larger(high_b, at_b);
  }
  return larger(low_a - high_b, low_b - high_a);
}

}  // namespace fissure
