// Every flow law of laws/plastic.h held to what any must do, and each to its own closed forms (verification, section
// E).
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <functional>
#include <random>

#include "laws/laws.h"

namespace fissure::laws {
namespace {

using M3 = Mat<double, 3>;
constexpr double MPa = 1e6, degree = 3.14159265358979323846 / 180;

TEST(Elementary, LogAndExpAreRightToTheirLastDigits) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> x(-690, 690);
  for (int i = 0; i < 20000; ++i) {
    double const e = x(random);
    // exp magnifies the rounding of its argument: |e| units in the last place.
    EXPECT_NEAR(exp_of(e) / std::exp(e), 1, 3e-16 * (2 + std::abs(e) / 4)) << e;
    double const y = std::exp(e / 3);
    EXPECT_NEAR(log_of(y), std::log(y), 4e-16 * (1 + std::abs(e / 3))) << y;
    float const f = static_cast<float>(e / 10);
    EXPECT_NEAR(exp_of(f) / std::exp(f), 1, 3e-7 * (2 + std::abs(f) / 4)) << f;
    EXPECT_NEAR(log_of(std::exp(f)), f, 3e-7 * (1 + std::abs(f))) << f;
  }
  EXPECT_EQ(log_of(1.0), 0);
  EXPECT_EQ(exp_of(0.0), 1);
  EXPECT_NEAR(log_of(1 + 1e-10), std::log1p(1e-10), 1e-16);
  EXPECT_TRUE(std::isfinite(exp_of(1e9)));
}

TEST(Elementary, APackIsItsScalars) {
  using P = Pack<double>;
  P x = generate<P>([](int l) { return 0.3 + 1.7 * l; });
  for (int l = 0; l < lane_width<P>; ++l) {
    EXPECT_EQ(lane(log_of(x), l), log_of(lane(x, l)));
    EXPECT_EQ(lane(exp_of(x), l), exp_of(lane(x, l)));
  }
}

/// 42CrMo4 (paper table 1).
JohnsonCookFlow steel() {
  JohnsonCookFlow law;
  law.A = 806 * MPa, law.B = 614 * MPa, law.n = 0.168, law.C = 0.0089, law.rate0 = 1, law.melting = 1813;
  return law;
}

TEST(JohnsonCookCurve, HasTheStressesOfThePage) {
  auto const law = steel();
  struct Row {
    double strain, stress[3];
  };
  for (auto const& [strain, stress] :
       {Row{0, {806.000, 855.552, 888.587}}, Row{0.01, {1089.249, 1156.215, 1200.859}},
        Row{0.1, {1223.031, 1298.222, 1348.349}}, Row{1, {1420.000, 1507.300, 1565.500}}}) {
    double const rates[3] = {1, 1e3, 1e5};
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(law.yield(strain, rates[k], 0.0).stress / MPa, stress[k], 1e-6 * stress[k] + 5e-4)
          << strain << ' ' << rates[k];
    // slower than the reference: no effect
    EXPECT_EQ(law.yield(strain, 0.01, 0.0).stress, law.yield(strain, 1.0, 0.0).stress);
  }
}

template <class Hardening>
void expect_slopes(Hardening const& law, double strain, double rate, double rise) {
  auto const y = law.yield(strain, rate, rise);
  double const de = 1e-6 * (strain + 1e-9), dr = 1e-6 * rate;
  double const by_strain =
      (law.yield(strain + de, rate, rise).stress - law.yield(strain - de, rate, rise).stress) / (2 * de);
  double const by_rate =
      (law.yield(strain, rate + dr, rise).stress - law.yield(strain, rate - dr, rise).stress) / (2 * dr);
  EXPECT_NEAR(y.per_strain, by_strain, 1e-4 * std::abs(by_strain) + 1) << strain;
  EXPECT_NEAR(y.per_rate, by_rate, 1e-4 * std::abs(by_rate) + 1e-3) << rate;
}

// strains, ln rates, stresses
std::vector<double> const table{0, 0.1, 0.5, std::log(1e-2), std::log(1e2), 300e6, 400e6, 450e6, 330e6, 430e6, 480e6};
Curves curves(std::vector<double> const& numbers, int strains, int rates, double beyond = 0) {
  Curves c;
  c.numbers = numbers.data(), c.strains = strains, c.rates = rates, c.beyond = beyond;
  return c;
}

TEST(Hardening, GivesItsSlopes) {
  auto hot = steel();
  hot.m = 1.1, hot.melting_rise = 1520;
  for (double strain : {3e-7, 1e-3, 0.2}) expect_slopes(hot, strain, 50.0, 200.0);
  for (double strain : {0.05, 0.3, 0.7}) expect_slopes(curves(table, 3, 2, 1e8), strain, 1.0, 0.0);
}

TEST(CurvesTable, IsStraightBetweenItsPointsAndInTheLogarithmOfTheRate) {
  auto const c = curves(table, 3, 2, 1e8);
  EXPECT_NEAR(c.yield(0.05, 1e-3, 0.0).stress, 350e6, 1);
  EXPECT_NEAR(c.yield(0.3, 1e5, 0.0).stress, 455e6, 1);
  EXPECT_NEAR(c.yield(0.3, 1.0, 0.0).stress, 440e6, 1);   // half way between 1e-2 and 1e2
  EXPECT_NEAR(c.yield(0.7, 1e-3, 0.0).stress, 470e6, 1);  // beyond the last strain
}

/// A law of each kind with hardening, and where its numbers live.
template <class Law>
struct Given {
  static inline std::vector<double> const numbers{0, 0.02, std::log(1.0), std::log(1e4), 50e6, 60e6, 55e6, 65e6};
  static Plastic law(bool logarithmic = false) {
    Plastic p;
    p.young = 30e9, p.poisson = 0.3, p.logarithmic = logarithmic;
    Law law;
    if constexpr (std::is_base_of_v<Curves, Law>) static_cast<Curves&>(law) = curves(numbers, 2, 2, 100e6);
    if constexpr (std::is_same_v<Law, JohnsonCookFlow>) law = steel(), law.A = 50e6, law.B = 60e6, law.n = 0.3;
    if constexpr (std::is_same_v<Law, DruckerPrager>)
      law.friction_angle = 0.5, law.dilation_angle = 0.3, law.beta = 0.6;
    std::get<Law>(p.flow.laws) = law;
    p.flow.which = static_cast<int>(AnyFlow(law).index());
    return p;
  }
};

/// A point of any law, and one step of the law that `plastic` has chosen.
template <class S>
using Point = FlowPoint<S, true>;
template <class S>
struct Stepped {
  Point<S> point;
  S thickness, dissipated;
};
template <class S>
Stepped<S> step(Plastic const& plastic, Point<S> const& start, Mat<S, 3> const& G, S j, S thickness, double per_time) {
  Stepped<S> result{start, thickness, S(0)};
  plastic.flow.visit([&]<class Law>(Law const& law) {
    FlowPoint<S, Law::has_back> point{start.stress, start.strain, start.rate, start.rise, {}};
    if constexpr (Law::has_back) point.back = start.back;
    result.dissipated = plastic.step(law, point, G, j, result.thickness, per_time);
    result.point.stress = point.stress, result.point.strain = point.strain, result.point.rate = point.rate,
    result.point.rise = point.rise;
    if constexpr (Law::has_back) result.point.back = point.back;
  });
  return result;
}

Point<double> rest() { return {M3::Zero(), 0, 0, 0, M3::Zero()}; }

M3 some(int seed, double size) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> x(-size, size);
  M3 G;
  for (int i = 0; i < 9; ++i) G(i / 3, i % 3) = x(random);
  return G;
}
M3 rotation(double angle, Vec3 const& axis) { return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(); }
/// Increment by the middle of the step that turns the deformation gradient F0 into F1.
M3 increment(M3 const& F0, M3 const& F1) { return (F1 - F0) * (0.5 * (F0 + F1)).inverse(); }

