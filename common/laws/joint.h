// What every law of a joint between two elements has (the concept JointLaw in laws/laws.h says the rest). One keeps a
// struct History<S> of what a point remembers:
//   damage            its first number: 0 where nothing has begun, 1 where nothing holds
//   numbers           how many there are
//   read(number)      from number(k);  write(put): to put(k, value)
//   broken()          of a point where nothing holds
#pragma once
#include <algorithm>

#include "base/lanes.h"
#include "base/parameter.h"
#include "laws/rate.h"

namespace fissure::laws {

/// Traction on a joint, per reference area.
template <class S>
struct JointTraction {
  S normal;    // [Pa], tension positive
  S per_slip;  // shear traction over slip [Pa/m], so that no direction is needed at zero slip
};

/// Energies of one integration point per reference area [J/m^2].
template <class S>
struct JointEnergy {
  S stored, dissipated, by_slip;  // the last two: what this step took, and its part that slip took
};

/// Opening and slip of a point [m].
template <class S>
struct JointGap {
  S opening = S(0), slip = S(0);
};

/// A tension that opens a joint, whichever way its face lies.
template <class S>
struct Tension {
  S cosine = S(0);  // of the angle between the tension and the normal [-]; 0: there is none
  S slip = S(0);    // part of the slip along the tension, times the sine of that angle [m]
};

/// What the host asks of every law: a law derives from it.
struct JointConstants {
  double tension = 0;         // ft [Pa]
  double shear = 0;           // c: shear strength without pressure [Pa]
  double friction_angle = 0;  // phi [rad]
  double G1 = 0, G2 = 0;      // work to separation in opening and in slip [J/m^2]
  double penalty = 0;         // stiffness times spacing [Pa]
  double residual = 0;        // friction coefficient of the broken joint, from the material's contact law
  bool independent = false;   // opening and slip each with its full strength; else both together on an ellipse
  bool rankine = false;       // begins where the stress beside it says so, too (kernels/rankine.h)
  bool inserted = false;      // only when a whole body reaches its strength there (kernels/insertion.h)
  RateFactor faster;          // strengths at the speed of the gap over those at rest [-]

  /// Opening or slip, the larger, at which nothing holds on a straight line of softening [m].
  double final_gap() const { return 2 * std::max(G1 / tension, G2 / shear); }
};

}  // namespace fissure::laws
