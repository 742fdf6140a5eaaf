// Damping of what deforms: a stress against the rate of strain.
#pragma once
#include "base/lanes.h"

namespace fissure::laws {

/// Newton's: the Cauchy stress 2 mu D, D being the rate of strain; what a material's `damping` gives.
struct Viscosity {
  double mu = 0;  // [Pa s]

  FISSURE_HD bool on() const { return mu > 0; }
  /// Kirchhoff stress [Pa] at a rate of strain [1/s]; j = J - 1.
  template <class S>
  FISSURE_HD Mat<S, 3> kirchhoff(Mat<S, 3> const& rate, S const& j) const {
    return (as<S>(2 * mu) * (S(1) + j)) * rate;
  }
  /// How late a shear of the solid follows [s]: dampers of modes that the rate of strain does not see are as slow.
  FISSURE_HD double slowness(double young, double poisson) const { return mu * 2 * (1 + poisson) / young; }
  /// At most the damping rate of a mode over its squared frequency [s], for the stable step; stiffness: of confined
  /// strain [Pa].
  double per_squared_frequency(double stiffness) const { return 2 * mu / stiffness; }
};

}  // namespace fissure::laws
