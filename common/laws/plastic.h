// From the motion of a step to the stress of a material that flows. All in Kirchhoff stress tau = J sigma: the stored
// energy tau : C^-1 : tau / 2 is then a function of the stress alone, so the balance of energy closes without an error
// of the volume.
//   jaumann      tau' = q (q tau q^T + C : sym G) q^T,   q q = (I - W/2)^-1 (I + W/2),  W = skew G (Hughes & Winget
//                1980, but for sym G, whose axes are those of the middle of the step and turn by the half that is left)
//   logarithmic  b' = f exp(2 C^-1 : tau) f^T,  f = (I - G/2)^-1 (I + G/2),  tau' = C : ln(b')/2
//                (Simo 1992): no rate, cycles close
// G: displacement increment by the coordinates of the middle of the step. For a rigid turn of any size G is skew and
// its Cayley transform is that turn, so both are exact for it.
#pragma once
#include <limits>
#include <tuple>

#include "base/elementary.h"
#include "base/spectral.h"
#include "laws/drucker_prager.h"
#include "laws/j2.h"

namespace fissure::laws {

/// One of several laws, chosen at run time the same for all lanes: what a variant is on the host, inside a kernel.
template <class... Laws>
struct OneOf {
  std::tuple<Laws...> laws;
  int which = 0;

  template <class F>
  FISSURE_HD void visit(F&& f) const {
    visit(f, std::make_index_sequence<sizeof...(Laws)>{});
  }

 private:
  template <class F, std::size_t... I>
  FISSURE_HD void visit(F& f, std::index_sequence<I...>) const {
    static_cast<void>(((which == static_cast<int>(I) && (f(std::get<I>(laws)), true)) || ...));
  }
};

/// Every flow law. A new one is one file and one word here.
template <template <class...> class List>
using FlowLaws = List<CurvesFlow, JohnsonCookFlow, DruckerPrager>;

/// Adiabatic heating: capacity [J/(kg K)], share of the plastic work that becomes heat (Taylor & Quinney 1934),
/// temperature at the start, and that from which strength softens [K].
struct Heat {
  double capacity = 0, share = 0.9, start = 293.15, reference = start;
  bool on() const { return capacity > 0; }
};

/// What an element with such a material remembers, in this order; numbers that its law does not need do not exist.
struct Memory {
  int stresses = 6;  // tau: xx yy zz xy (yz zx)
  int back = -1, strain = -1, rate = -1, rise = -1, thickness = -1;
  int numbers = 0;
};

/// A law's share of a kernel.
struct Plastic : ElasticConstants {
  static constexpr bool remembers = true;
  FlowLaws<OneOf> flow;
  Memory memory;
  bool logarithmic = false, bisection = false, plane_stress = false;
  bool frozen = false;  // the elastic trial only: no flow, and nothing is remembered
  double heating = 0;   // share / (density capacity) [K m^3/J]; 0: none

  /// One step of `law`, one of those in `flow`: `point` as it was becomes what it is. G as above; j = J - 1 (in the
  /// plane, for plane stress); thickness: strain out of the plane, plane stress only. Returns what flow took per
  /// reference volume [J/m^3].
  template <class S, class Law>
  FISSURE_HD S step(Law const& law, FlowPoint<S, Law::has_back>& point, Mat<S, 3> const& G, S const& j, S& thickness,
                    double per_time) const {
    if (!plane_stress) return solid(law, point, G, j, per_time);
    return thin(law, point, G, j, thickness, per_time);
  }

  /// Stored energy per reference volume [J/m^3], and that of the change of shape alone.
  template <class S>
  FISSURE_HD S energy(Mat<S, 3> const& tau) const {
    S const trace = tau.trace();
    return shape_energy(tau) + trace * trace * as<S>(1 / (18 * bulk()));
  }
  template <class S>
  FISSURE_HD S shape_energy(Mat<S, 3> const& tau) const {
    return deviator(tau).squaredNorm() * as<S>(1 / (4 * shear()));
  }

  /// Spring that holds an element's ratio of volumes to those of the patches at it, where pressure is averaged [Pa]:
  /// soft beside G, so that nothing locks, and no softer than most yield stresses, so that flow crushes no element.
  FISSURE_HD double patch_spring() const { return shear() / 50; }

 private:
  template <class S>
  FISSURE_HD static Mat<S, 3> inverse(Mat<S, 3> const& m) {
    Mat<S, 3> c;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) {
        int const a = (i + 1) % 3, b = (i + 2) % 3, d = (k + 1) % 3, e = (k + 2) % 3;
        c(k, i) = m(a, d) * m(b, e) - m(a, e) * m(b, d);
      }
    return c * (S(1) / (m(0, 0) * c(0, 0) + m(0, 1) * c(1, 0) + m(0, 2) * c(2, 0)));
  }

