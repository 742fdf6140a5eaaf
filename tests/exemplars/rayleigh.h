// Exemplar of a damping model (docs/developer.md, "damping"): Rayleigh's stiffness-proportional part, the stress
// beta C : D. Unlike viscosity it calms changes of volume, too. In plane stress, where the rate out of the plane is not
// known, lambda would have to be that of plane stress.
#pragma once
#include "laws/elastic.h"

namespace fissure::exemplar {

using namespace laws;

struct Rayleigh {
  ElasticConstants solid;
  double beta = 0;  // [s]

  FISSURE_HD bool on() const { return beta > 0; }
  template <class S>
  FISSURE_HD Mat<S, 3> kirchhoff(Mat<S, 3> const& rate, S const& j) const {
    Mat<S, 3> stress = as<S>(2 * beta * solid.shear()) * rate;
    S const volume = as<S>(beta * solid.lame()) * rate.trace();
    for (int i = 0; i < 3; ++i) stress(i, i) += volume;
    return (S(1) + j) * stress;
  }
  FISSURE_HD double slowness(double, double) const { return beta; }
  double per_squared_frequency(double) const { return beta; }
};

}  // namespace fissure::exemplar
