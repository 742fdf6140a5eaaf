// What the stable step watches of cells of any kind (solver/step_limit.h).
#pragma once
#include "backend/for_each.h"
#include "base/dim.h"

namespace fissure::kernels {

/// Raises sums to what one pack has: `squares`, the sum of squared gradients of shape functions now [1/m^2]; |C|^2 and
/// |C^-1|^2 of C = F^T F, F = I + H and 1 + hoop out of the plane; and squares times the squared speed `fastest`: no
/// strain rate will soon be larger than its root, whatever stands in the way.
template <int D, class S>
FISSURE_HD void raise_deformation(S const& squares, Mat<S, D> F, S const& hoop, S const& fastest, Sums<4>& sums) {
  for (int i = 0; i < D; ++i) F(i, i) += S(1);
  Mat<S, D> const C = F.transpose().lazyProduct(F), cofactor = Dim<D>::cofactor(C);
  S const det = C.col(0).dot(cofactor.col(0)), out = (S(1) + hoop) * (S(1) + hoop);
  S const rate = squares * fastest, stretch = C.squaredNorm() + out * out,
          squeeze = cofactor.squaredNorm() / (det * det) + S(1) / (out * out);
  for (int l = 0; l < lane_width<S>; ++l) {
    double const one[4] = {static_cast<double>(lane(squares, l)), static_cast<double>(lane(stretch, l)),
                           static_cast<double>(lane(squeeze, l)), static_cast<double>(lane(rate, l))};
    for (int k = 0; k < 4; ++k)
      if (one[k] > sums[k]) sums[k] = one[k];
  }
}

}  // namespace fissure::kernels
