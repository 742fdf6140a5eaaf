// What every elastic law shares: Young's modulus, Poisson's ratio and what follows from them.
#pragma once
#include <array>
#include <cmath>

#include "base/lanes.h"
#include "base/parameter.h"

namespace fissure::laws {

/// Isotropic elastic constants [Pa].
struct ElasticConstants {
  static constexpr bool remembers = false;  // stress follows from the displacement gradient alone
  double young = 0;                         // [Pa]
  double poisson = 0;                       // [-]

  FISSURE_HD double shear() const { return young / (2 * (1 + poisson)); }
  FISSURE_HD double bulk() const { return young / (3 * (1 - 2 * poisson)); }
  FISSURE_HD double lame() const { return young * poisson / ((1 + poisson) * (1 - 2 * poisson)); }
  /// E' = lambda + 2 mu, stiffness against confined compression: rho c_P^2.
  FISSURE_HD double confined() const { return lame() + 2 * shear(); }
  /// J, by which Kirchhoff stress exceeds Cauchy stress [-].
  template <class S>
  FISSURE_HD S volume_ratio(Mat<S, 3> const&, S const& j) const {
    return S(1) + j;
  }
};

/// `least_poisson`: below it the law has no stable answer.
template <class Law>
std::array<Parameter<Law>, 2> elastic_parameters(double least_poisson = -1) {
  return {{
      {"young", &Law::young, "Pa", 0, unlimited, 1e5, 1.5e12, {}, "Young's modulus", true, false},
      {"poisson",
       &Law::poisson,
       "",
       least_poisson,
       0.5,
       0.0,
       0.495,
       {},
       least_poisson < 0 ? "Poisson's ratio; 0.5 would be incompressible and needs an infinite wave speed"
                         : "Poisson's ratio; 0.5 would be incompressible and needs an infinite wave speed, below 0 "
                           "there is law = \"munjiza\"",
       least_poisson == -1,
       true},
  }};
}

}  // namespace fissure::laws
