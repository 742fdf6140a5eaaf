// Munjiza's elastic law (paper eq. 2; Munjiza 2004, ch. 4): linear in two strains that separate shape from volume,
//   T = |F|^(-2/3) [ E/(1+nu) Ed + E/(1-2nu) Es ],  Ed = (F F^T |F|^(-2/3) - I)/2,  Es = I (|F|^(2/3) - 1)/2,
// T the Cauchy stress. It has no stored energy at large strain: energy() is exact to second order in strain.
// |F| is the signed determinant: an inverted element is an error of the run, not a state of the material.
#pragma once
#include "laws/elastic.h"

namespace fissure::laws {

struct Munjiza : ElasticConstants {
  static constexpr char const* name = "munjiza";
  static constexpr char const* sentence =
      "Munjiza's law, linear in shape and volume strains (paper eq. 2); no stored energy at large strain";
  static auto parameters() { return elastic_parameters<Munjiza>(); }

  /// Kirchhoff stress |F| T [Pa] from the displacement gradient H = F - I (3x3).
  template <class S>
  FISSURE_HD Mat<S, 3> kirchhoff(Mat<S, 3> const& H, S const& j) const {
    S const c = cbrt_minus_one(j);                                         // |F|^(1/3) - 1
    S const v = c * (c + S(2));                                            // |F|^(2/3) - 1
    S const scale = S(1) / (S(1) + v);                                     // |F|^(-2/3)
    Mat<S, 3> const b = H + H.transpose() + H.lazyProduct(H.transpose());  // F F^T - I
    S const shape = as<S>(0.5 * young / (1 + poisson)) * scale;
    S const volume = as<S>(0.5 * young / (1 - 2 * poisson)) * v;
    S const factor = (S(1) + j) * scale;
    // Ed = ((b + I) scale - I)/2 = (b - v I) scale / 2
    Mat<S, 3> tau = (factor * shape) * b;
    S const pressure = factor * (volume - shape * v);
    for (int i = 0; i < 3; ++i) tau(i, i) += pressure;
    return tau;
  }

  /// Elastic energy per reference volume [J/m^3]: T : Ed and T : Es halved.
  template <class S>
  FISSURE_HD S energy(Mat<S, 3> const& H, S const& j) const {
    S const c = cbrt_minus_one(j);
    S const v = c * (c + S(2));
    S const scale = S(1) / (S(1) + v);
    Mat<S, 3> const b = H + H.transpose() + H.lazyProduct(H.transpose());
    S shape = S(0);
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) {
        S const e = (b(i, k) - (i == k ? v : S(0))) * scale * as<S>(0.5);
        shape += e * e;
      }
    return as<S>(0.5 * young / (1 + poisson)) * shape + as<S>(0.5 * young / (1 - 2 * poisson) * 0.75) * v * v;
  }
};

}  // namespace fissure::laws