/// Follows F(t), t in [0, 1], in n equal steps of a time of 1 s.
struct Path {
  Plastic law;
  Point<double> point = rest();
  double j = 0, thickness = 0, dissipated = 0, work = 0, least = 0;

  void follow(std::function<M3(double)> const& F, int n, double time = 1) {
    for (int i = 0; i < n; ++i) {
      M3 const before = F(double(i) / n), after = F(double(i + 1) / n), G = increment(before, after);
      j = after.determinant() - 1;
      auto const result = step(law, point, G, j, thickness, n / time);
      // As leapfrog works: half with the forces before, half with those after, each by the coordinates of its moment.
      M3 const move = after - before;
      work += 0.5 * (point.stress.cwiseProduct(move * before.inverse()) +
                     result.point.stress.cwiseProduct(move * after.inverse()))
                        .sum();
      dissipated += result.dissipated;
      least = std::min(least, result.dissipated);
      point = result.point;
      thickness = result.thickness;
    }
  }
};

template <class Law>
struct Flowing : ::testing::Test {};
template <class... Laws>
using AsTypes = ::testing::Types<Laws...>;
TYPED_TEST_SUITE(Flowing, FlowLaws<AsTypes>);

TYPED_TEST(Flowing, IsZeroAtRest) {
  for (bool logarithmic : {false, true}) {
    auto const result = step(Given<TypeParam>::law(logarithmic), rest(), M3(M3::Zero()), 0.0, 0.0, 1e6);
    EXPECT_EQ(result.point.stress.norm(), 0);
    EXPECT_EQ(result.point.strain, 0);
    EXPECT_EQ(result.dissipated, 0);
  }
}

