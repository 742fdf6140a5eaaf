// J2 plasticity: radial return to the von Mises surface (Wilkins 1964; paper eqs. 11-24), in Kirchhoff stress tau = J
// sigma.
//   q = sqrt(3/2 s:s) <= J Y(ep, rate, T),   q_trial - 3 G x = J Y(ep + x, x/dt, T),   s = (1 - 3 G x/q_trial) s_trial
// x is the increment of the equivalent plastic strain; the paper's Gamma is sqrt(3/2) x.
#pragma once
#include "laws/elastic.h"
#include "laws/hardening.h"

namespace fissure::laws {

struct NoBack {};

/// What a material point that flows remembers; a law without a moving yield surface has no `back`.
template <class S, bool has_back>
struct FlowPoint {
  Mat<S, 3> stress;  // Kirchhoff [Pa]: the trial on entry, on the yield surface or inside it on return
  S strain;          // equivalent plastic strain ep [-]
  S rate;            // its rate in the last step [1/s]
  S rise;            // of the temperature over the reference [K]
  std::conditional_t<has_back, Mat<S, 3>, NoBack> back;  // centre of the yield surface, deviatoric [Pa]
};

/// The conditions of one step.
template <class S>
struct FlowStep {
  S volume;        // J
  S per_time;      // 1/dt [1/s]
  bool bisection;  // the reference way to solve the scalar equation
};

template <class S>
FISSURE_HD Mat<S, 3> deviator(Mat<S, 3> a) {
  S const mean = a.trace() * as<S>(1.0 / 3);
  for (int i = 0; i < 3; ++i) a(i, i) -= mean;
  return a;
}

template <class Hardening>
struct J2 : Hardening {
  static constexpr bool has_back = false;

  /// The return itself. A lane that does not flow keeps its stress to the last bit, whatever flows beside it.
  template <class S>
  FISSURE_HD void flow(ElasticConstants const& elastic, FlowStep<S> const& step, FlowPoint<S, false>& point) const {
    S const mean = point.stress.trace() * as<S>(1.0 / 3);
    Mat<S, 3> const s = deviator(point.stress);
    S const q = root(as<S>(1.5) * s.squaredNorm());
    S const before = point.rate;
    point.rate = S(0);
    if (!any_lane(q > step.volume * this->at_least(point.strain, point.rise))) return;
    Yield<S> const rest = this->yield(point.strain, S(0), point.rise);
    auto const flows = q > step.volume * rest.stress;
    if (!any_lane(flows)) return;
    double const stiff = 3 * elastic.shear();
    S const most = q * as<S>(1 / stiff), excess = q - step.volume * rest.stress;
    S const guess =
        select(before > S(0), before / step.per_time, excess / (as<S>(stiff) + step.volume * rest.per_strain));
    S const x = consistent(flows, most, guess, step.bisection, [&](S const& x) {
      Yield<S> const y = this->yield(point.strain + x, x * step.per_time, point.rise);
      return Sloped<S>{q - as<S>(stiff) * x - step.volume * y.stress,
                       as<S>(-stiff) - step.volume * (y.per_strain + y.per_rate * step.per_time)};
    });
    S const flowed = select(flows, x, S(0)), keep = S(1) - as<S>(stiff) * flowed / select(flows, q, S(1));
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k)
        point.stress(i, k) = select(flows, keep * s(i, k) + (i == k ? mean : S(0)), point.stress(i, k));
    point.strain += flowed;
    point.rate = flowed * step.per_time;
  }

  /// von Mises stress over yield stress at this strain, rate and temperature [-].
  template <class Point>
  double yield_ratio(Point const& point, double volume) const {
    return std::sqrt(1.5 * deviator(point.stress).squaredNorm()) /
           (volume * this->yield(point.strain, point.rate, point.rise).stress);
  }
};

struct JohnsonCookFlow : J2<JohnsonCook> {
  static constexpr char const* name = "johnson_cook";
  static constexpr char const* sentence = "J2 with the hardening of Johnson and Cook (paper eq. 25)";
  static auto parameters() { return hardening_parameters<JohnsonCookFlow>(); }
};

struct CurvesFlow : J2<Curves> {
  static constexpr char const* name = "j2";
  static constexpr char const* sentence = "J2 with a yield stress that is a number, a table or a function";
  static std::array<Parameter<CurvesFlow>, 0> parameters() { return {}; }
};

}  // namespace fissure::laws
