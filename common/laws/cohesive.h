// Cohesive joint between two elements: a spring that breaks (docs/theory/joints.md has the derivation).
//   intact     traction = k gap along the normal and in the face, k = penalty/h
//   peak       tension ft, shear fs = c + p tan(phi), p = pressure on the joint; both together by `mixed`
//   softening  traction = e k gap, 0 < e < 1: e falls so that the traction nowhere exceeds z(D) times the strength, and
//              never rises
//   damage     D, how far the gap is from the peak to where nothing holds, grows only while e falls
//   tension    of a joint that belongs to a crack across a tension (kernels/rankine.h): the part of its traction along
//              the tension is at most z(D) times what it carries when the tension reaches ft, and D grows by the gap's
//              part along it, too
//   friction   of the damaged share 1 - z beside it, up to (1 - z) p residual, on a spring with a slider of its own
//              (after Alfano & Sacco 2006, doi 10.1002/nme.1728; kernels/friction.h)
// The stored energy is e k gap^2/2 (pressed: k o^2/2 along the normal) with no pressure and no strength in it, so
// traction derives from it, and what is lost is k gap^2/2 times what e loses: never negative, whatever path, pressure
// or strength. Final gaps make the work to separation G1 in opening and G2 in slip without pressure, per area at rest:
//   G = f gap_p/2 + I f (gap_c - gap_p),  I = integral of z over [0,1].
// h is the distance between the neighbouring centroids normal to the joint, so a uniformly stressed body gains the
// strain stress/penalty from its joints: E_eff = E/(1 + E/penalty) (docs/theory/joints.md).
#pragma once
#include <array>
#include <limits>
#include <numbers>

#include "laws/joint.h"
#include "laws/softening.h"

namespace fissure::laws {

struct CohesiveJoint : JointConstants {
  double slope = 0;    // tan(friction_angle), set by prepare()
  bool alike = false;  // whether both curves are the same, set by prepare()
  Softening opens = Softening::munjiza(), slides = Softening::munjiza();

  /// What a point remembers. Given compliance c: e = 1/(1 + c).
  template <class S>
  struct History {
    S damage = S(0);        // D [-]
    S normal_given = S(0);  // compliance that damage has added in opening, over that of the whole joint [-]
    S shear_given = S(0);   // the same in slip [-]

    static constexpr int numbers = 3;
    template <class Number>
    FISSURE_HD static History read(Number const& number) {
      return {number(0), number(1), number(2)};
    }
    template <class Put>
    FISSURE_HD void write(Put const& put) const {
      put(0, damage), put(1, normal_given), put(2, shear_given);
    }
    FISSURE_HD static History broken() {
      constexpr S nothing = std::numeric_limits<S>::infinity();
      return {S(1), nothing, nothing};
    }
  };

  /// To be called once its numbers are known: what every evaluation would otherwise compute again.
  void prepare() { slope = std::tan(friction_angle), alike = opens == slides; }

  static constexpr char const* name = "cohesive";
  static std::array<Parameter<CohesiveJoint>, 6> parameters() {
    using Joint = CohesiveJoint;
    return {{
        {"tension", &Joint::tension, "Pa", 0, unlimited, 1e3, 1e10, {}, "tensile strength", true, false},
        {"shear",
         &Joint::shear,
         "Pa",
         0,
         unlimited,
         1e3,
         unlimited,
         {},
         "shear strength without pressure (cohesion when friction_angle is given)",
         true,
         false},
        {"friction_angle", &Joint::friction_angle, "rad", 0, std::numbers::pi / 2, 0, 1.3, 0.0,
         "Mohr-Coulomb: shear strength grows by pressure times its tangent", false, true},
        {"G1", &Joint::G1, "J/m2", 0, unlimited, 1e-2, 1e7, {}, "fracture energy of opening (mode I)", true, false},
        {"G2",
         &Joint::G2,
         "J/m2",
         0,
         unlimited,
         1e-2,
         1e7,
         {},
         "fracture energy of slip (modes II and III)",
         true,
         false},
        {"penalty",
         &Joint::penalty,
         "Pa",
         0,
         unlimited,
         1e6,
         1e16,
         {},
         "joint stiffness times spacing: the body keeps about 1/(1 + E/penalty) of its stiffness",
         true,
         false},
    }};
  }

  template <class S>
  FISSURE_HD S strength(S pressure) const {
    return as<S>(shear) + as<S>(slope) * pressure;
  }

  /// True where an intact point passes its peak.
  template <class S>
  FISSURE_HD MaskOf<S> past_peak(S k, S opening, S slip) const {
    S const pull = k * positive(opening) * as<S>(1 / tension), push = k * slip;
    S const fs = slope > 0 ? strength(positive(-k * opening)) : as<S>(shear);
    if (independent) return pull > S(1) || push > fs;
    return push * push > fs * fs * (S(1) - pull * pull);
  }