TYPED_TEST(Flowing, IsElasticBelowYieldWithTheWaveModulus) {
  for (bool logarithmic : {false, true}) {
    auto const law = Given<TypeParam>::law(logarithmic);
    M3 G = M3::Zero();
    G(0, 0) = 1e-7;
    auto const result = step(law, rest(), G, 1e-7, 0.0, 1e6);
    EXPECT_NEAR(result.point.stress(0, 0) / 1e-7 / law.confined(), 1, 1e-6);
    EXPECT_NEAR(result.point.stress(1, 1) / 1e-7 / law.lame(), 1, 1e-6);
    EXPECT_EQ(result.point.strain, 0);
    EXPECT_NEAR(law.energy(result.point.stress) / (0.5 * law.confined() * 1e-14), 1, 1e-6);
  }
}

TYPED_TEST(Flowing, TurnsWithTheBodyHoweverFar) {
  // Deform and flow, then turn by 100 degrees in one step: the stress turns, nothing else happens.
  for (bool logarithmic : {false, true}) {
    Path path{Given<TypeParam>::law(logarithmic)};
    M3 const A = some(1, 0.01);
    path.follow([&](double t) { return M3(M3::Identity() + t * A); }, 50);
    ASSERT_GT(path.point.strain, 1e-4);
    auto const before = path.point;
    M3 const Q = rotation(100 * degree, {1, 2, -0.5}), F = M3::Identity() + A;
    auto const after = step(path.law, before, increment(F, Q * F), path.j, 0.0, 1.0).point;
    // The law may see stress on its surface as a hair outside of it.
    EXPECT_LT((after.stress - Q * before.stress * Q.transpose()).norm(), 1e-11 * before.stress.norm());
    EXPECT_LT((after.back - Q * before.back * Q.transpose()).norm(), 1e-11 * before.stress.norm());
    EXPECT_NEAR(after.strain, before.strain, 1e-12);
  }
}

TYPED_TEST(Flowing, BooksItsWork) {
  // What leapfrog's forces do is what the stored energy gains and what flow takes, to the second order of the step,
  // also where the body turns while it deforms.
  for (bool logarithmic : {false, true})
    for (double turns : {0.0, 1.0}) {
      double error[2];
      for (int k : {0, 1}) {
        Path path{Given<TypeParam>::law(logarithmic)};
        M3 const A = some(2, 0.02);
        auto const at = [&](double t) {
          return M3(rotation(2 * std::numbers::pi * turns * t, {1, 2, -0.5}) * (M3::Identity() + std::sin(2 * t) * A));
        };
        path.follow(at, k ? 8000 : 2000);
        double const stored = path.law.energy(path.point.stress);
        error[k] = std::abs(path.work - stored - path.dissipated) / path.work;
        EXPECT_GE(path.least, -1e-6 * path.dissipated);
      }
      std::printf("%s, %g turns: %.1e and %.1e in 4 times the steps\n", logarithmic ? "logarithmic" : "Jaumann", turns,
                  error[0], error[1]);
      EXPECT_LT(error[1], 1e-4) << logarithmic << turns;
      EXPECT_LT(error[1], 0.1 * error[0] + 1e-12) << logarithmic << turns;
    }
}

TYPED_TEST(Flowing, StaysOnItsYieldSurface) {
  for (bool logarithmic : {false, true})
    for (int seed = 0; seed < 20; ++seed) {
      auto const law = Given<TypeParam>::law(logarithmic);
      M3 const G = some(seed, 0.02);
      double const j = 0.01 * seed - 0.1;
      auto const point = step(law, rest(), G, j, 0.0, 1e3).point;
      if (point.strain == 0) continue;
      auto const& flow = std::get<TypeParam>(law.flow.laws);
      bool const tip = (deviator(point.stress) - point.back).norm() < 1e-6 * point.stress.norm();
      EXPECT_NEAR(flow.yield_ratio(point, 1 + j), 1, 1e-9) << seed << (tip ? " at the tip" : "");
    }
}

