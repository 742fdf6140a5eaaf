// Every law of laws/laws.h, held to what any law of its kind must do; a new law gets these tests for free.
#include "laws/laws.h"

#include <gtest/gtest.h>

#include <random>

#include "exemplars/stiffening.h"
#include "laws/plane_stress.h"

namespace fissure::laws {
namespace {

using M3 = Mat<double, 3>;

template <class Variant>
struct TypesOf;
template <class... Laws>
struct TypesOf<std::variant<Laws...>> {
  using type = ::testing::Types<Laws..., exemplar::Stiffening>;
};

template <class Law>
struct Bulk : ::testing::Test {
  static Law law(double young = 50e9, double poisson = 0.25) {
    Law law;
    law.young = young, law.poisson = poisson;
    return law;
  }
  /// Cauchy stress at the displacement gradient H.
  static M3 cauchy(M3 const& H, Law const& law = Bulk::law()) {
    double const j = (M3::Identity() + H).determinant() - 1;
    return law.kirchhoff(H, j) / (1 + j);
  }
  static M3 some(int seed, double size) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> x(-size, size);
    M3 H;
    for (int i = 0; i < 9; ++i) H(i / 3, i % 3) = x(random);
    return H;
  }
  static M3 rotation(int seed) {
    return Eigen::Quaterniond(some(seed, 1).col(0)[0], 0.4, some(seed, 1)(1, 1), 0.3).normalized().toRotationMatrix();
  }
};
TYPED_TEST_SUITE(Bulk, TypesOf<AnyBulk>::type);

TYPED_TEST(Bulk, IsZeroAtRest) {
  EXPECT_EQ(this->cauchy(M3::Zero()).norm(), 0);
  EXPECT_EQ(this->law().energy(M3(M3::Zero()), 0.0), 0);
}

TYPED_TEST(Bulk, IsLinearAtSmallStrain) {
  auto const law = this->law();
  M3 const H = this->some(1, 1e-6), e = 0.5 * (H + H.transpose());
  M3 const hooke = law.lame() * e.trace() * M3::Identity() + 2 * law.shear() * e;
  EXPECT_LT((this->cauchy(H) - hooke).norm(), 1e-5 * hooke.norm());  // strains squared
  double const energy = 0.5 * hooke.cwiseProduct(e).sum(), j = (M3::Identity() + H).determinant() - 1;
  EXPECT_NEAR(law.energy(H, j) / energy, 1, 1e-4);
}

TYPED_TEST(Bulk, TurnsWithTheBody) {
  for (int seed = 0; seed < 20; ++seed) {
    M3 const H = this->some(seed, 0.2), Q = this->rotation(seed + 100);
    M3 const turned = Q * (M3::Identity() + H) - M3::Identity();
    M3 const before = this->cauchy(H);
    EXPECT_LT((this->cauchy(turned) - Q * before * Q.transpose()).norm(), 1e-13 * 50e9) << seed;
  }
}

TYPED_TEST(Bulk, PrefersNoDirection) {
  for (int seed = 0; seed < 20; ++seed) {
    M3 const H = this->some(seed, 0.2), Q = this->rotation(seed + 100);
    M3 const before = (M3::Identity() + H) * Q - M3::Identity();  // the reference body turned first
    EXPECT_LT((this->cauchy(before) - this->cauchy(H)).norm(), 1e-13 * 50e9) << seed;
  }
}

TYPED_TEST(Bulk, IsItsEnergysSlope) {
  // P = dW/dF = tau F^-T by central differences: to round-off for a law with a stored energy; Munjiza's has one to
  // second order in strain, so its stress to first order: an error of strain squared.
  auto const law = this->law();
  for (double size : {1e-4, 0.1}) {
    M3 const H = this->some(3, size);
    auto const energy = [&](M3 const& G) { return law.energy(G, (M3::Identity() + G).determinant() - 1); };
    double const step = 1e-6;
    M3 slope;
    for (int i = 0; i < 9; ++i) {
      M3 up = H, down = H;
      up(i / 3, i % 3) += step, down(i / 3, i % 3) -= step;
      slope(i / 3, i % 3) = (energy(up) - energy(down)) / (2 * step);
    }
    double const j = (M3::Identity() + H).determinant() - 1;
    M3 const first = law.kirchhoff(H, j) * (M3::Identity() + H).inverse().transpose();
    double const share = std::is_same_v<TypeParam, Munjiza> ? 10 * size : 1e-6;
    EXPECT_LT((first - slope).norm(), share * slope.norm()) << size;
  }
}

TYPED_TEST(Bulk, HasTheWaveModulusAsTangent) {
  auto const law = this->law();
  double const e = 1e-7;
  M3 stretch = M3::Zero(), shear = M3::Zero();
  stretch(0, 0) = e;
  shear(0, 1) = e;
  EXPECT_NEAR(this->cauchy(stretch)(0, 0) / e / law.confined(), 1, 1e-6);
  EXPECT_NEAR(this->cauchy(shear)(0, 1) / e / law.shear(), 1, 1e-6);
}

TYPED_TEST(Bulk, PlaneStressHasItsClosedForm) {
  PlaneStress<TypeParam> const law(this->law());
  double const e = 1e-8, nu = law.poisson, plane = law.young / (1 - nu * nu);
  M3 H = M3::Zero();
  H(0, 0) = e;
  M3 const tau = law.kirchhoff(H, e);
  EXPECT_NEAR(tau(0, 0) / e / plane, 1, 1e-6);
  EXPECT_NEAR(tau(1, 1) / e / (nu * plane), 1, 1e-6);
  EXPECT_EQ(tau(2, 2), 0);
  // At large strain: the thickness that it finds leaves no stress out of the plane.
  H << 0.2, 0.1, 0, -0.05, -0.1, 0, 0, 0, 0;
  double const j = 1.2 * 0.9 + 0.1 * 0.05 - 1, h = law.thickness_strain(H, j);
  H(2, 2) = h;
  EXPECT_LT(std::abs(static_cast<TypeParam const&>(law).kirchhoff(H, j + h + j * h)(2, 2)), 1e-12 * law.young);
}

/// Whatever the stretches in the plane, however the body has turned: nothing is left out of the plane.
TYPED_TEST(Bulk, PlaneStressTurnsAndStretches) {
  auto const left = [&]<class T>(T, double first, double second, double shear, double angle) {
    PlaneStress<TypeParam> const law(this->law());
    double const c = std::cos(angle), s = std::sin(angle);
    M3 stretch = M3::Identity(), turn = M3::Identity();
    stretch(0, 0) = first, stretch(1, 1) = second, stretch(0, 1) = shear;
    turn.topLeftCorner<2, 2>() << c, -s, s, c;
    Mat<T, 3> H = (turn * stretch - M3::Identity()).template cast<T>();
    T const j = static_cast<T>(first * second - 1), h = law.thickness_strain(H, j);
    H(2, 2) = h;
    return std::abs(static_cast<TypeParam const&>(law).kirchhoff(H, j + h + j * h)(2, 2)) / law.young;
  };
  double const resolution = std::numeric_limits<double>::epsilon(), coarse = std::numeric_limits<float>::epsilon();
  for (double first : {1 / 3.0, 0.6, 1 - 1e-3, 1.0, 1 + 1e-6, 1.5, 3.0})
    for (double second : {1 / 3.0, 0.9, 1.0, 1.1, 3.0})
      for (double shear : {0.0, 1e-3, 1.0})
        for (double angle : {0.0, 0.5, 1.6, 3.1, 4.5}) {
          // Terms of F F^T and of the volume's pressure cancel: round-off of those, some ten operations.
          double const size = 10 * (1 + first * first + second * second + shear * shear) * (1 + first * second);
          EXPECT_LT(left(double{}, first, second, shear, angle), size * resolution)
              << first << ' ' << second << ' ' << shear << ' ' << angle;
          EXPECT_LT(left(float{}, first, second, shear, angle), size * coarse)
              << first << ' ' << second << ' ' << shear << ' ' << angle;
        }
}

TYPED_TEST(Bulk, PlaneStressIsFiniteInSinglePrecision) {
  PlaneStress<TypeParam> const law(this->law());
  for (float e : {0.f, 1e-12f, 1e-7f, 1e-4f, 1e-2f}) {
    Mat<float, 3> H = Mat<float, 3>::Zero();
    H(0, 0) = e, H(0, 1) = e / 3;
    float const s = law.kirchhoff(H, e)(0, 0);
    EXPECT_TRUE(std::isfinite(s)) << e;
    if (e > 0) {
      EXPECT_NEAR(s / e / (law.young / (1 - law.poisson * law.poisson)), 1, 3 * static_cast<double>(e) + 1e-4) << e;
    }
  }
}

TYPED_TEST(Bulk, APackIsItsScalars) {
  using P = Pack<double>;
  auto const law = this->law();
  Mat<P, 3> H;
  P j = 0;
  std::array<M3, lane_width<P>> lanes;
  for (int l = 0; l < lane_width<P>; ++l) {
    lanes[l] = this->some(l, 0.1);
    for (int i = 0; i < 9; ++i) set_lane(H(i / 3, i % 3), l, lanes[l](i / 3, i % 3));
    set_lane(j, l, (M3::Identity() + lanes[l]).determinant() - 1);
  }
  Mat<P, 3> const tau = law.kirchhoff(H, j);
  for (int l = 0; l < lane_width<P>; ++l) {
    M3 const alone = law.kirchhoff(lanes[l], lane(j, l));
    for (int i = 0; i < 9; ++i) EXPECT_EQ(lane(tau(i / 3, i % 3), l), alone(i / 3, i % 3)) << l;
  }
}

TYPED_TEST(Bulk, SinglePrecisionAgreesWithDouble) {
  auto const law = this->law();
  for (double size : {1e-5, 1e-2, 0.3}) {
    M3 const H = this->some(5, size);
    double const j = H.trace() + (H.trace() * H.trace() - (H * H).trace()) / 2 + H.determinant();
    M3 const exact = law.kirchhoff(H, j);
    Mat<float, 3> const rough = law.kirchhoff(Mat<float, 3>(H.cast<float>()), static_cast<float>(j));
    EXPECT_LT((rough.cast<double>() - exact).norm(), 5e-6 * exact.norm()) << size;
  }
}

TEST(Algebra, CubeRootKeepsItsDigits) {
  // y = cbrt(1 + j) - 1 solves y (3 + y (3 + y)) = j: the residual measures its error without a reference.
  for (double j : {0.0, 1e-300, 1e-16, -1e-12, 1e-8, -1e-3, 0.1, -0.5, 1.0, 9.0, -0.9}) {
    long double const y = cbrt_minus_one(j), residual = y * (3 + y * (3 + y)) - static_cast<long double>(j);
    EXPECT_LE(std::abs(static_cast<double>(residual)), 1e-14 * std::abs(j)) << j;
  }
}

/// Every curve, and both ways of opening and slip at once.
struct Joints : ::testing::TestWithParam<std::tuple<std::string, bool>> {
  static constexpr double k = 4e14;
  static CohesiveJoint law(double friction_angle = 0, double residual = 0) {
    CohesiveJoint law;
    law.tension = 3e6, law.shear = 10e6, law.G1 = 20, law.G2 = 50, law.penalty = 1e12;
    law.friction_angle = friction_angle, law.residual = residual;
    law.opens = law.slides = Softening::named(std::get<0>(GetParam()));
    law.independent = std::get<1>(GetParam());
    law.prepare();
    return law;
  }
  /// Where nothing holds any more, of opening or slip alone.
  static double end(CohesiveJoint const& law, double G, double f) {
    return f / k + law.softening_length(G, f, f / k, law.opens.integral);
  }
};
INSTANTIATE_TEST_SUITE_P(All, Joints, ::testing::Combine(::testing::ValuesIn(Softening::names()), ::testing::Bool()),
                         [](auto const& info) {
                           return std::get<0>(info.param) + (std::get<1>(info.param) ? "_independent" : "_ellipse");
                         });

TEST(Softening, FallsFromOneToNothing) {
  for (auto const& name : Softening::names()) {
    auto const curve = Softening::named(name);
    EXPECT_LE(curve.points, Softening::most) << name;
    EXPECT_EQ(curve.value(0.0), 1) << name;
    EXPECT_EQ(curve.value(1.0), 0) << name;
    double sum = 0, last = 1;
    int const n = 100'000;
    for (int i = 0; i < n; ++i) {
      double const z = curve.value((i + 0.5) / n);
      EXPECT_LE(z, last + 1e-15) << name << " " << i;
      last = z, sum += z / n;
    }
    EXPECT_NEAR(sum, curve.integral, 1e-8) << name;
  }
  EXPECT_NEAR(Softening::munjiza().integral, 0.3863072947, 1e-4);  // of the curve itself, by quadrature
  EXPECT_NEAR(Softening::bilinear().integral, 5.0 / 18, 1e-7);     // so that it ends at 3.6 G/ft
  EXPECT_NEAR(Softening::exponential().integral, 1 / 5.0 - std::exp(-5.0) / (1 - std::exp(-5.0)), 1e-4);
}

/// Opening and slip in fixed ratios: peak on the ellipse, work by the ratio.
TEST_P(Joints, TakeTheirFractureEnergies) {
  auto const law = this->law();
  for (int degrees = 0; degrees <= 90; degrees += 15) {
    if (law.independent && degrees % 90 != 0) continue;
    double const angle = degrees * std::numbers::pi / 180, c = degrees == 90 ? 0 : std::cos(angle),
                 s = degrees == 0 ? 0 : std::sin(angle);
    double const f = 1 / std::hypot(c / law.tension, s / law.shear), G = 1 / (c * c / law.G1 + s * s / law.G2);
    double const last = 1.001 * end(law, G, f);
    CohesiveJoint::History<double> history;
    JointEnergy<double> energy{};
    double work = 0, taken = 0, before = 0, at = 0, peak = 0;
    int const rise = 2000, fall = 20000;
    for (int i = 1; i <= rise + fall; ++i) {
      double const x = i <= rise ? f / k * i / rise : f / k + (last - f / k) * (i - rise) / fall;
      auto const t = law.soften(k, c * x, s * x, history, energy);
      double const traction = t.normal * c + t.per_slip * s * x * s;
      work += 0.5 * (traction + before) * (x - at), taken += energy.dissipated;
      before = traction, at = x, peak = std::max(peak, traction);
    }
    EXPECT_NEAR(peak / f, 1, 1e-3) << degrees;
    EXPECT_NEAR(work / G, 1, 1e-5) << degrees;
    EXPECT_NEAR(taken / G, 1, 1e-5) << degrees;
    EXPECT_EQ(history.damage, 1) << degrees;
    EXPECT_EQ(energy.stored, 0) << degrees;
  }
}

/// A share below nothing, from round-off, would be divided by when it came back to nothing.
TEST_P(Joints, RubOnNoLessThanNothing) {
  auto const law = this->law();
  for (int i = 0; i <= 40'000; ++i) {
    double const damage = i == 0 ? 0 : std::pow(10.0, -18 + i * 18 / 40'000.0);
    EXPECT_GE(law.rubbing(damage), 0) << damage;
    EXPECT_GE(law.rubbing(static_cast<float>(damage)), 0) << damage;
  }
  EXPECT_EQ(law.rubbing(0.0f), 0);
  EXPECT_EQ(law.rubbing(1.0), 1);
}

TEST_P(Joints, AreSpringsBeforeThePeak) {
  auto const law = this->law(0.6);
  for (double o : {-3e-8, -1e-9, 0.0, 1e-9, 6e-9})
    for (double s : {0.0, 1e-9, 1e-8}) {
      CohesiveJoint::History<double> history;
      JointEnergy<double> energy{};
      EXPECT_FALSE(law.past_peak(k, o, s));
      auto const traction = law.soften(k, o, s, history, energy);
      EXPECT_EQ(traction.normal, k * o);
      EXPECT_EQ(traction.per_slip, k);
      EXPECT_DOUBLE_EQ(energy.stored, k * (o * o + s * s) / 2);
      EXPECT_EQ(history.damage, 0);
    }
}

TEST_P(Joints, UnloadAlongTheSecant) {
  auto const law = this->law();
  CohesiveJoint::History<double> history;
  JointEnergy<double> energy{};
  double const far = 0.4 * end(law, law.G1, law.tension);
  double const top = law.soften(k, far, 0.0, history, energy).normal;
  auto const damage = history.damage;
  for (double share : {0.9, 0.5, 0.1, 0.0, 0.3, 1.0}) {
    EXPECT_NEAR(law.soften(k, share * far, 0.0, history, energy).normal, share * top, 1e-12 * law.tension);
    EXPECT_NEAR(energy.stored, 0.5 * share * share * top * far, 1e-12 * law.G1);
    EXPECT_NEAR(energy.dissipated, 0, 1e-12 * law.G1);
  }
  EXPECT_NEAR(history.damage, damage, 1e-12);
}

/// Work put in, what is held at the end, what was lost, and the least that was lost in a step.
struct Walk {
  double work = 0, stored = 0, dissipated = 0, least = 0, damage = 0;
};
/// Random corners in opening and slip, pressed among them, with straight ways between and back to the start. Pressure
/// falls and rises, slip turns back. Opening is 0 at a step where it changes sign, for there the normal traction has a
/// kink.
template <class Law>
Walk walk(Law const& law, double k, double o_end, double s_end, int seed, int n,
          CohesiveJoint::History<double>& history, double reach) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> to(0, 1);
  std::vector<std::array<double, 2>> corners;
  for (int leg = 0; leg < 12; ++leg) {
    double const o = leg % 2 ? -0.02 * to(random) * o_end : 0.6 * reach * to(random) * o_end,
                 s = (1.2 * to(random) - 0.6) * reach * s_end;
    if (!corners.empty()) {  // through opening 0
      auto const [o0, s0] = corners.back();
      corners.push_back({0, s0 + (s - s0) * o0 / (o0 - o)});
    }
    corners.push_back({o, s});
  }
  corners.push_back({0, 0});
  Walk sum;
  JointEnergy<double> energy{};
  double o = 0, s = 0;
  auto before = law.soften(k, o, s, history, energy);
  for (auto const& [o1, s1] : corners) {
    double const o0 = o, s0 = s;
    for (int i = 1; i <= n; ++i) {
      double const on = o0 + (o1 - o0) * i / n, sn = s0 + (s1 - s0) * i / n;
      auto const t = law.soften(k, on, std::abs(sn), history, energy);
      sum.work +=
          0.5 * (t.normal + before.normal) * (on - o) + 0.5 * (t.per_slip * sn + before.per_slip * s) * (sn - s);
      sum.dissipated += energy.dissipated;
      sum.least = std::min(sum.least, energy.dissipated);
      o = on, s = sn, before = t;
    }
  }
  sum.stored = energy.stored, sum.damage = history.damage;
  return sum;
}

/// 500 closed paths for each law: none gives work, none gives energy back, and once nothing is lost any more all that
/// was put in comes back.
TEST_P(Joints, GiveNoWorkOnClosedPaths) {
  for (double friction_angle : {0.0, 0.8}) {
    auto const law = this->law(friction_angle);
    double const o_end = end(law, law.G1, law.tension), s_end = end(law, law.G2, law.shear);
    double worst = 0;
    int elastic = 0;
    for (int seed = 0; seed < 250; ++seed) {
      CohesiveJoint::History<double> history;
      Walk const first = walk(law, k, o_end, s_end, seed, 200, history, 1);
      EXPECT_GE(first.least, 0) << seed;
      EXPECT_GE(first.work, -1e-10 * law.G1) << seed;
      EXPECT_NEAR(first.stored, 0, 1e-20 * law.G1) << seed;
      EXPECT_GT(first.damage, 0) << seed;
      worst = std::max(worst, std::abs(first.work - first.dissipated) / first.work);
      walk(law, k, o_end, s_end, seed, 200, history,
           0.999);  // the same corners, a little nearer, until nothing is lost any more
      Walk const again = walk(law, k, o_end, s_end, seed, 200, history, 0.998);
      if (again.dissipated > 0) continue;  // a pressure that falls lower may go on to damage
      ++elastic;
      EXPECT_LT(std::abs(again.work), 1e-10 * law.G1) << seed;
    }
    EXPECT_LT(worst, 0.05) << friction_angle;
    EXPECT_GT(elastic, 80) << friction_angle;
  }
}

/// Work less what is stored and lost vanishes with the step: in proportion to it where a path meets the peak between
/// two steps.
TEST_P(Joints, BalanceTheirEnergy) {
  auto const law = this->law(0.6);
  double const o_end = end(law, law.G1, law.tension), s_end = end(law, law.G2, law.shear);
  for (int seed = 0; seed < 8; ++seed) {
    double error[2];
    for (int fine : {0, 1}) {
      CohesiveJoint::History<double> history;
      Walk const sum = walk(law, k, o_end, s_end, seed, fine ? 8000 : 1000, history, 1);
      error[fine] = std::abs(sum.work - sum.dissipated) / sum.work;
    }
    EXPECT_LT(error[1], std::max(1e-4, 0.5 * error[0])) << seed;
    EXPECT_LT(error[1], 2e-3) << seed;
  }
}

TEST_P(Joints, FollowMohrAndCoulomb) {
  auto const law = this->law(0.6, 0.4);
  for (double pressure : {0.0, 2e6, 40e6}) {
    double const fs = law.shear + pressure * std::tan(0.6), opening = -pressure / k;
    CohesiveJoint::History<double> history;
    JointEnergy<double> energy{};
    double most = 0;
    for (int i = 1; i <= 2000; ++i) {
      double const s = 2 * fs / k * i / 2000;
      most = std::max(most, law.soften(k, opening, s, history, energy).per_slip * s);
    }
    EXPECT_NEAR(most / fs, 1, 1e-3) << pressure;
    // At the end nothing holds together: all of the area rubs (friction_test.cpp).
    double const far = 100 * end(law, law.G2, law.shear);
    EXPECT_EQ(law.soften(k, opening, far, history, energy).per_slip, 0);
    EXPECT_EQ(law.rubbing(history.damage), 1);
  }
}

/// Strength that a falling pressure takes away is lost, not given back when the pressure returns.
TEST_P(Joints, LoseWhatAFallingPressureTakes) {
  auto const law = this->law(0.8);
  CohesiveJoint::History<double> history;
  JointEnergy<double> energy{};
  double const pressure = 40e6, s = 0.99 * law.strength(pressure) / k;
  EXPECT_DOUBLE_EQ(law.soften(k, -pressure / k, s, history, energy).per_slip * s, 0.99 * law.strength(pressure));
  double const left = law.soften(k, 0.0, s, history, energy,
                                 [&] {
                                   return JointGap<double>{-pressure / k, s};
                                 })
                          .per_slip *
                      s;
  EXPECT_LE(left, law.shear * (1 + 1e-12));
  EXPECT_DOUBLE_EQ(energy.dissipated, (0.99 * law.strength(pressure) - left) * s / 2);  // it has not moved
  EXPECT_DOUBLE_EQ(law.soften(k, -pressure / k, s, history, energy).per_slip * s, left);
}

TEST_P(Joints, SinglePrecisionAgreesWithDouble) {
  auto const law = this->law();
  CohesiveJoint::History<double> exact;
  CohesiveJoint::History<float> rough;
  JointEnergy<double> a{};
  JointEnergy<float> b{};
  for (int i = 1; i <= 100; ++i) {
    double const o = 0.01 * i * end(law, law.G1, law.tension);
    double const t = law.soften(k, o, 0.3 * o, exact, a).normal;
    float const s =
        law.soften(static_cast<float>(k), static_cast<float>(o), static_cast<float>(0.3 * o), rough, b).normal;
    EXPECT_NEAR(s, t, 1e-4 * law.tension) << i;
  }
}

}  // namespace
}  // namespace fissure::laws
