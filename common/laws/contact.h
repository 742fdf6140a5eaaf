// Contact between bodies: penalty of Munjiza's potential (paper eqs. 9-10) and Coulomb friction.
#pragma once
#include <array>

#include "base/lanes.h"
#include "base/parameter.h"

namespace fissure::laws {

struct ContactLaw {
  static constexpr char const* name = "contact";
  double penalty = 0;   // [Pa]
  double friction = 0;  // [-]

  static std::array<Parameter<ContactLaw>, 2> parameters() {
    return {{
        {"penalty",
         &ContactLaw::penalty,
         "Pa",
         0,
         unlimited,
         1e5,
         1e15,
         {},
         "contact penalty: pressure at full overlap",
         true,
         false},
        {"friction", &ContactLaw::friction, "", 0, unlimited, 0, 2, 0.0, "Coulomb friction coefficient"},
    }};
  }

  FISSURE_HD bool rubs() const { return friction > 0; }
  /// The most that friction carries beside a force that presses [N].
  template <class T>
  FISSURE_HD T most(T pressing) const {
    return T(friction) * pressing;
  }
  /// What two touching materials do: springs in series, the smaller friction.
  static ContactLaw between(ContactLaw const& a, ContactLaw const& b) {
    return {2 * a.penalty * b.penalty / (a.penalty + b.penalty), a.friction < b.friction ? a.friction : b.friction};
  }
};

}  // namespace fissure::laws