TYPED_TEST(Flowing, NewtonFindsWhatBisectionFinds) {
  for (int seed = 0; seed < 50; ++seed)
    for (double per_time : {1.0, 1e5, 1e8}) {
      auto law = Given<TypeParam>::law();
      Point<double> start = rest();
      start.strain = seed % 3 * 1e-4;
      M3 const G = some(seed, std::pow(10.0, -1 - seed % 4));
      auto const newton = step(law, start, G, 0.0, 0.0, per_time).point;
      law.bisection = true;
      auto const halved = step(law, start, G, 0.0, 0.0, per_time).point;
      EXPECT_NEAR(newton.strain, halved.strain, 1e-10 * (halved.strain + 50e6 / law.young)) << seed;
      EXPECT_LT((newton.stress - halved.stress).norm(), 1e-10 * (halved.stress.norm() + 50e6)) << seed;
    }
}

TYPED_TEST(Flowing, APackIsItsScalars) {
  using P = Pack<double>;
  for (bool logarithmic : {false, true}) {
    auto const law = Given<TypeParam>::law(logarithmic);
    Mat<P, 3> G, zero = Mat<P, 3>::Constant(P(0));
    std::array<M3, lane_width<P>> lanes;
    for (int l = 0; l < lane_width<P>; ++l) {
      lanes[l] = some(l, l % 2 ? 0.01 : 1e-5);  // some flow, some do not
      for (int i = 0; i < 9; ++i) set_lane(G(i / 3, i % 3), l, lanes[l](i / 3, i % 3));
    }
    auto const packed = step(law, Point<P>{zero, P(0), P(0), P(0), zero}, G, P(0.001), P(0), 1e4);
    for (int l = 0; l < lane_width<P>; ++l) {
      auto const alone = step(law, rest(), lanes[l], 0.001, 0.0, 1e4);
      for (int i = 0; i < 9; ++i)  // a lane may be iterated once more than it needs
        EXPECT_NEAR(lane(packed.point.stress(i / 3, i % 3), l), alone.point.stress(i / 3, i % 3),
                    1e-9 * alone.point.stress.norm())
            << l;
      EXPECT_NEAR(lane(packed.point.strain, l), alone.point.strain, 1e-12) << l;
    }
  }
}

TYPED_TEST(Flowing, LeavesALaneThatDoesNotFlowAlone) {
  // Its stress is the trial to the last bit and no work is taken from it, whatever flows beside it.
  using P = Pack<double>;
  if (lane_width<P> == 1) GTEST_SKIP() << "packs of one lane";
  auto const law = Given<TypeParam>::law();
  int at_rest = 0;
  for (int seed = 0; seed < 50; ++seed) {
    Mat<P, 3> G, zero = Mat<P, 3>::Constant(P(0));
    std::array<M3, lane_width<P>> lanes;
    for (int l = 0; l < lane_width<P>; ++l) {
      lanes[l] = some(100 * seed + l, l % 2 ? 0.01 : 3e-4);
      for (int i = 0; i < 9; ++i) set_lane(G(i / 3, i % 3), l, lanes[l](i / 3, i % 3));
    }
    auto const packed = step(law, Point<P>{zero, P(0), P(0), P(0), zero}, G, P(0.001), P(0), 1e4);
    for (int l = 0; l < lane_width<P>; ++l) {
      auto const alone = step(law, rest(), lanes[l], 0.001, 0.0, 1e4);
      if (alone.point.strain > 0) continue;
      ++at_rest;
      EXPECT_EQ(lane(packed.dissipated, l), 0) << seed << ' ' << l;
      for (int i = 0; i < 9; ++i)
        EXPECT_EQ(lane(packed.point.stress(i / 3, i % 3), l), alone.point.stress(i / 3, i % 3)) << seed << ' ' << l;
    }
  }
  EXPECT_GE(at_rest, 50);  // of two lanes one is at rest
}

TYPED_TEST(Flowing, SinglePrecisionAgreesWithDouble) {
  for (bool logarithmic : {false, true}) {
    auto const law = Given<TypeParam>::law(logarithmic);
    M3 const G = some(4, 0.01);
    Mat<float, 3> const zero = Mat<float, 3>::Zero();
    auto const exact = step(law, rest(), G, 0.0, 0.0, 1e4);
    auto const rough = step(law, Point<float>{zero, 0, 0, 0, zero}, Mat<float, 3>(G.cast<float>()), 0.f, 0.f, 1e4);
    ASSERT_GT(exact.point.strain, 1e-4);
    // The trial stress is some ten times the yield stress, and keeps seven digits.
    EXPECT_LT((rough.point.stress.template cast<double>() - exact.point.stress).norm(),
              1e-4 * exact.point.stress.norm());
    EXPECT_NEAR(rough.point.strain, exact.point.strain, 1e-4 * exact.point.strain);
  }
}

