// Compressible neo-Hookean law: W = mu/2 (tr(F F^T) - 3 - 2 ln J) + lambda/2 (J - 1)^2
// (Bonet & Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, 2008, ch. 6, with (J-1)^2 for ln^2 J).
// It has a stored energy at any strain, so a free elastic body keeps its energy.
#pragma once
#include "base/elementary.h"
#include "laws/elastic.h"

namespace fissure::laws {

struct NeoHookean : ElasticConstants {
  static constexpr char const* name = "neo_hookean";
  static constexpr char const* sentence =
      "compressible neo-Hookean law, has a stored energy at any strain; the default";
  /// Below nu = 0 lambda is negative, and a body that swells would find no end to the energy it gains.
  static auto parameters() { return elastic_parameters<NeoHookean>(0); }

  /// Kirchhoff stress [Pa]: tau = mu (F F^T - I) + lambda (J - 1) J I, from H = F - I and j = J - 1.
  template <class S>
  FISSURE_HD Mat<S, 3> kirchhoff(Mat<S, 3> const& H, S const& j) const {
    Mat<S, 3> tau = as<S>(shear()) * (H + H.transpose() + H.lazyProduct(H.transpose()));
    S const pressure = as<S>(lame()) * j * (S(1) + j);
    for (int i = 0; i < 3; ++i) tau(i, i) += pressure;
    return tau;
  }

  /// Stored energy per reference volume [J/m^3]. tr(F F^T) - 3 - 2 ln J = |H|^2 - 2 (J - 1 - tr H) + 2 (j - ln J),
  /// whose terms are all of second order in strain: single precision keeps its digits.
  template <class S>
  FISSURE_HD S energy(Mat<S, 3> const& H, S const& j) const {
    S minors = H.determinant();  // J - 1 - tr H
    for (int a = 0, b = 1; a < 3; ++a, b = (b + 1) % 3) minors += H(a, a) * H(b, b) - H(a, b) * H(b, a);
    return as<S>(0.5 * shear()) * (H.squaredNorm() - S(2) * minors + S(2) * excess_over_log(j)) +
           as<S>(0.5 * lame()) * j * j;
  }

  /// Thickness strain h [-] that leaves no stress out of the plane, whose own J is 1 + j: tau_zz = 0 is quadratic in 1
  /// + h.
  template <class S>
  FISSURE_HD S free_thickness(S const& j) const {
    S const mu = as<S>(shear()), J = S(1) + j, swell = as<S>(lame()) * J;
    // a h^2 + b h + swell j = 0
    S const a = mu + swell * J, b = S(2) * a - swell, q = root(S(swell * swell + S(4) * mu * a));
    return select(b > S(0), S(-2) * swell * j / (larger(b, S(0)) + q), (q - b) / (S(2) * a));
  }
};

}  // namespace fissure::laws
