// Cohesive joint between two elements: the combined single and smeared crack model (paper fig. 3; Munjiza 2004, ch. 7).
//   rising    sigma = [2 o/o_p - (o/o_p)^2] z ft,  o_p = 2 ft/k,  k = penalty/h        compression: sigma = k o
//   softening sigma = z(D) ft,  tau = z(D) fs,  fs = c + p tan(phi),  p = pressure on the joint
//   friction  of the damaged share 1 - z beside it, up to (1 - z) p residual, on a spring with a slider of its own (after
//             Alfano & Sacco 2006, doi 10.1002/nme.1728): a traction that followed the pressure along the secant would
//             give energy when pressed less on the way back (kernels/friction.h)
//   damage    D = min(1, sqrt(<(o-o_p)/(o_c-o_p)>^2 + <(s-s_p)/(s_c-s_p)>^2)), never decreasing; unloading along the secant
// o_c and s_c make the work to full separation exactly G1 and G2 per area:
//   G1 = 2/3 ft o_p + I ft (o_c - o_p),  I = integral of z over [0,1].
// h is the distance between the neighbouring centroids normal to the joint, so a uniformly stressed body gains the strain
// stress/penalty from its joints: E_eff = E/(1 + E/penalty) (docs/theory/joints.md).
#pragma once
#include <array>
#include <numbers>

#include "base/lanes.h"
#include "base/parameter.h"
#include "laws/softening.h"

namespace fissure::laws {

/// What one integration point of a joint remembers.
template <class S>
struct JointHistory {
  S damage = S(0);   // [-]
  S opening = S(0);  // largest so far [m]
  S slip = S(0);     // largest so far [m]
};

/// Traction on a joint, per reference area.
template <class S>
struct JointTraction {
  S normal;      // [Pa], tension positive
  S per_slip;    // shear traction over slip [Pa/m], so that no direction is needed at zero slip
};

/// Energies of one integration point per reference area [J/m^2].
template <class S>
struct JointEnergy {
  S stored, dissipated;  // `dissipated`: what this step took
};

template <class Softening>
struct Joint {
  double tension = 0;         // ft [Pa]
  double shear = 0;           // c: shear strength without pressure [Pa]
  double friction_angle = 0;  // phi [rad]
  double G1 = 0, G2 = 0;      // [J/m^2]
  double penalty = 0;         // [Pa]
  double residual = 0;        // friction coefficient of the broken joint, from the material's contact law
  double slope = 0;           // tan(friction_angle), set by prepare()

  /// To be called once its numbers are known: what every evaluation would otherwise compute again.
  void prepare() { slope = std::tan(friction_angle); }

  static std::array<Parameter<Joint>, 6> parameters() {
    return {{
        {"tension", &Joint::tension, "Pa", 0, unlimited, 1e3, 1e10, {}, "tensile strength", true, false},
        {"shear", &Joint::shear, "Pa", 0, unlimited, 1e3, unlimited, {}, "shear strength without pressure (cohesion when friction_angle is given)", true, false},
        {"friction_angle", &Joint::friction_angle, "rad", 0, std::numbers::pi / 2, 0, 1.3, 0.0, "Mohr-Coulomb: shear strength grows by pressure times its tangent", false, true},
        {"G1", &Joint::G1, "J/m2", 0, unlimited, 1e-2, 1e7, {}, "fracture energy of opening (mode I)", true, false},
        {"G2", &Joint::G2, "J/m2", 0, unlimited, 1e-2, 1e7, {}, "fracture energy of slip (modes II and III)", true, false},
        {"penalty", &Joint::penalty, "Pa", 0, unlimited, 1e6, 1e16, {}, "joint stiffness times spacing: the body keeps about 1/(1 + E/penalty) of its stiffness", true, false},
    }};
  }

  template <class S>
  FISSURE_HD S strength(S pressure) const {
    return as<S>(shear) + as<S>(slope) * pressure;
  }

  /// Traction while the point has never passed a peak: no history is read or written.
  template <class S>
  FISSURE_HD JointTraction<S> rising(S k, S opening, S slip) const {
    S const normal = k * opening * (S(1) - positive(opening) * k * as<S>(0.25 / tension));
    S const bend = slope > 0 ? as<S>(0.25) / strength(positive(-normal)) : as<S>(0.25 / shear);
    return {normal, k * (S(1) - slip * k * bend)};
  }

  /// True where the point has passed a peak in this step.
  template <class S>
  FISSURE_HD MaskOf<S> past_peak(S k, S opening, S slip) const {
    S const fs = slope > 0 ? strength(positive(-k * opening)) : as<S>(shear);
    return opening * k > as<S>(2 * tension) || slip * k > S(2) * fs;
  }

