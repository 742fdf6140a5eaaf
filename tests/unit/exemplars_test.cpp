// The laws that the guide shows how to write: they are what the concepts ask for, and do what they say.
#include <gtest/gtest.h>

#include <random>

#include "exemplars/rayleigh.h"
#include "exemplars/stiffening.h"
#include "exemplars/voce.h"
#include "exemplars/wearing_joint.h"
#include "laws/laws.h"

namespace fissure::exemplar {
namespace {

static_assert(is_bulk_law<Stiffening> && is_flow_law<VoceFlow> && is_joint_law<WearingJoint> && Damping<Rayleigh>);

TEST(Exemplar, BulkLawTakesItsOwnConstants) {  // laws_test.cpp holds it to what any bulk law must do
  Stiffening law;
  law.bulk_modulus = 30e9, law.shear_modulus = 20e9, law.prepare();
  EXPECT_DOUBLE_EQ(law.bulk(), 30e9);
  EXPECT_DOUBLE_EQ(law.shear(), 20e9);
  auto const pressure = [&](double j) {
    double const stretch = std::cbrt(1 + j) - 1;
    Mat<double, 3> const H = stretch * Mat<double, 3>::Identity();
    return law.kirchhoff(H, j).trace() / 3 / (1 + j) / j;
  };
  EXPECT_NEAR(pressure(1e-5) / law.bulk(), 1, 1e-4);
  EXPECT_GT(pressure(-0.3) - pressure(-1e-5), law.lame());  // 2 s j^2 = 1.8
}

TEST(Exemplar, HardeningGivesItsSlopes) {
  Voce law;
  law.first = 100e6, law.last = 300e6;
  for (double const strain : {0.0, 0.01, 0.2}) {
    double const step = 1e-7,
                 slope = (law.yield(strain + step, 1.0, 0.0).stress - law.yield(strain, 1.0, 0.0).stress) / step;
    EXPECT_NEAR(law.yield(strain, 1.0, 0.0).per_strain / slope, 1, 1e-5) << strain;
    EXPECT_GE(law.yield(strain, 1.0, 0.0).stress, law.at_least(strain, 0.0));
  }
}

TEST(Exemplar, JointRemembersItsWay) {
  WearingJoint law;
  law.tension = 3e6, law.shear = 10e6, law.G1 = 20, law.G2 = 50, law.penalty = 1e12, law.prepare();
  double const k = 1e15, end = 3e-6;
  auto const slide = [&](double wear, int turns) {
    law.wear = wear;
    WearingJoint::History<double> history;
    JointEnergy<double> energy{};
    double taken = 0, least = 0;
    for (int i = 0; i <= 1000 * turns; ++i) {
      double const slip = end * std::abs(std::sin(i * std::numbers::pi / 1000));
      double const before = history.damage;
      law.soften(k, 0.0, slip, history, energy);
      taken += energy.dissipated, least = std::min(least, energy.dissipated);
      EXPECT_GE(history.damage, before);
    }
    EXPECT_GE(least, 0) << wear;  // whatever wears: no path gives energy
    return std::pair{history.way, taken};
  };
  auto const [way, taken] = slide(0, 3);
  EXPECT_NEAR(way, 6 * end, 0.02 * end);                  // less what it slid before the peak
  EXPECT_NEAR(slide(0, 9).second, taken, 1e-12 * taken);  // plain joints lose nothing more on the same way
  EXPECT_GT(slide(1e5, 9).second, 1.05 * taken);
  std::vector<double> kept(WearingJoint::History<double>::numbers);
  WearingJoint::History<double> const some{{0.5, 1, 2}, 3, 4};
  some.write([&](int i, double value) { kept[i] = value; });
  EXPECT_EQ(kept, (std::vector<double>{0.5, 1, 2, 3, 4}));
  EXPECT_EQ(WearingJoint::History<double>::read([&](int i) { return kept[i]; }).way, 3);
}

TEST(Exemplar, DampingOnlyTakes) {
  Rayleigh law;
  law.solid.young = 50e9, law.solid.poisson = 0.25, law.beta = 1e-6;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> x(-1, 1);
  for (int i = 0; i < 100; ++i) {
    Mat<double, 3> rate;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b <= a; ++b) rate(a, b) = rate(b, a) = x(random);
    double const power = law.kirchhoff(rate, 0.1).cwiseProduct(rate).sum();
    EXPECT_GT(power, 0);
    EXPECT_LE(power, 1.1 * law.per_squared_frequency(0) * 3 * law.solid.confined() * rate.squaredNorm());
  }
}

}  // namespace
}  // namespace fissure::exemplar