/// Pulls a bar along x by `strain` in n steps and lets its sides go where they carry nothing (one or two of them).
struct Bar {
  Path path;
  M3 F = M3::Identity();
  double pressure = 0;  // on its sides [Pa]

  void pull(double strain, int n) {
    double const from = F(0, 0);
    for (int i = 1; i <= n; ++i) advance(from + (1 + strain - from) * i / n, n);
  }
  double stress() const { return path.point.stress(0, 0) / (F.determinant() * (1 + path.thickness)); }

 private:
  void advance(double stretch, int n) {
    bool const thin = path.law.plane_stress;
    double y[2] = {0, -0.3 * (stretch - F(0, 0))}, r[2];
    for (int k = 0; k < 60; ++k) {
      M3 next = F;
      next(0, 0) = stretch;
      next(1, 1) += y[k == 0 ? 0 : 1];
      if (!thin) next(2, 2) = next(1, 1);
      double const j = next.determinant() - 1;
      auto const result = step(path.law, path.point, increment(F, next), j, path.thickness, double(n));
      r[k == 0 ? 0 : 1] = result.point.stress(1, 1) + pressure * next.determinant();
      if (k > 0 && (std::abs(r[1]) < 1e-2 || k == 59)) {
        EXPECT_LT(std::abs(r[1]), 1e2);
        path.point = result.point, path.thickness = result.thickness, path.dissipated += result.dissipated;
        F = next;
        return;
      }
      if (k > 0) {
        double const to = y[1] - r[1] * (y[1] - y[0]) / (r[1] - r[0]);
        y[0] = y[1], r[0] = r[1], y[1] = to;
      }
    }
  }
};

TYPED_TEST(Flowing, PlaneStressIsABarWhoseThicknessIsFree) {
  for (bool logarithmic : {false, true}) {
    Bar thin{{Given<TypeParam>::law(logarithmic)}}, bar = thin;
    thin.path.law.plane_stress = true;
    thin.pull(0.01, 100);
    bar.pull(0.01, 100);
    ASSERT_GT(bar.path.point.strain, 1e-3);
    EXPECT_NEAR(thin.stress() / bar.stress(), 1, 1e-8);
    EXPECT_NEAR(thin.path.thickness, bar.F(2, 2) - 1, 1e-10);
    EXPECT_LT(std::abs(thin.path.point.stress(2, 2)), 1e-9 * bar.stress());
  }
}

/// Without a change of area or a stress to measure by, as pure shear and turning begin.
TYPED_TEST(Flowing, PlaneStressShearsAndTurns) {
  auto const turn = [](double angle) {
    M3 Q = M3::Identity();
    Q.topLeftCorner<2, 2>() << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    return Q;
  };
  for (bool logarithmic : {false, true})
    for (double angle : {0.0, 0.645, 2.0}) {
      Path sheared{Given<TypeParam>::law(logarithmic)}, turned = sheared;
      sheared.law.plane_stress = turned.law.plane_stress = true;
      sheared.follow(
          [&](double t) {
            M3 F = M3::Identity();
            F(0, 1) = 1e-4 * t;
            return M3(turn(angle) * F * turn(-angle));
          },
          20);
      double const shear = 1e-4 * sheared.law.shear();
      // of first order in strain
      EXPECT_NEAR(sheared.point.stress.norm() / (std::sqrt(2.0) * shear), 1, 1e-3) << angle;
      EXPECT_LT(std::abs(sheared.point.stress(2, 2)), 1e-6 * shear) << angle;
      turned.follow([&](double t) { return turn((1 + angle) * t); }, 200);
      EXPECT_LT(turned.point.stress.norm(), 1e-9 * turned.law.young) << angle;
    }
}

TEST(LogarithmicStrain, ClosesElasticCyclesAndTheJaumannRateDoesNot) {
  // Simple shear to 0.02 and a stretch by as much, around a closed square, without flow.
  double left[2];
  for (bool logarithmic : {false, true}) {
    Path path{Given<CurvesFlow>::law(logarithmic)};
    static std::vector<double> const strong{0, 0, 1e15};
    std::get<CurvesFlow>(path.law.flow.laws).numbers = strong.data();
    std::get<CurvesFlow>(path.law.flow.laws).strains = std::get<CurvesFlow>(path.law.flow.laws).rates = 1;
    auto const corner = [](double shear, double stretch) {
      M3 F = M3::Identity();
      F(0, 1) = shear, F(1, 1) = 1 + stretch;
      return F;
    };
    M3 const corners[5] = {corner(0, 0), corner(0.02, 0), corner(0.02, 0.02), corner(0, 0.02), corner(0, 0)};
    for (int side = 0; side < 4; ++side)
      path.follow([&](double t) { return M3((1 - t) * corners[side] + t * corners[side + 1]); }, 200);
    left[logarithmic] = path.point.stress.norm() / (30e9 * 0.02);
  }
  EXPECT_LT(left[1], 1e-10);
  EXPECT_GT(left[0], 1e-5);  // of the order of the strain squared
}