  /// Half the turn of a step: q with q q = (I - W/2)^-1 (I + W/2), W = skew G. The tangent of half the turn is |w|/2, w
  /// the axis of W, its cosine 1/r:  q = I + W/(2 r) + W^2/(4 r (1 + r)),  r = (1 + w.w/4)^(1/2).
  template <class S>
  FISSURE_HD static Mat<S, 3> half_turn(Mat<S, 3> const& G) {
    S const half = as<S>(0.5), x = half * (G(2, 1) - G(1, 2)), y = half * (G(0, 2) - G(2, 0)),
            z = half * (G(1, 0) - G(0, 1));
    S const r = root(S(1) + as<S>(0.25) * (x * x + y * y + z * z)), b = as<S>(0.25) / (r * (S(1) + r)),
            a = as<S>(2) * b * (S(1) + r);
    Mat<S, 3> q;
    q(0, 0) = S(1) - b * (y * y + z * z), q(1, 1) = S(1) - b * (z * z + x * x), q(2, 2) = S(1) - b * (x * x + y * y);
    q(0, 1) = b * x * y - a * z, q(1, 0) = b * x * y + a * z;
    q(1, 2) = b * y * z - a * x, q(2, 1) = b * y * z + a * x;
    q(2, 0) = b * z * x - a * y, q(0, 2) = b * z * x + a * y;
    return q;
  }

  /// q a q^T of a symmetric a.
  template <class S>
  FISSURE_HD static Mat<S, 3> turned(Mat<S, 3> const& q, Mat<S, 3> const& a) {
    Mat<S, 3> const half = q.lazyProduct(a);
    Mat<S, 3> t;
    FISSURE_UNROLL
    for (int i = 0; i < 3; ++i) {
      FISSURE_UNROLL
      for (int k = 0; k <= i; ++k)
        t(i, k) = t(k, i) = half(i, 0) * q(k, 0) + half(i, 1) * q(k, 1) + half(i, 2) * q(k, 2);
    }
    return t;
  }

  template <class S>
  FISSURE_HD Mat<S, 3> hooke(Mat<S, 3> const& strain) const {
    Mat<S, 3> stress = as<S>(2 * shear()) * strain;
    S const volume = as<S>(lame()) * strain.trace();
    for (int i = 0; i < 3; ++i) stress(i, i) += volume;
    return stress;
  }
  template <class S>
  FISSURE_HD Mat<S, 3> compliance(Mat<S, 3> const& stress) const {
    Mat<S, 3> strain = as<S>(1 / (2 * shear())) * stress;
    S const volume = stress.trace() * as<S>(poisson / young);
    for (int i = 0; i < 3; ++i) strain(i, i) -= volume;
    return strain;
  }

  /// What is too far from nothing for the series of `exp_twice_less_one` and `half_log_of_one_and`, whose last term is
  /// then a digit.
  template <class S>
  FISSURE_HD static auto large(Mat<S, 3> const& m) {
    return m.squaredNorm() > as<S>(0.01);
  }
  template <class S, class Mask>
  FISSURE_HD static Mat<S, 3> select_all(Mask const& mask, Mat<S, 3> const& a, Mat<S, 3> const& b) {
    Mat<S, 3> m;
    for (int i = 0; i < 9; ++i) m(i % 3, i / 3) = select(mask, a(i % 3, i / 3), b(i % 3, i / 3));
    return m;
  }

  /// exp(2 e) - I of a symmetric e: 2 T (I - T)^-1 with T = tanh e as a series where e is small, by eigenvalues
  /// elsewhere.
  template <class S>
  FISSURE_HD static Mat<S, 3> exp_twice_less_one(Mat<S, 3> const& e) {
    Mat<S, 3> const square = e.lazyProduct(e), one = Mat<S, 3>::Identity();
    Mat<S, 3> sum = as<S>(-1382.0 / 155925) * square + as<S>(62.0 / 2835) * one;
    for (double const term : {-17.0 / 315, 2.0 / 15, -1.0 / 3, 1.0}) {
      Mat<S, 3> const next = square.lazyProduct(sum);
      sum = next + as<S>(term) * one;
    }
    Mat<S, 3> const T = e.lazyProduct(sum), result = (T + T).lazyProduct(inverse<S>(one - T));
    if (!any_lane(large<S>(e))) return result;
    return select_all<S>(large<S>(e), spectral(e, [](S const& x) { return S(exp_of(S(x + x)) - S(1)); }), result);
  }

