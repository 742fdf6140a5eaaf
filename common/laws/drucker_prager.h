// Drucker-Prager plasticity with combined hardening (paper eqs. 26-31), in Kirchhoff stress; p = -tr(tau)/3.
//   f = q(xi) - tan(theta) p - J R,   xi = s - back,   g = q(xi) - tan(psi) p,
//   R = Y0(0) + beta (Y0(ep) - Y0(0)) + Y(ep, rate) - Y0(ep)
// Y0 is the curve at rest: what a rate adds is isotropic, it does not move the centre.
// In a step ep grows by x, q(xi) falls by 3 G x + (1 - beta) dY0, p rises by K tan(psi) x, the centre moves by (1 -
// beta) dY0 along xi. Beyond the cone's tip, where q would turn negative, the stress goes to the tip and ep grows by
// (plastic volume)/tan(theta). beta = 1: isotropic, 0: kinematic. The paper's a is tan(theta)/3 (its table 2 prints
// table 1's A and B for a and beta).
#pragma once
#include "laws/j2.h"

namespace fissure::laws {

struct DruckerPrager : Curves {
  static constexpr char const* name = "drucker_prager";
  static constexpr char const* sentence =
      "yield stress that grows with pressure; the cohesion is a number, a table or a function";
  static constexpr bool has_back = true;
  double friction_angle = 0;  // theta [rad]
  double dilation_angle = 0;  // psi [rad]
  double beta = 1;            // share of hardening that is isotropic [-]

  static std::array<Parameter<DruckerPrager>, 3> parameters() {
    return {{
        {"friction_angle",
         &DruckerPrager::friction_angle,
         "rad",
         0,
         1.25,
         0,
         1.2,
         {},
         "angle theta of the yield surface in the p-q plane"},
        {"dilation_angle", &DruckerPrager::dilation_angle, "rad", 0, 1.25, 0, 1.2, 0.0,
         "angle psi of the flow; equal to friction_angle: associated"},
        {"beta", &DruckerPrager::beta, "", 0, 1, 0, 1, 1.0,
         "share of hardening that is isotropic; the rest is kinematic"},
    }};
  }

  template <class S>
  FISSURE_HD void flow(ElasticConstants const& elastic, FlowStep<S> const& step, FlowPoint<S, true>& point) const {
    double const steep = std::tan(friction_angle), dilates = std::tan(dilation_angle), stiff = 3 * elastic.shear(),
                 bulk = elastic.bulk();
    S const mean = point.stress.trace() * as<S>(1.0 / 3);
    Mat<S, 3> const xi = deviator(point.stress) - point.back;
    S const q = root(as<S>(1.5) * xi.squaredNorm());
    S const first = this->yield(S(0), S(0), S(0)).stress, rest = this->yield(point.strain, S(0), S(0)).stress;
    auto const flows = q + as<S>(steep) * mean > step.volume * (first + as<S>(beta) * (rest - first));
    S const before = point.rate;
    point.rate = S(0);
    if (!any_lane(flows)) return;

    // R after flow by x, its slope, and how far the curve at rest has risen.
    struct Radius {
      S value, slope, risen;
    };
    auto const radius = [&](S const& x) {
      Yield<S> const slow = this->yield(point.strain + x, S(0), S(0)),
                     y = this->yield(point.strain + x, x * step.per_time, S(0));
      S const overstress = y.stress - slow.stress;
      return Radius{first + as<S>(beta) * (slow.stress - first) + overstress,
                    as<S>(beta) * slow.per_strain + (y.per_strain - slow.per_strain) + y.per_rate * step.per_time,
                    slow.stress - rest};
    };
    auto const excess = [&](S const& x) {
      Yield<S> const y = this->yield(point.strain + x, x * step.per_time, S(0));
      Radius const r = radius(x);
      S const hardened = step.volume * (y.per_strain + y.per_rate * step.per_time);
      return Sloped<S>{q - as<S>(stiff) * x - step.volume * as<S>(1 - beta) * r.risen +
                           as<S>(steep) * (mean - as<S>(bulk * dilates) * x) - step.volume * r.value,
                       as<S>(-(stiff + bulk * dilates * steep)) - hardened};
    };
    // q(xi) vanishes at or before x = q/3G: if the cone has not been reached there, it is its tip that is.
    S const most = q * as<S>(1 / stiff), x = consistent(flows, most, before / step.per_time, step.bisection, excess);
    S const moved = step.volume * as<S>(1 - beta) * radius(x).risen, left = q - as<S>(stiff) * x - moved;
    auto const tip = flows && (excess(most).value > S(0) || left < S(0));

    S const flowed = select(flows, x, S(0)), unit = S(1) / larger(q, as<S>(1e-30));
    Mat<S, 3> const along = unit * xi;
    S const shift = select(flows, moved, S(0)), shear = as<S>(stiff) * flowed;
    S grown = flowed, pressure_drop = as<S>(bulk * dilates) * flowed;
    Mat<S, 3> s = deviator(point.stress) - shear * along, back = point.back + shift * along;
    if (any_lane(tip)) {
      // tan(theta) (mean - K z) = J R(ep + z/tan(theta)), z the plastic change of volume.
      S const reach = positive(mean) * as<S>(1 / bulk);
      S const z = consistent(tip, reach, S(0), step.bisection, [&](S const& z) {
        Radius const r = radius(S(z * as<S>(1 / steep)));
        return Sloped<S>{as<S>(steep) * (mean - as<S>(bulk) * z) - step.volume * r.value,
                         as<S>(-bulk * steep) - step.volume * as<S>(1 / steep) * r.slope};
      });
      grown = select(tip, z * as<S>(1 / steep), grown);
      pressure_drop = select(tip, as<S>(bulk) * z, pressure_drop);
      for (int i = 0; i < 9; ++i) {
        back(i / 3, i % 3) = select(tip, point.back(i / 3, i % 3), back(i / 3, i % 3));
        s(i / 3, i % 3) = select(tip, point.back(i / 3, i % 3), s(i / 3, i % 3));
      }
    }
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k)
        point.stress(i, k) = select(flows, s(i, k) + (i == k ? mean - pressure_drop : S(0)), point.stress(i, k));
    point.back = back;
    point.strain += grown;
    point.rate = grown * step.per_time;
  }

  /// (q + tan(theta) tr(tau)/3) over its limit at this strain and rate [-].
  template <class Point>
  double yield_ratio(Point const& point, double volume) const {
    double const first = yield(0.0, 0.0, 0.0).stress, slow = yield(point.strain, 0.0, 0.0).stress,
                 now = yield(point.strain, point.rate, 0.0).stress;
    double const q = std::sqrt(1.5 * (deviator(point.stress) - point.back).squaredNorm());
    return (q + std::tan(friction_angle) * point.stress.trace() / 3) /
           (volume * (first + beta * (slow - first) + now - slow));
  }
};

}  // namespace fissure::laws
