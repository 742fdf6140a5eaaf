// How strength grows with the speed at which it is overcome.
#pragma once
#include <array>
#include <vector>

#include "base/lanes.h"

namespace fissure::laws {

/// Factor over speed [m/s]: straight between points that begin at { 0, 1 }, as the last beyond it. No points: 1.
struct RateFactor {
  static constexpr int most = 64;
  int points = 0;
  float speed[most] = {}, factor[most] = {};

  template <class T>
  FISSURE_HD T value(T at) const {
    if (points == 0) return T(1);
    if (!(at < T(speed[points - 1]))) return T(factor[points - 1]);
    int low = 0;
    while (low < points - 2 && !(at < T(speed[low + 1]))) ++low;
    return T(factor[low]) +
           (T(factor[low + 1]) - T(factor[low])) * ((at - T(speed[low])) / (T(speed[low + 1]) - T(speed[low])));
  }

  /// The largest.
  float greatest() const { return points == 0 ? 1 : factor[points - 1]; }

  static RateFactor through(std::vector<std::array<double, 2>> const& curve) {
    RateFactor made;
    for (auto const& [at, times] : curve)
      made.speed[made.points] = static_cast<float>(at), made.factor[made.points++] = static_cast<float>(times);
    return made;
  }
};

}  // namespace fissure::laws