  /// ln(I + a)/2 = artanh Z, Z = a (a + 2 I)^-1, as a series where Z is small, by eigenvalues elsewhere.
  template <class S>
  FISSURE_HD static Mat<S, 3> half_log_of_one_and(Mat<S, 3> const& a) {
    Mat<S, 3> const one = Mat<S, 3>::Identity();
    Mat<S, 3> const Z = a.lazyProduct(inverse<S>(a + one + one)), square = Z.lazyProduct(Z);
    Mat<S, 3> sum = as<S>(1.0 / 13) * one;
    for (int k = 11; k > 0; k -= 2) {
      Mat<S, 3> const next = square.lazyProduct(sum);
      sum = next + as<S>(1.0 / k) * one;
    }
    Mat<S, 3> const half = Z.lazyProduct(sum), result = as<S>(0.5) * (half + half.transpose());
    if (!any_lane(large<S>(Z))) return result;
    return select_all<S>(large<S>(Z), spectral(a, [](S const& x) { return S(as<S>(0.5) * log_of(S(S(1) + x))); }),
                         result);
  }

  template <class S, class Law>
  FISSURE_HD S solid(Law const& law, FlowPoint<S, Law::has_back>& point, Mat<S, 3> const& G, S const& j,
                     double per_time) const {
    Mat<S, 3> const strain = as<S>(0.5) * (G + G.transpose()), q = half_turn(G);
    if constexpr (Law::has_back) point.back = turned<S>(q, turned<S>(q, point.back));
    if (logarithmic) {
      // The change of volume is taken apart: what is left is small. With h = (I - G/2)^-1 the step's gradient is f = h
      // (I + G/2), and what f f^T has beyond I is h (G + G^T) h^T, in which no turn cancels.
      S const mean = point.stress.trace() * as<S>(1 / (9 * bulk()));
      Mat<S, 3> const one = Mat<S, 3>::Identity(), h = inverse<S>(one - as<S>(0.5) * G), f = one + h.lazyProduct(G);
      Mat<S, 3> const a = exp_twice_less_one<S>(as<S>(1 / (2 * shear())) * deviator(point.stress)),
                      grown = turned<S>(h, G + G.transpose());
      Mat<S, 3> e = half_log_of_one_and<S>(turned<S>(f, a) + grown);
      for (int i = 0; i < 3; ++i) e(i, i) += mean;
      point.stress = hooke(e);
    } else {
      point.stress = turned<S>(q, turned<S>(q, point.stress) + hooke(strain));
    }
    if (frozen) return S(0);
    Mat<S, 3> const trial = point.stress;
    law.flow(*this, FlowStep<S>{S(1) + j, as<S>(per_time), bisection}, point);
    if (!any_lane(point.rate > S(0))) return S(0);
    // Mean of the stresses before and after, times the plastic strain: what leapfrog's work leaves over.
    Mat<S, 3> const before = trial - turned<S>(q, hooke(strain)), flowed = compliance<S>(trial - point.stress);
    S const dissipated =
        select(point.rate > S(0), as<S>(0.5) * (before + point.stress).cwiseProduct(flowed).sum(), S(0));
    if (heating > 0) point.rise += as<S>(heating) * positive(dissipated);
    return dissipated;
  }

  /// Plane stress: the increment out of the plane that leaves no stress there, by the secant method.
  template <class S, class Law>
  FISSURE_HD S thin(Law const& law, FlowPoint<S, Law::has_back>& point, Mat<S, 3> G, S const& j, S& thickness,
                    double per_time) const {
    auto const start = point;
    S const was = thickness;
    auto const with = [&](S const& g) {
      G(2, 2) = g;
      thickness = was + (S(1) + was) * g / (S(1) - as<S>(0.5) * g);
      point = start;
      return solid(law, point, G, S(j + thickness + j * thickness), per_time);
    };
    S const in_plane = G(0, 0) + G(1, 1);
    S g0 = as<S>(-poisson / (1 - poisson)) * in_plane, slope = as<S>(confined());
    S dissipated = with(g0);
    S r0 = point.stress(2, 2), g = g0 - r0 / slope;
    S const enough = as<S>(sizeof(ScalarOf<S>) == 8 ? 1e-12 : 1e-6) *
                     (root(G.squaredNorm()) + root(start.stress.squaredNorm()) * as<S>(1 / young));
    for (int i = 0; i < 40; ++i) {
      S const step = g - g0;
      auto const moved = larger(step, -step) > enough;
      if (!any_lane(moved)) break;
      dissipated = with(select(moved, g, g0));
      S const r = point.stress(2, 2), secant = (r - r0) / select(moved, step, S(1));
      // Between the incompressible flow's slope and the elastic one; outside is noise.
      slope = select(moved, larger(as<S>(0.01 * confined()), smaller(as<S>(confined()), secant)), slope);
      g0 = select(moved, g, g0);
      r0 = r;
      g = g0 - r0 / slope;
    }
    // What is left is the noise of the return mapping; more has not converged, is no number and stops the run.
    S const step = g - g0;
    point.strain = select(larger(step, -step) > as<S>(1e5) * enough, as<S>(std::numeric_limits<double>::quiet_NaN()),
                          point.strain);
    for (int i = 0; i < 3; ++i) point.stress(i, 2) = point.stress(2, i) = S(0);
    return dissipated;
  }
};

}  // namespace fissure::laws
