// Contact with rigid plates and walls, and friction.
#include <gtest/gtest.h>

#include "contact_rig.h"

namespace fissure {
namespace {

using namespace contact_test;

template <class T>
class RigidContact : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(RigidContact, Dimensions);

// ------------------------------------------------------------------------------------------------- plates, walls,
// friction
/// Lowest face flat at height 0, altitude H, area of that face; the apex points up.
template <int D>
Corners<D> standing(double H) {
  Corners<D> s;
  for (auto& x : s) x.setZero();
  for (int a = 1; a < D; ++a) s[a][a == 1 ? 0 : 2] = 1;
  s[D].setConstant(0.3);
  s[D][1] = H;
  return s;
}

/// (D+1) times the integral of min(d/H, other lambdas) over the cut at depth d: p (D+1) d/H of the face to first order.
template <int D>
double cut_potential(double depth, double H) {
  double const s = depth / H, area = D == 2 ? 1.0 : 0.5;
  return (D + 1) * area * (std::pow(1 - s, D) - std::pow(1 - s - D * s, D)) / (D * D);
}

TYPED_TEST(RigidContact, ForgetsItsSpringWhenItPartsAsItsSlotsAreMadeAgain) {
  constexpr int D = TypeParam::value;
  Rig<D> rig({standing<D>(0.7)}, {4e9, 0.5});
  rig.speed(0, Vec<double, D>::Unit(0));
  kernels::HalfSpace<D, double> wall{Vec<double, D>::Unit(1) * 0.01, Vec<double, D>::Unit(1)};
  rig.press(wall, 1e-4);
  ASSERT_GT(rig.spring[D], 0);
  rig.penetration[0] = rig.work[0] = 0;
  rig.move(0, Vec<double, D>::Unit(1));
  rig.press(wall, 1e-4);
  EXPECT_GT(rig.work[0], 0);
  for (double s : rig.spring) EXPECT_EQ(s, 0);
}

TYPED_TEST(RigidContact, PlateAndWallPressWithTheSlopeOfThePotential) {
  constexpr int D = TypeParam::value;
  double const H = 0.7, p = 4e9;
  for (double depth : {1e-9, 1e-3, 0.05}) {
    kernels::RigidBox<D, double> plate;
    plate.low.setConstant(-1000);
    plate.high.setConstant(1000);
    plate.high[1] = 0;
    plate.displacement = depth * Vec<double, D>::Unit(1);
    plate.velocity.setZero();
    Rig<D> rig({standing<D>(H)}, {p, 0.0});
    rig.press(plate);
    double const exact = p * cut_potential<D>(depth, H);
    EXPECT_NEAR(rig.total(0)[1], exact, 2e-7 * exact);
    for (int c = 0; c < D; ++c) EXPECT_NEAR(rig.reaction[c], -rig.total(0)[c], 1e-14 * exact);
    EXPECT_NEAR(rig.total(0)[0], 0, 1e-12 * exact);
    EXPECT_NEAR(rig.penetration[0], (D + 1) * depth / H, 2e-7 * (D + 1) * depth / H);

    kernels::HalfSpace<D, double> wall{Vec<double, D>::Unit(1) * depth, Vec<double, D>::Unit(1)};
    wall.point[0] = 1000;
    Rig<D> other({standing<D>(H)}, {p, 0.0});
    other.press(wall);
    EXPECT_NEAR(other.total(0)[1], exact, 2e-7 * exact);
  }
  double const pressure = p * cut_potential<D>(1e-6, H) / (D == 2 ? 1.0 : 0.5);
  EXPECT_NEAR(pressure, p * (D + 1) * 1e-6 / H, 1e-5 * pressure);
}

TYPED_TEST(RigidContact, PlateAndWallForcesAreGradientsOfThePotentialInside) {
  constexpr int D = TypeParam::value;
  std::mt19937 rng(17);
  std::uniform_real_distribution<double> place(-0.2, 0.6);
  for (int trial = 0; trial < 100; ++trial) {
    Corners<D> const E = random_simplex<D>(rng, 1);
    kernels::RigidBox<D, double> plate;
    plate.displacement.setZero();
    plate.velocity.setZero();
    for (int c = 0; c < D; ++c) plate.low[c] = place(rng), plate.high[c] = plate.low[c] + 0.5;
    double const h = 1e-5;
    auto energy = [&](Vec<double, D> const& by) {
      Corners<D> const s = moved<D>(E, by);
      double sum = 0;
      for (int i = 0; i <= D; ++i) {
        Corners<D> fan = s;
        fan[i].setZero();
        for (auto const& x : s) fan[i] += x / (D + 1);
        std::vector<Corners<D>> parts{fan};
        for (int c = 0; c < D; ++c)
          for (int side : {0, 1}) {
            std::vector<Corners<D>> next;
            for (auto const& part : parts)
              keep_positive<D>(
                  part, [&](Vec<double, D> const& x) { return side ? plate.high[c] - x[c] : x[c] - plate.low[c]; },
                  next);
            parts = next;
          }
        for (auto const& part : parts)
          for (auto const& x : part) sum += barycentric<D>(fan, i, x) / (D + 1) * volume<D>(part);
      }
      return sum;
    };
    Rig<D> rig({E});
    rig.press(plate);
    for (int c = 0; c < D; ++c) {
      Vec<double, D> const step = Vec<double, D>::Unit(c) * h;
      EXPECT_NEAR(rig.total(0)[c], -(energy(step) - energy(-step)) / (2 * h), 1e-8) << "trial " << trial;
    }
    EXPECT_NEAR(rig.held, energy(Vec<double, D>::Zero()), 1e-11) << "trial " << trial;

    // A half-space is a plate without end.
    for (int c = 0; c < D; ++c) plate.low[c] = -100, plate.high[c] = c == 0 ? plate.high[c] : 100;
    Rig<D> other({E});
    other.press(kernels::HalfSpace<D, double>{plate.high, Vec<double, D>::Unit(0)});
    EXPECT_NEAR(other.held, energy(Vec<double, D>::Zero()), 1e-11) << "trial " << trial;
  }
}

TYPED_TEST(RigidContact, FrictionSticksBelowAndSlidesAboveItsLimit) {
  constexpr int D = TypeParam::value;
  double const H = 0.7, p = 1e9, mu = 0.3, depth = 1e-4, dt = 1e-5, speed = 0.05;
  kernels::HalfSpace<D, double> wall{Vec<double, D>::Unit(1) * depth, Vec<double, D>::Unit(1)};
  Rig<D> rig({standing<D>(H)}, {p, mu});
  Vec<double, D> const along = Vec<double, D>::Unit(0);
  rig.speed(0, along * speed);
  double slid = 0, work = 0, k = 0, normal = 0;
  for (int step = 0; step < 400; ++step) {
    rig.move(0, along * (speed * dt));
    slid += speed * dt;
    rig.press(wall, dt);
    work += rig.work[0];
    normal = rig.total(0)[1];
    k = 0;
    for (double s : rig.stiffness) k += s;
    double const expected = std::min(k * slid, mu * normal);
    EXPECT_NEAR(rig.total(0)[0], -expected, 1e-9 * mu * normal) << "step " << step;
  }
  double const elastic = mu * normal / k;
  EXPECT_GT(slid, 3 * elastic);
  // Within the step in which it begins to slide, the mean of the forces before and after is less than the limit.
  EXPECT_NEAR(work, mu * normal * (slid - elastic), k * std::pow(speed * dt, 2) / 2);
  rig.speed(0, -along * speed);  // back: the spring unloads before it slides the other way
  rig.press(wall, dt);
  EXPECT_EQ(rig.work[0], 0);
  EXPECT_LT(std::abs(rig.total(0)[0]), mu * normal);
}

TYPED_TEST(RigidContact, FrictionTakesWhatAClosedPathLosesAndNeverGives) {
  constexpr int D = TypeParam::value;
  // Press and shift an element on a wall around a loop, both ways; the wall's friction may keep energy, never give any.
  double const H = 0.7, p = 1e9, two_pi = 2 * std::acos(-1.0), dt = 1e-6;
  for (double mu : {0.05, 1000.0})  // sliding most of the way, always sticking
    for (double direction : {-1.0, 1.0}) {
      kernels::HalfSpace<D, double> wall{Vec<double, D>::Zero(), Vec<double, D>::Unit(1)};
      Rig<D> rig({standing<D>(H)}, {p, mu});
      auto place = [&](double t) {
        Vec<double, D> x = Vec<double, D>::Zero();
        x[0] = 1e-3 * std::sin(direction * t);
        x[1] = -2e-3 - 3e-3 * std::cos(t);  // leaves the wall, and presses it to 7/10 % of the altitude
        return x;
      };
      int const steps = 20000;
      double lost = 0, booked = 0;
      rig.move(0, place(two_pi / 2));
      Vec<double, D> before = Vec<double, D>::Zero();
      for (int i = 1; i <= steps; ++i) {
        double const t = two_pi / 2 + two_pi * i / steps, t0 = two_pi / 2 + two_pi * (i - 1) / steps;
        Vec<double, D> const step = place(t) - place(t0);
        rig.move(0, step);
        rig.speed(0, step / dt);
        rig.press(wall, dt);
        lost -= (rig.total(0) + before).dot(step) / 2;
        before = rig.total(0);
        booked += rig.work[0];
      }
      EXPECT_GT(booked, 0);
      EXPECT_NEAR(lost, booked, 2e-3 * booked) << "mu " << mu << " direction " << direction;
    }
}

TYPED_TEST(RigidContact, FrictionBetweenElementsIsEqualAndOpposite) {
  constexpr int D = TypeParam::value;
  Corners<D> const A = standing<D>(0.7);
  Corners<D> B = A;
  for (auto& x : B) x[1] *= -1;
  double const mu = 0.25, dt = 1e-4;
  Rig<D> rig({A, B}, {1e9, mu});
  rig.move(1, 1e-5 * Vec<double, D>::Unit(1));
  rig.speed(0, Vec<double, D>::Unit(0));
  rig.touch(dt);
  EXPECT_NEAR(rig.total(0)[0], -mu * rig.total(0)[1], 1e-3 * rig.total(0)[1]);
  EXPECT_NEAR((rig.total(0) + rig.total(1)).norm(), 0, 1e-12 * rig.total(0).norm());
  EXPECT_GT(rig.work[0], 0);
}

/// A rigid element on a wall that turns into an incline; returns how far it went after `steps` and in the last tenth.
template <int D>
std::pair<double, double> slide(double mu, double slope, double dt, int steps) {
  double const H = 0.7, p = 1e9, g = 9.81, mass = 100;
  kernels::HalfSpace<D, double> wall{Vec<double, D>::Zero(), Vec<double, D>::Unit(1)};
  double low = 0, high = 0.1;  // the depth at which the wall carries the weight
  for (int i = 0; i < 60; ++i)
    (p * cut_potential<D>((low + high) / 2, H) < mass * g * std::cos(slope) ? low : high) = (low + high) / 2;
  Rig<D> rig({standing<D>(H)}, {p, mu});
  rig.move(0, -low * Vec<double, D>::Unit(1));
  Vec<double, D> v = Vec<double, D>::Zero(), x = v;
  double last = 0;
  for (int step = 0; step < steps; ++step) {
    if (step == steps - steps / 10) last = x[0];
    rig.press(wall, dt);
    Vec<double, D> pull = Vec<double, D>::Zero();
    pull[0] = mass * g * std::sin(slope);
    pull[1] = -mass * g * std::cos(slope);
    v += dt * (rig.total(0) + pull) / mass;
    x += dt * v;
    rig.speed(0, v);
    rig.move(0, dt * v);
  }
  return {x[0], x[0] - last};
}

TYPED_TEST(RigidContact, RestsBelowTheFrictionAngleAndSlidesAboveD4) {
  constexpr int D = TypeParam::value;
  double const slope = std::acos(-1.0) / 6;
  auto const [moved, crept] = slide<D>(0.7, slope, 1e-5, 100000);
  EXPECT_LT(std::abs(moved), 1e-6);  // the spring's stretch
  EXPECT_LT(std::abs(crept), 1e-6);
  auto const [longer, still] = slide<D>(0.7, slope, 1e-5, 300000);
  EXPECT_LT(std::abs(longer), 1e-6);  // three times as long: no further
  EXPECT_LT(std::abs(still), 1e-6);
  EXPECT_NEAR(slide<D>(0.0, slope, 1e-5, 100000).first, 2.4525, 1e-3);
  EXPECT_NEAR(slide<D>(0.3, slope, 1e-5, 100000).first, 1.17814, 2e-3);
  EXPECT_NEAR(slide<D>(0.5, slope, 1e-5, 100000).first, 0.32857, 2e-3);
}

}  // namespace
}  // namespace fissure