  /// Traction with damage; updates the history. One scalar at a time: few joints soften, and they branch.
  template <class T>
  FISSURE_HD JointTraction<T> soften(T k, T opening, T slip, JointHistory<T>& history, JointEnergy<T>& energy) const {
    T const ft = T(tension), op = 2 * ft / k, oc = op + softening_length(T(G1), ft, op);
    T const pressure = positive(-k * opening);
    T const fs = strength(pressure), sp = 2 * fs / k, sc = sp + softening_length(T(G2), T(shear), T(2 * shear) / k);

    JointHistory<T> const old = history;
    history.opening = larger(history.opening, opening);
    history.slip = larger(history.slip, slip);
    T const dn = positive(history.opening - op) / (oc - op), ds = positive(history.slip - sp) / (sc - sp);
    history.damage = smaller(T(1), larger(history.damage, root(dn * dn + ds * ds)));

    T const z0 = Softening::value(old.damage), z = Softening::value(history.damage);
    T const normal = opening <= 0 ? k * opening : branch(k, ft, op, opening, history.opening, z) * opening;
    T const per_slip = branch(k, fs, sp, slip, history.slip, z);

    energy.stored = (opening <= 0 ? k * opening * opening / 2 : stored(k, ft, op, opening, history.opening, z)) +
                    stored(k, fs, sp, slip, history.slip, z);
    energy.dissipated = taken(k, ft, op, positive(opening), old.opening, history.opening, z0, z) +
                        taken(k, fs, sp, slip, old.slip, history.slip, z0, z);
    return {normal, per_slip};
  }

  /// Share of the area that rubs instead of holding together: never below nothing, as round-off would have it.
  template <class T>
  FISSURE_HD T rubbing(T damage) const {
    return positive(T(1) - T(Softening::value(damage)));
  }
  /// Shear traction over slip that the area has which has not been damaged yet [Pa/m]; it holds at least half of that
  /// times slip^2.
  template <class T>
  FISSURE_HD T undamaged(T k, T opening, T slip, JointHistory<T> const& history) const {
    T const fs = strength(positive(-k * opening));
    return branch(k, fs, 2 * fs / k, slip, history.slip, T(1));
  }

  /// Energy stored by a rising point per area [J/m^2].
  template <class S>
  FISSURE_HD S rising_energy(S k, S opening, S slip) const {
    S const tensile = positive(opening);
    S const fs = slope > 0 ? strength(positive(-k * opening)) : as<S>(shear);
    return k * (opening * opening * as<S>(0.5) - tensile * tensile * tensile * k * as<S>(1 / (12 * tension)) +
                slip * slip * (as<S>(0.5) - slip * k / (S(12) * fs)));
  }

  /// Softening length x_c - x_p [m] that makes the total work G; at least a thousandth of the peak displacement, so a
  /// fracture energy too small for its strength and spacing is a sudden break, not a division by zero (check warns).
  template <class T>
  FISSURE_HD static T softening_length(T G, T f, T peak) {
    return larger((G - T(2) / 3 * f * peak) / (T(Softening::integral) * f), T(1e-3) * peak);
  }

 private:
  /// Secant stiffness at x: the parabola until its peak was passed, then the line from the origin to the furthest point.
  template <class T>
  FISSURE_HD static T branch(T k, T f, T peak, T x, T furthest, T z) {
    return furthest <= peak ? z * k * (1 - x / (2 * peak)) : z * f / furthest;
  }

  template <class T>
  FISSURE_HD static T parabola_energy(T k, T peak, T x) { return k * x * x * (T(0.5) - x / (6 * peak)); }

  template <class T>
  FISSURE_HD static T stored(T k, T f, T peak, T x, T furthest, T z) {
    return furthest <= peak ? z * parabola_energy(k, peak, x) : z * f / furthest * x * x / 2;
  }

  /// What the point lost in this step: minus half x^2 d(secant stiffness), by the rule that is exact on a straight piece of
  /// the envelope, plus the sixth of f x_p by which the parabola stores more than the secant at the peak.
  template <class T>
  FISSURE_HD static T taken(T k, T f, T peak, T x, T before, T after, T z0, T z) {
    if (after <= peak) return (z0 - z) * parabola_energy(k, peak, x);
    T const crossing = before <= peak ? z0 * f * peak / 6 : T(0);
    T const start = larger(before, peak);
    return crossing + smaller(x, start) * x / 2 * (z0 * f / start - z * f / after);
  }
};

struct MunjizaJoint : Joint<MunjizaSoftening> {
  static constexpr char const* name = "munjiza";
  static constexpr char const* sentence = "combined single and smeared crack model with Munjiza's softening curve; the default";
};

struct LinearJoint : Joint<LinearSoftening> {
  static constexpr char const* name = "linear";
  static constexpr char const* sentence = "the same with straight softening";
};

}  // namespace fissure::laws