  /// How far tractions [Pa] are on the way from nothing to the peak, 1, beside others in proportion.
  double reach(double normal, double shear_traction) const {
    double const pull = std::max(normal, 0.0) / tension, push = shear_traction / strength(std::max(-normal, 0.0));
    return independent ? std::max(pull, push) : std::hypot(pull, push);
  }

  /// True where damage does not grow: what soften() leaves as it is.
  template <class S>
  FISSURE_HD MaskOf<S> holds(S k, S opening, S slip, History<S> const& history, Tension<S> const& tension = {}) const {
    S const open = positive(opening), pressure = positive(-k * opening);
    if (independent) {
      Mode<S> const normal(*this, S(1), S(0), S(0)), along(*this, S(0), S(1), pressure);
      return !(normal.exceeded(k, open, history.normal_given, normal.most(history.damage)) ||
               along.exceeded(k, slip, history.shear_given, along.most(history.damage)));
    }
    S const apart = root(open * open + slip * slip);
    Mode<S> const mode = mode_at(opening, open, apart, pressure, tension);
    return !mode.exceeded(k, apart, history.normal_given, mode.most(history.damage));
  }

  template <class T>
  FISSURE_HD JointTraction<T> soften(T k, T opening, T slip, History<T>& history, JointEnergy<T>& energy) const {
    return soften(k, opening, slip, history, energy, [] { return JointGap<T>{}; });
  }
  /// Traction with damage; updates the history. `begun()`: where the step that led here began, asked where damage
  /// grows; only energies need it. What a tension opens is an opening, whichever way its face lies. One scalar at a
  /// time: few joints soften, and they branch.
  template <class T, class Begun>
  FISSURE_HD JointTraction<T> soften(T k, T opening, T slip, History<T>& history, JointEnergy<T>& energy,
                                     Begun const& begun, Tension<T> const& tension = {}) const {
    T const open = positive(opening), pressure = positive(-k * opening);
    energy.dissipated = energy.by_slip = T(0);
    if (independent) {
      Mode<T> const normal(*this, T(1), T(0), T(0)), along(*this, T(0), T(1), pressure);
      T const opens_by = normal.most(history.damage), slides_by = along.most(history.damage);
      if (normal.exceeded(k, open, history.normal_given, opens_by) ||
          along.exceeded(k, slip, history.shear_given, slides_by)) {
        T const o = normal.way(k, open), s = along.way(k, slip);
        history.damage = smaller(T(1), larger(history.damage, root(o * o + s * s)));
        JointGap<T> const from = begun();
        energy.by_slip = along.give(k, slip, from.slip, slides_by, history.damage, history.shear_given);
        energy.dissipated = energy.by_slip + normal.give(k, open, positive(from.opening), opens_by, history.damage,
                                                         history.normal_given);
      }
    } else {
      T const apart = root(open * open + slip * slip);
      Mode<T> const mode = mode_at(opening, open, apart, pressure, tension);
      T const before = mode.most(history.damage);
      if (mode.exceeded(k, apart, history.normal_given, before)) {
        history.damage = smaller(T(1), larger(history.damage, mode.way(k, apart)));
        JointGap<T> const from = begun();
        T const opened = positive(from.opening);
        energy.dissipated = mode.give(k, apart, root(opened * opened + from.slip * from.slip), before, history.damage,
                                      history.normal_given);
        energy.by_slip = mode.along > T(0) ? T(0) : mode.slip * energy.dissipated;
        history.shear_given = history.normal_given;
      }
    }
    energy.stored = stored(k, opening, slip, history);
    return spring(k, opening, history);
  }
  /// Breaks what still holds, at once; adds what that held to what the step took in opening. Pressure stays.
  template <class T>
  FISSURE_HD static JointTraction<T> give_way(T k, T opening, T slip, History<T>& history, JointEnergy<T>& energy) {
    T const held = stored(k, opening, slip, history);
    history = History<T>::broken();
    energy.stored = stored(k, opening, slip, history);
    energy.dissipated += held - energy.stored;
    return spring(k, opening, history);
  }
  /// Traction at the damage there is: e k gap, what is pressed keeps its stiffness.
  template <class T>
  FISSURE_HD static JointTraction<T> spring(T k, T opening, History<T> const& history) {
    return {select(opening > T(0), T(k / (T(1) + history.normal_given) * opening), T(k * opening)),
            k / (T(1) + history.shear_given)};
  }
  /// What it holds at the damage there is, per area [J/m^2].
  template <class T>
  FISSURE_HD static T stored(T k, T opening, T slip, History<T> const& history) {
    auto const traction = spring(k, opening, history);
    return (traction.normal * opening + traction.per_slip * slip * slip) / 2;
  }

  /// Share of the area that rubs instead of holding together: never below nothing, as round-off would have it.
  template <class T>
  FISSURE_HD T rubbing(T damage) const {
    return positive(T(1) - slides.value(damage));
  }
  /// Shear traction over slip that the area has which has not been damaged yet [Pa/m]; it holds at least half of that
  /// times slip^2.
  template <class T>
  FISSURE_HD T undamaged(T k, T opening, T slip) const {
    T const fs = strength(positive(-k * opening));
    return fs / larger(slip, fs / k);
  }

