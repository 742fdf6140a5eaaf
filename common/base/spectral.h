// Functions of symmetric matrices by their eigenvalues, over lanes.
#pragma once
#include "base/dim.h"
#include "base/lanes.h"

namespace fissure {

/// f(A) = sum f(lambda_i) v_i v_i^T of a symmetric A, by Jacobi's rotations (Golub & Van Loan, 4th ed., 8.5): each
/// takes one number off the diagonal, and six rounds of three leave nothing of it that a double could hold.
template <class S, class F>
FISSURE_RARE FISSURE_DEVICE Mat<S, 3> spectral(Mat<S, 3> A, F&& f) {
  Mat<S, 3> V = Mat<S, 3>::Identity();
  for (int round = 0; round < 6; ++round)
    for (int k = 0; k < 3; ++k) {
      int const p = k, q = (k + 1) % 3, r = (k + 2) % 3;
      // tan of the angle that clears A(p, q), the smaller of two: 2 a/(d + sign(d) (d^2 + 4 a^2)^(1/2))
      S const twice = A(p, q) + A(p, q), d = A(q, q) - A(p, p), whole = root(d * d + twice * twice);
      S const below = select(d < S(0), S(d - whole), S(d + whole));
      S const t = select(whole > S(0), S(twice / select(whole > S(0), below, S(1))), S(0));
      S const c = S(1) / root(S(1) + t * t), s = t * c;
      A(p, p) -= as<S>(0.5) * t * twice, A(q, q) += as<S>(0.5) * t * twice;
      A(p, q) = A(q, p) = S(0);
      S const rp = c * A(r, p) - s * A(r, q), rq = s * A(r, p) + c * A(r, q);
      A(r, p) = A(p, r) = rp, A(r, q) = A(q, r) = rq;
      for (int i = 0; i < 3; ++i) {
        S const vp = c * V(i, p) - s * V(i, q), vq = s * V(i, p) + c * V(i, q);
        V(i, p) = vp, V(i, q) = vq;
      }
    }
  Mat<S, 3> result = Mat<S, 3>::Constant(S(0));
  for (int k = 0; k < 3; ++k) {
    S const value = f(A(k, k));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) result(i, j) += value * (V(i, k) * V(j, k));
  }
  return result;
}

}  // namespace fissure
