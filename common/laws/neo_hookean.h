// Compressible neo-Hookean law: W = mu/2 (tr(F F^T) - 3 - 2 ln J) + lambda/2 (J - 1)^2
// (Bonet & Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, 2008, ch. 6, with (J-1)^2 for ln^2 J).
// It has a stored energy at any strain, so a free elastic body keeps its energy.
#pragma once
#include "laws/elastic.h"

namespace fissure::laws {

struct NeoHookean : ElasticConstants {
  static constexpr char const* name = "neo_hookean";
  static constexpr char const* sentence = "compressible neo-Hookean law: has a stored energy at any strain";
  static auto parameters() { return elastic_parameters<NeoHookean>(); }

  /// Kirchhoff stress [Pa]: tau = mu (F F^T - I) + lambda (J - 1) J I, from H = F - I and j = J - 1.
  template <class S>
  FISSURE_HD Mat<S, 3> kirchhoff(Mat<S, 3> const& H, S const& j) const {
    Mat<S, 3> tau = as<S>(shear()) * (H + H.transpose() + H.lazyProduct(H.transpose()));
    S const pressure = as<S>(lame()) * j * (S(1) + j);
    for (int i = 0; i < 3; ++i) tau(i, i) += pressure;
    return tau;
  }

  /// Stored energy per reference volume [J/m^3].
  template <class S>
  FISSURE_HD S energy(Mat<S, 3> const& H, S const& j) const {
    S const stretch = S(2) * H.trace() + H.squaredNorm();  // tr(F F^T) - 3
    S const log_j = each_lane(j, [](auto x) { return std::log1p(x); });
    return as<S>(0.5 * shear()) * (stretch - S(2) * log_j) + as<S>(0.5 * lame()) * j * j;
  }
};

}  // namespace fissure::laws