  /// Softening length gap_c - gap_p [m] that makes the total work G, I being the curve's integral; at least a
  /// thousandth of the gap at the peak, so a fracture energy too small for its strength and spacing is a sudden break,
  /// not a division by zero (check warns). A joint that was inserted at its peak has no rise: all gap_c of its gap,
  /// which grows while the offset of that peak is taken back, is softening.
  template <class T>
  FISSURE_HD T softening_length(T G, T f, T peak, T integral) const {
    T const by_peak = inserted ? integral : T(0.5);
    return larger((G - f * peak * by_peak) / (integral * f), T(1e-3) * peak);
  }

 private:
  /// Opening and slip in a fixed ratio: `opening` and `slip` are the squared shares of each in the gap, which are
  /// those of the work; `along` is the gap's share along a tension.
  template <class T>
  struct Mode {
    CohesiveJoint const& joint;
    T opening, slip;
    Tension<T> tension;
    T along, strength;  // the last with pressure [Pa]

    FISSURE_HD Mode(CohesiveJoint const& law, T opening_share, T slip_share, T pressure,
                    Tension<T> const& opened_by = {}, T along_it = T(0))
        : joint(law),
          opening(opening_share),
          slip(slip_share),
          tension(opened_by),
          along(along_it),
          strength(together(law.strength(pressure))) {}

    /// On the ellipse (sigma/ft)^2 + (tau/fs)^2 = 1 (Camacho & Ortiz 1996, doi 10.1016/0020-7683(95)00255-3).
    FISSURE_HD T together(T fs) const {
      T const ft = as<T>(joint.tension), both = ft * fs / root(opening * fs * fs + slip * ft * ft);
      return select(slip > T(0), select(opening > T(0), both, fs), ft);
    }
    FISSURE_HD T z(T damage) const {
      T const opens = joint.opens.value(damage);
      if (joint.alike) return opens;
      return select(tension.cosine > T(0), opens, T(opening * opens + slip * joint.slides.value(damage)));
    }
    /// W1/G1 + W2/G2 = 1 when nothing holds any more (Wu & Reuter 1965).
    FISSURE_HD T length(T k) const {
      T const plain = together(T(joint.shear));
      T const G = T(1) / (opening / T(joint.G1) + slip / T(joint.G2));
      T const integral = tension.cosine > T(0) ? T(joint.opens.integral)
                                               : opening * T(joint.opens.integral) + slip * T(joint.slides.integral);
      return joint.softening_length(G, plain, plain / k, integral);
    }
    /// The traction that damage leaves at most [Pa].
    FISSURE_HD T most(T damage) const {
      return z(damage) * select(along > T(0), smaller(strength, T(torn() / along)), strength);
    }
    /// Whether the traction at the gap x lies above the most.
    FISSURE_HD MaskOf<T> exceeded(T k, T x, T given, T most) const { return k * x > most * (T(1) + given); }
    /// What its face carries along the tension when that is ft [Pa].
    FISSURE_HD T torn() const { return as<T>(joint.tension) * tension.cosine; }
    /// From the peak, 0, to where nothing holds any more, 1: by the ratio of opening and slip or along the tension,
    /// whichever is first.
    FISSURE_HD T way(T k, T x) const {
      T const own = positive(x - strength / k) / length(k);
      if (!(along > T(0))) return own;
      T const peak = torn() / k;  // along the tension, whose crack takes G1 per area across it
      T const tear = joint.softening_length(T(joint.G1) * tension.cosine, torn(), peak, T(joint.opens.integral));
      return larger(own, positive(x * along - peak) / tear);
    }
    /// Lets e fall so that the traction at x is the most that damage leaves, if it is more; `before`: the most so far.
    /// Returns k x^2/2 times what e has lost, by the rule that is exact where the curve is straight between x and where
    /// e began to fall: at the peak or where it stopped last, but not before the step began, for the strength may have
    /// fallen with the pressure.
    FISSURE_HD T give(T k, T x, T begun, T before, T damage, T& given) const {
      T const pull = k * x, after = most(damage);
      if (!(pull > after * (T(1) + given))) return T(0);
      T const e = T(1) / (T(1) + given), left = after / pull, from = smaller(x, larger(begun, before / (k * e)));
      given = pull / after - T(1);
      return pull * from * (e - left) / 2;
    }
  };

  /// Opening and slip at a gap `apart`; what is pressed slides, whatever tension opened it once or nearly did.
  template <class T>
  FISSURE_HD Mode<T> mode_at(T opening, T open, T apart, T pressure, Tension<T> const& tension) const {
    T const by = select(apart > T(0), T(open / apart), T(0)), share = by * by;
    T const along = select(opening > T(0) && tension.cosine > T(0),
                           T(positive(opening * tension.cosine + tension.slip) / apart), T(0));
    auto const where = [&](T value) { return select(along > T(0), value, T(0)); };
    return {*this, share, T(1) - share, pressure, {where(tension.cosine), where(tension.slip)}, along};
  }
};

}  // namespace fissure::laws
