// Exemplar of a bulk law (docs/developer.md, "a bulk law"): its own constants instead of Young's modulus, a parameter
// of its own, and a tangent that stiffens. neo-Hookean in shape; volume costs lambda/2 x^2 (1 + s x^2), x = J - 1.
#pragma once
#include "laws/neo_hookean.h"

namespace fissure::exemplar {

using namespace laws;

struct Stiffening : ElasticConstants {
  static constexpr char const* name = "stiffening";
  static constexpr char const* sentence = "neo-Hookean, and stiffer the more it swells or shrinks";
  double bulk_modulus = 0, shear_modulus = 0;  // [Pa]
  double stiffening = 10;                      // s [-]

  static std::array<Parameter<Stiffening>, 3> parameters() {
    return {{
        {"bulk", &Stiffening::bulk_modulus, "Pa", 0, unlimited, 1e5, 1e12, {}, "bulk modulus", true, false},
        {"shear", &Stiffening::shear_modulus, "Pa", 0, unlimited, 1e5, 1e12, {}, "shear modulus", true, false},
        {"stiffening", &Stiffening::stiffening, "", 0, unlimited, 0, 1e3, 10.0, "of the volume, by (J - 1)^2"},
    }};
  }
  /// Once its keys are read: what all else goes by.
  void prepare() {
    double const K = bulk_modulus, G = shear_modulus;
    young = 9 * K * G / (3 * K + G), poisson = (3 * K - 2 * G) / (6 * K + 2 * G);
  }

  template <class S>
  FISSURE_HD Mat<S, 3> kirchhoff(Mat<S, 3> const& H, S const& j) const {
    Mat<S, 3> tau = as<S>(shear()) * (H + H.transpose() + H.lazyProduct(H.transpose()));
    S const pressure = as<S>(lame()) * j * (S(1) + as<S>(2 * stiffening) * j * j) * (S(1) + j);
    for (int i = 0; i < 3; ++i) tau(i, i) += pressure;
    return tau;
  }
  template <class S>
  FISSURE_HD S energy(Mat<S, 3> const& H, S const& j) const {
    NeoHookean plain;
    plain.young = young, plain.poisson = poisson;
    return plain.energy(H, j) + as<S>(0.5 * lame() * stiffening) * j * j * j * j;
  }
  /// Thickness strain without stress, by Newton's method from where J is 1: PlaneStress searches where a law has none,
  /// but not far enough for one that stiffens so. tau_zz = mu ((1 + h)^2 - 1) + lambda J x (1 + 2 s x^2) = 0.
  template <class S>
  FISSURE_HD S free_thickness(S const& j) const {
    S const mu = as<S>(shear()), lambda = as<S>(lame()), s = as<S>(stiffening);
    S h = -j / (S(1) + j);
    for (int step = 0; step < 12; ++step) {
      S const x = j + h + j * h, J = S(1) + x, swell = x * (S(1) + S(2) * s * x * x), slope = S(1) + S(6) * s * x * x;
      h -= (mu * h * (S(2) + h) + lambda * J * swell) /
           (S(2) * mu * (S(1) + h) + lambda * (S(1) + j) * (swell + J * slope));
    }
    return h;
  }
};

}  // namespace fissure::exemplar