TEST(LogarithmicStrain, IsTheLogarithmOfStretchHoweverLarge) {
  // Without flow stress is C : ln(F F^T)/2 wherever the motion led, and no error grows with the number of steps.
  static std::vector<double> const strong{0, 0, 1e15};
  for (double size : {0.05, 0.3, 1.0, 3.0})
    for (int steps : {50, 5000}) {
      Path path{Given<CurvesFlow>::law(true)};
      auto& curve = std::get<CurvesFlow>(path.law.flow.laws);
      curve.numbers = strong.data(), curve.strains = curve.rates = 1;
      M3 last = M3::Identity();
      for (auto const& H : {Eigen::Vector3d(1, 0.3, 0), Eigen::Vector3d(-0.1, 0, 1), Eigen::Vector3d(0.2, 1, 0.4)}) {
        M3 next = M3::Identity();
        next(0, 1) = size * H[0], next(1, 1) = 1 + size * H[1], next(2, 2) = 1 / (1 + size * H[2]),
                next(1, 2) = size * H[2];
        path.follow([&](double t) { return M3((1 - t) * last + t * next); }, steps);
        last = next;
      }
      Eigen::SelfAdjointEigenSolver<M3> const b(last * last.transpose());
      M3 const e =
          b.eigenvectors() * (0.5 * b.eigenvalues().array().log()).matrix().asDiagonal() * b.eigenvectors().transpose();
      M3 const expected = 2 * path.law.shear() * e + path.law.lame() * e.trace() * M3::Identity();
      EXPECT_LT((path.point.stress - expected).norm(), 1e-10 * expected.norm()) << size << " " << steps;
    }
}

TEST(LogarithmicStrain, HasItsDigitsInSinglePrecision) {
  // A small strain while the body turns, slowly and fast: each step may round a digit of the stress and of its motion,
  // not of 1; roundings of the motion, which are as large as the turn of a step, add up like a random walk.
  static std::vector<double> const strong{0, 0, 1e15};
  Plastic law = Given<CurvesFlow>::law(true);
  auto& curve = std::get<CurvesFlow>(law.flow.laws);
  curve.numbers = strong.data(), curve.strains = curve.rates = 1;
  struct Turn {
    double angle, size;
    int steps;
  };
  for (Turn const& of : {Turn{1, 1e-5, 1000}, Turn{30, 1e-4, 100}}) {
    double const angle = of.angle, size = of.size;
    int const steps = of.steps;
    M3 const strain = size * (M3() << 1, 0.2, 0, 0.2, -0.4, 0.1, 0, 0.1, 0.5).finished();
    auto const F = [&](double t) { return M3(rotation(angle * t, {1, 2, 3}) * (M3::Identity() + t * strain)); };
    Point<float> point{Mat<float, 3>::Zero(), 0, 0, 0, Mat<float, 3>::Zero()};
    for (int i = 0; i < steps; ++i) {
      M3 const G = increment(F(double(i) / steps), F(double(i + 1) / steps));
      point = step<float>(law, point, G.cast<float>(), 0, 0, steps).point;
    }
    M3 const turn = rotation(angle, {1, 2, 3}),
             wanted = 2 * law.shear() * strain + law.lame() * strain.trace() * M3::Identity();
    EXPECT_LT((point.stress.cast<double>() - turn * wanted * turn.transpose()).norm(),
              6e-8 * (4 * steps * wanted.norm() + 2 * law.shear() * (1 + angle / std::sqrt(steps))))
        << angle;
  }
}

// ------------------------------------------------------------------------------------------------------ closed forms
TEST(JohnsonCookBar, FollowsItsCurve) {
  // Verification E2, sides free: von Mises at a stretch of 1.2, slower than the reference rate.
  for (bool logarithmic : {false, true}) {
    Bar bar;
    Plastic& p = bar.path.law;
    p.young = 206.9e9, p.poisson = 0.29, p.logarithmic = logarithmic;
    std::get<JohnsonCookFlow>(p.flow.laws) = steel();
    p.flow.which = 1;
    for (auto const& [u, stress] : {std::pair{0.01, 1056.76}, {0.05, 1168.11}, {0.1, 1215.28}, {0.2, 1264.67}}) {
      bar.pull(u, 400);
      EXPECT_NEAR(bar.stress() / MPa, stress, 1e-3 * stress) << u;
    }
    EXPECT_NEAR(bar.path.point.strain, 0.176209, 1e-4);
  }
}

