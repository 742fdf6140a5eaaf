// Exemplar of a cohesive law with a memory of its own (docs/developer.md, "a cohesive law"): a joint that has begun to
// soften wears as it slides to and fro; its shear strength falls by exp(-wear * way).
#pragma once
#include "laws/cohesive.h"

namespace fissure::exemplar {

using namespace laws;

struct WearingJoint : CohesiveJoint {
  static constexpr char const* name = "wearing";
  double wear = 0;  // [1/m]

  template <class S>
  struct History : CohesiveJoint::History<S> {
    S way = S(0);   // slid since damage began [m]
    S last = S(0);  // the slip then [m]

    static constexpr int numbers = CohesiveJoint::History<S>::numbers + 2;
    template <class Number>
    FISSURE_HD static History read(Number const& number) {
      return {CohesiveJoint::History<S>::read(number), number(numbers - 2), number(numbers - 1)};
    }
    template <class Put>
    FISSURE_HD void write(Put const& put) const {
      CohesiveJoint::History<S>::write(put);
      put(numbers - 2, way), put(numbers - 1, last);
    }
    FISSURE_HD static History broken() { return {CohesiveJoint::History<S>::broken(), S(0), S(0)}; }
  };

  /// What wears remembers every way, so it is asked in every step.
  template <class S>
  FISSURE_HD MaskOf<S> holds(S k, S opening, S slip, History<S> const& history, Tension<S> const& tension = {}) const {
    return CohesiveJoint::holds(k, opening, slip, history, tension) && history.damage == S(0);
  }
  template <class T>
  FISSURE_HD JointTraction<T> soften(T k, T opening, T slip, History<T>& history, JointEnergy<T>& energy) const {
    return soften(k, opening, slip, history, energy, [] { return JointGap<T>{}; });
  }
  template <class T, class Begun>
  FISSURE_HD JointTraction<T> soften(T k, T opening, T slip, History<T>& history, JointEnergy<T>& energy,
                                     Begun const& begun, Tension<T> const& tension = {}) const {
    if (history.damage > T(0)) history.way += slip > history.last ? slip - history.last : history.last - slip;
    history.last = slip;
    WearingJoint worn = *this;
    worn.CohesiveJoint::shear *= std::exp(-wear * static_cast<double>(history.way));
    return worn.CohesiveJoint::soften(k, opening, slip, history, energy, begun, tension);
  }
  template <class T>
  FISSURE_HD static JointTraction<T> give_way(T k, T opening, T slip, History<T>& history, JointEnergy<T>& energy) {
    return CohesiveJoint::give_way(k, opening, slip, history, energy);
  }
};

}  // namespace fissure::exemplar
