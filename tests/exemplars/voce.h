// Exemplar of a hardening law and of the flow law made of it (docs/developer.md, "a hardening law"): Voce (1948),
// sigma = last - (last - first) exp(-strain/reach).
#pragma once
#include "laws/j2.h"

namespace fissure::exemplar {

using namespace laws;

struct Voce {
  double first = 0, last = 0;  // yield stress at no plastic strain, and after much of it [Pa]
  double reach = 0.05;         // strain over which it gets there [-]

  template <class Law>
  static std::array<Parameter<Law>, 3> hardening_parameters() {
    return {{
        {"first", &Law::first, "Pa", 0, unlimited, 1e5, 1e10, {}, "yield stress without plastic strain", true, false},
        {"last", &Law::last, "Pa", 0, unlimited, 1e5, 1e10, {}, "yield stress after much of it", true, false},
        {"reach", &Law::reach, "", 0, unlimited, 1e-4, 10, 0.05, "strain over which it gets there", true, false},
    }};
  }
  template <class S>
  FISSURE_HD S at_least(S const&, S const&) const {
    return as<S>(first);
  }
  template <class S>
  FISSURE_HD Yield<S> yield(S const& strain, S const&, S const&) const {
    S const left = as<S>(last - first) * exp_of(strain * as<S>(-1 / reach));
    return {as<S>(last) - left, left * as<S>(1 / reach), S(0)};
  }
};

struct VoceFlow : J2<Voce> {
  static constexpr char const* name = "voce";
  static constexpr char const* sentence = "J2 with the hardening of Voce";
  static auto parameters() { return hardening_parameters<VoceFlow>(); }
};

}  // namespace fissure::exemplar