Plastic rock(double angle, double dilation, double beta, std::vector<double> const& numbers, int strains) {
  Plastic p;
  p.young = 30e9, p.poisson = 0.3;
  DruckerPrager law;
  static_cast<Curves&>(law) = curves(numbers, strains, 1, strains == 1 ? 0 : 50e6);
  law.friction_angle = angle, law.dilation_angle = dilation, law.beta = beta;
  std::get<DruckerPrager>(p.flow.laws) = law;
  p.flow.which = 2;
  return p;
}

TEST(DruckerPragerBar, FollowsItsClosedForm) {
  // Verification E4: sigma_ys = 50 + 50 ep MPa, associated, in tension.
  static std::vector<double> const cohesion{0, 1, 0, 50e6, 100e6};
  struct Row {
    double a, stress[3];
  };
  for (auto const& [a, stress] : {Row{0, {50.0165, 50.4135, 51.1494}}, Row{0.1, {45.4745, 45.8026, 46.4110}},
                                  Row{0.2, {41.6878, 41.9636, 42.4749}}}) {
    double const angle = std::atan(3 * a);
    Bar bar{{rock(angle, angle, 1, cohesion, 2)}};
    int k = 0;
    for (double u : {0.002, 0.010, 0.025}) {
      bar.pull(u, 400);
      EXPECT_NEAR(bar.stress() / MPa, stress[k], 1e-3 * stress[k]) << a << ' ' << u;
      ++k;
    }
  }
}

TEST(DruckerPrager, HasItsStrengthsInTensionCompressionAndShear) {
  // Verification E4 for sigma_c = 50 MPa: sigma_t = d/(1 + tan b/3), sigma_c = d/(1 - tan b/3), tau = d/sqrt 3.
  struct Row {
    double angle, d, tension, shear;
  };
  for (auto const& row :
       {Row{30, 40.3775, 33.8610, 23.3120}, Row{40, 36.0150, 28.1433, 20.7933}, Row{50, 30.1374, 21.5691, 17.3999}}) {
    std::vector<double> const cohesion{0, 0, row.d * MPa};
    auto const law = rock(row.angle * degree, 0, 1, cohesion, 1);
    for (double sign : {-1.0, 1.0}) {
      Bar bar{{law}};
      bar.pull(sign * 0.004, 400);
      EXPECT_NEAR(std::abs(bar.stress()) / MPa, sign < 0 ? 50 : row.tension, 1e-3 * 50) << row.angle;
    }
    Path shear{law};
    shear.follow(
        [](double t) {
          M3 F = M3::Identity();
          F(0, 1) = F(1, 0) = 0.002 * t;
          F(2, 2) = 1 / (1 - 4e-6 * t * t);
          return F;
        },
        400);
    EXPECT_NEAR(shear.point.stress(0, 1) / MPa, row.shear, 1e-3 * row.shear) << row.angle;
  }
}

TEST(DruckerPrager, IsStrongerUnderPressureOnItsSides) {
  // Verification E4, triaxial at 10 MPa: s1 = s3 + (d + s3 tan b)/(1 - tan b/3).
  for (auto const& [angle, d, strength] :
       {std::array{30.0, 40.3775, 67.1494}, {40.0, 36.0150, 71.6493}, {50.0, 30.1374, 79.7720}}) {
    std::vector<double> const cohesion{0, 0, d * MPa};
    Bar bar{{rock(angle * degree, 0, 1, cohesion, 1)}};
    bar.pressure = 10 * MPa;
    bar.pull(-0.006, 600);
    EXPECT_NEAR(-bar.stress() / MPa, strength, 1e-3 * strength) << angle;
  }
}

TEST(DruckerPrager, DilatesByItsAngleAndNotWithoutOne) {
  std::vector<double> const cohesion{0, 0, 40e6};
  for (double psi : {0.0, 0.3}) {
    Path path{rock(0.5, psi, 1, cohesion, 1)};
    path.follow(
        [](double t) {
          M3 F = M3::Identity();
          F(0, 1) = F(1, 0) = 0.01 * t;
          return F;
        },
        1000);
    // Plastic change of volume: what the pressure shows that the volume does not.
    double const elastic = path.point.stress.trace() / (3 * path.law.bulk()), plastic = std::log(1 + path.j) - elastic;
    EXPECT_NEAR(plastic, std::tan(psi) * path.point.strain, psi == 0 ? 1e-10 : 1e-6);
  }
}

