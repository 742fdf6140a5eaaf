// The scalar equation of a return mapping (paper eq. 23): how much flow brings the stress back to the yield surface.
#pragma once
#include "base/lanes.h"

namespace fissure::laws {

/// A value and its slope.
template <class S>
struct Sloped {
  S value, slope;
};

/// x in [0, most] where f falls through zero, f(0) >= 0 >= f(most), in the lanes of `wanted`; f(x) gives a Sloped.
/// Newton's method from `guess`, halving the bracket wherever it would leave it or jump to one of its ends; or
/// bisection alone, the paper's way.
template <class S, class F>
FISSURE_HD S consistent(MaskOf<S> const& wanted, S const& most, S const& guess, bool bisection, F&& f) {
  constexpr bool wide = sizeof(ScalarOf<S>) == 8;
  // A Newton step this short leaves an error of its square; bisection ends with the last bit.
  S const enough = most * as<S>(bisection ? (wide ? 1e-16 : 1e-8) : (wide ? 1e-8 : 1e-6));
  // of x itself: where the logarithm of a small rate is steep
  S const fine = as<S>(bisection ? 1 : wide ? 1e-6 : 1e-4);
  S low = S(0), high = most;
  S x = bisection ? S(most * as<S>(0.5)) : larger(low, smaller(high, guess));
  for (int i = 0; i < 80; ++i) {
    Sloped<S> const at = f(x);
    auto const below = at.value > S(0);
    low = select(below, x, low);
    high = select(below, high, x);
    S const middle = as<S>(0.5) * (low + high), newton = x - at.value / at.slope;
    auto const near = larger(newton - x, x - newton) <= smaller(enough, x * fine),
               inside = newton > low && newton < high;
    S const next = bisection ? middle : select(near || inside, newton, middle);
    S const moved = select(wanted, larger(next - x, x - next), S(0));
    x = next;
    if (all_lanes(moved <= smaller(enough, next * fine))) break;
  }
  return x;
}

}  // namespace fissure::laws
