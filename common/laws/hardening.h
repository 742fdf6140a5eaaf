// Hardening: yield stress over equivalent plastic strain, its rate and temperature. Each law gives its value and its
// slopes.
#pragma once
#include <algorithm>
#include <array>

#include "base/elementary.h"
#include "base/parameter.h"
#include "laws/consistency.h"

namespace fissure::laws {

template <class S>
struct Yield {
  S stress;      // [Pa]
  S per_strain;  // [Pa]
  S per_rate;    // [Pa s]
};

/// Johnson & Cook 1985 (paper eq. 25): (A + B ep^n) (1 + C ln(rate/rate0)) (1 - T*^m), the rate term only above rate0,
/// the last one only with heat. The slope of ep^n is infinite at 0: below ep = 1e-6 the curve is the chord to that
/// point.
struct JohnsonCook {
  double A = 0, B = 0;      // [Pa]
  double n = 1;             // [-]
  double C = 0;             // [-]
  double rate0 = 1;         // [1/s]
  double m = 0;             // [-]; 0: temperature does not soften
  double melting = 0;       // [K]
  double melting_rise = 0;  // melting less the reference temperature [K]; set with the material's heat

  static constexpr double first = 1e-6;

  template <class Law>
  static std::array<Parameter<Law>, 7> hardening_parameters() {
    return {{
        {"A", &Law::A, "Pa", 0, unlimited, 1e5, 1e10, {}, "yield stress without plastic strain", true, false},
        {"B", &Law::B, "Pa", 0, unlimited, 0, 1e10, 0.0, "hardening B ep^n"},
        {"n", &Law::n, "", 0, 1, 0.01, 1, 1.0, "its exponent", true, false},
        {"C", &Law::C, "", 0, unlimited, 0, 1, 0.0, "rate hardening 1 + C ln(rate/rate0), above rate0"},
        {"rate0", &Law::rate0, "1/s", 0, unlimited, 1e-6, 1e4, 1.0, "reference strain rate", true, false},
        {"m", &Law::m, "", 0, unlimited, 0, 5, 0.0,
         "thermal softening 1 - ((T - reference)/(melting - reference))^m; 0: none; needs heat"},
        {"melting", &Law::melting, "K", 0, unlimited, 200, 5000, 1800.0,
         "temperature at which nothing is left of the strength", true, false},
    }};
  }

  /// Not more than the yield stress at this strain, at any rate; cheap [Pa].
  template <class S>
  FISSURE_HD S at_least(S const&, S const& rise) const {
    return m > 0 ? select(rise > S(0), S(0), as<S>(A)) : as<S>(A);
  }

  template <class S>
  FISSURE_HD Yield<S> yield(S const& strain, S const& rate, S const& rise) const {
    S const from = larger(strain, as<S>(first)), hard = as<S>(B) * power(from, n),
            share = smaller(strain * as<S>(1 / first), S(1));
    Yield<S> y{as<S>(A) + hard * share, hard * select(strain < as<S>(first), as<S>(1 / first), as<S>(n) / from), S(0)};
    if (C > 0 && any_lane(rate > as<S>(rate0))) {
      S const fast = larger(rate, as<S>(rate0)), factor = S(1) + as<S>(C) * log_of(S(fast * as<S>(1 / rate0)));
      y.per_rate = select(rate > as<S>(rate0), y.stress * as<S>(C) / fast, S(0));
      y.stress *= factor;
      y.per_strain *= factor;
    }
    if (m > 0 && any_lane(rise > S(0))) {
      S const warm = smaller(S(1), larger(rise * as<S>(1 / melting_rise), as<S>(1e-30)));
      S const left = larger(S(1) - power(warm, m), as<S>(1e-6));  // melted: next to nothing, but no division by zero
      y.stress *= left;
      y.per_strain *= left;
      y.per_rate *= left;
    }
    return y;
  }
};

/// Curves of yield stress over plastic strain, straight between their points, one per strain rate; between rates
/// straight in the logarithm of the rate, beyond the first and last rate as there. The numbers belong to the material.
struct Curves {
  double const* numbers = nullptr;  // strains [strains], ln rates [rates], yield stresses [Pa] [rates][strains]
  int strains = 0, rates = 0;
  double beyond = 0;  // slope after the last strain [Pa]

  template <class S>
  FISSURE_HD S at_least(S const&, S const&) const {
    return as<S>(numbers[strains + rates]);
  }

  int size() const { return strains + rates + strains * rates; }

  template <class S>
  FISSURE_HD Yield<S> yield(S const& strain, S const& rate, S const&) const {
    Yield<S> y{S(0), S(0), S(0)};
    for (int l = 0; l < lane_width<S>; ++l) {
      auto const one = look_up(static_cast<double>(lane(strain, l)), static_cast<double>(lane(rate, l)));
      using T = ScalarOf<S>;
      set_lane(y.stress, l, T(one.stress));
      set_lane(y.per_strain, l, T(one.per_strain));
      set_lane(y.per_rate, l, T(one.per_rate));
    }
    return y;
  }

 private:
  /// The last of n rising numbers that is not above x, or 0.
  FISSURE_HD static int place(double const* rising, int n, double x) {
    int low = 0, high = n;
    while (high - low > 1) {
      int const middle = (low + high) / 2;
      (rising[middle] <= x ? low : high) = middle;
    }
    return low;
  }
  FISSURE_HD Sloped<double> along(double const* curve, int i, double strain) const {
    if (i + 1 >= strains) return {curve[i] + beyond * (strain - numbers[i]), beyond};
    double const slope = (curve[i + 1] - curve[i]) / (numbers[i + 1] - numbers[i]);
    return {curve[i] + slope * (strain - numbers[i]), slope};
  }
  FISSURE_DEVICE FISSURE_RARE Yield<double> look_up(double strain, double rate) const {
    int const i = place(numbers, strains, strain);
    double const *const ln_rates = numbers + strains, *const curves = ln_rates + rates;
    double const ln_rate = rate > 0 ? std::log(rate) : -1e300;
    int const k = rates > 1 ? place(ln_rates, rates, ln_rate) : 0;
    auto const slow = along(curves + k * strains, i, strain);
    if (k + 1 >= rates || ln_rate <= ln_rates[k]) return {slow.value, slow.slope, 0};
    auto const fast = along(curves + (k + 1) * strains, i, strain);
    double const apart = ln_rates[k + 1] - ln_rates[k], share = (ln_rate - ln_rates[k]) / apart;
    return {slow.value + share * (fast.value - slow.value), slow.slope + share * (fast.slope - slow.slope),
            (fast.value - slow.value) / (apart * rate)};
  }
};

}  // namespace fissure::laws