TEST(DruckerPrager, GoesToTheTipWhenPulledFromAllSides) {
  std::vector<double> const cohesion{0, 0, 40e6};
  for (double psi : {0.0, 0.2, 0.5}) {
    auto const law = rock(0.5, psi, 1, cohesion, 1);
    M3 G = 0.01 * M3::Identity();
    G(0, 1) = 1e-4;
    auto const point = step(law, rest(), G, std::pow(1.01, 3) - 1, 0.0, 1.0).point;
    EXPECT_NEAR(point.stress.trace() / 3, std::pow(1.01, 3) * 40e6 / std::tan(0.5), 1e-6 * 40e6);
    EXPECT_LT(deviator(point.stress).norm(), 1);
  }
}

TEST(DruckerPrager, ShiftsOrGrowsByBeta) {
  // Pull to a plastic strain, then press: the elastic range is twice the first yield stress (kinematic), or twice the
  // last.
  std::vector<double> const cohesion{0, 1, 0, 50e6, 2050e6};
  for (double beta : {0.0, 0.5, 1.0}) {
    Bar bar{{rock(0, 0, beta, cohesion, 2)}};
    bar.pull(0.01, 400);
    double const top = bar.stress(), strain = bar.path.point.strain;
    EXPECT_NEAR(top / MPa, 50 + 2000 * strain, 0.1);
    double range = 0;
    for (double u = 0.01; range == 0; u -= 1e-5) {
      bar.pull(u, 1);
      if (bar.path.point.strain > strain) range = top - bar.stress();
      ASSERT_GT(u, -0.05);
    }
    EXPECT_NEAR(range / MPa, 2 * (50 + beta * 2000 * strain), 0.4) << beta;  // a step is 0.3 MPa
  }
}

TEST(DruckerPrager, HasTheSameOverstressWithEveryBeta) {
  // Shear at 100/s of a law with two rates and no hardening: what the rate adds must not move the centre step by step.
  std::vector<double> const cohesion{0, 0, std::log(1e4), 50e6, 90e6};
  for (double beta : {0.0, 0.5, 1.0}) {
    Plastic law = rock(0, 0, beta, cohesion, 1);
    std::get<DruckerPrager>(law.flow.laws).rates = 2;
    for (int n : {100, 1000}) {
      Path path{law};
      path.follow(
          [](double t) {
            M3 F = M3::Identity();
            F(0, 1) = F(1, 0) = 0.02 * t;
            F(2, 2) = 1 / (1 - 4e-4 * t * t);
            return F;
          },
          n, 4e-4);
      double const expected = (50e6 + 40e6 * std::log(path.point.rate) / std::log(1e4)) / std::sqrt(3);
      EXPECT_NEAR(path.point.stress(0, 1) / expected, 1, 1e-3) << beta << ' ' << n;
    }
  }
}

TEST(Consistency, FindsTheRootWhereTheRateTermSetsIn) {
  // Linear hardening with the Johnson-Cook threshold of the rate: a kink that Newton's method alone would jump across
  // for ever.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> one(0, 1);
  for (int i = 0; i < 20000; ++i) {
    JohnsonCookFlow law;
    law.A = 1e8, law.B = 1e9 * one(random), law.n = 1, law.C = one(random), law.rate0 = std::pow(10, 4 * one(random));
    ElasticConstants elastic{30e9, 0.3};
    FlowPoint<double, false> point{M3::Zero(), 0, one(random) < 0.5 ? 0 : law.rate0 * one(random), 0, {}};
    double const q = 1e8 * (1 + std::pow(10, -6 * one(random))), per_time = std::pow(10, 2 + 6 * one(random));
    point.stress(0, 1) = point.stress(1, 0) = q / std::sqrt(3);
    law.flow(elastic, FlowStep<double>{1.0, per_time, false}, point);
    double const after = std::sqrt(3) * point.stress(0, 1);
    EXPECT_NEAR(after / law.yield(point.strain, point.rate, 0.0).stress, 1, 1e-9) << i;
  }
}

TEST(Heating, WarmsByTheWorkThatFlowTakes) {
  Path path{Given<JohnsonCookFlow>::law()};
  path.law.heating = 0.9 / (7830.0 * 460);
  path.follow(
      [](double t) {
        M3 F = M3::Identity();
        F(0, 1) = 0.2 * t;
        return F;
      },
      1000);
  EXPECT_NEAR(path.point.rise / (path.law.heating * path.dissipated), 1, 1e-9);
  EXPECT_GT(path.point.rise, 1);
}

}  // namespace
}  // namespace fissure::laws
