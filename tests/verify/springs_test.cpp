// Springs between points (spring{}): force, energy, breaking, the step.
#include "rig.h"

namespace fissure::verify {
namespace {

/// A block on a spring from a place that stands still, which pulls it upwards.
void set_pendulum(Rig<>& rig, double stiffness, double damping = 0, double strength = INFINITY) {
  rig.add_material(material(rock));
  rig.add_box({0, 0, 0}, {0.1, 0.1, 0.1}, 0.05);
  rig.scene.out_of_plane = 0.1;
  scene::Spring spring;
  spring.name = "rope", spring.bodies = {0, -1};
  spring.at = {Vec3(0, 0.05, 0), Vec3(0, 1.05, 0)};
  spring.stiffness = stiffness, spring.damping = damping, spring.strength = strength;
  rig.scene.springs.push_back(spring);
}
constexpr double mass = 2700 * 0.1 * 0.1 * 0.1;

/// Let go, the block swings up and down about the place where its weight is held: y = -(g/w^2) (1 - cos w t).
TEST(Verify, L1_AWeightOnASpringSwings) {
  Rig<> rig;
  double const k = 2e6, g = 1000, omega = std::sqrt(k / mass);  // a millimetre, and a swing of 7 ms
  set_pendulum(rig, k);
  rig.scene.gravity = {0, -g, 0};
  rig.start();
  double worst = 0, residual = 0;
  while (rig.solver->time() < 1.1 * 2 * std::numbers::pi / omega) {
    rig.step();
    double y = 0;
    auto const u = rig.solver->model().vertices.u.download();
    for (Index i = 0; i < rig.solver->model().vertices.count; ++i)
      y += rig.solver->model().vertices.mass[i] / mass * u[static_cast<std::size_t>(i) * D + 1];
    double const swing = g / (omega * omega);
    worst = std::max(worst, std::abs(y + swing * (1 - std::cos(omega * rig.solver->time()))) / swing);
    rig.solver->evaluate();
    auto const& ledger = rig.solver->energies();
    residual = std::max(residual, std::abs(ledger.residual()) / (mass * g * 2 * swing));
  }
  // The spring pulls at one point, which the block yields to: it is softer by F/(E h), 3 % of k here, 1.5 % of the
  // period.
  EXPECT_LT(worst, 0.12);
  EXPECT_LT(residual, 1e-3);
}

/// Taut from the start between two ends of a bar: it is pressed by k (length - free), less what it gives way.
TEST(Verify, L2_ATautRopePressesABar) {
  Rig<> rig;
  rig.add_material(material(rock));
  double const L = 1, a = 0.1, k = 1e6, short_by = 1e-3;
  rig.add_box({0, 0, 0}, {L, a, a}, 0.05);
  rig.scene.out_of_plane = a;
  scene::Spring rope;
  rope.name = "rope", rope.bodies = {0, 0}, rope.at = {Vec3(-L / 2, 0, 0), Vec3(L / 2, 0, 0)};
  rope.stiffness = k, rope.length = L - short_by, rope.slack = true;
  rig.scene.springs.push_back(rope);
  rig.come_to_rest(L, rock.bar(), 12);
  rig.solver->evaluate();
  double const bar = rock.young * a * a / L, pull = short_by / (1 / k + 1 / bar);
  EXPECT_NEAR(rig.solver->springs().pull(0) / pull, 1, 0.01);  // its ends are points, which sink in by 1 % of 1/k
  auto const& ledger = rig.solver->energies();
  EXPECT_LT(std::abs(ledger.residual()), 1e-3 * 0.5 * k * short_by * short_by);
}

/// Pulled beyond its strength it breaks, and the ledger says what it held; a damper takes what it is asked for.
TEST(Verify, L3_ItBreaksAndDampersTake) {
  for (bool const breaks : {true, false}) {
    Rig<> rig;
    double const k = 2e6, v = 1, omega = std::sqrt(k / mass);
    double const strength = breaks ? 0.5 * k * v / omega : INFINITY;
    set_pendulum(rig, k, breaks ? 0 : 2 * mass * omega, strength);
    rig.scene.bodies[0].velocity = {0, -v, 0};
    rig.start();
    rig.run_for(4 / omega);
    State const middle = rig.solver->save();
    rig.run_for(4 / omega);
    rig.solver->evaluate();
    auto const& ledger = rig.solver->energies();
    double const whole = 0.5 * mass * v * v;
    EXPECT_LT(std::abs(ledger.residual()), 2e-3 * whole);
    EXPECT_EQ(rig.solver->springs().broken(0), breaks);
    if (breaks) {
      EXPECT_NEAR(ledger.spring_lost, 0.5 * strength * strength / k, 0.01 * whole);
      EXPECT_EQ(rig.solver->springs().pull(0), 0);
      EXPECT_EQ(ledger.spring, 0);
    } else {  // critically damped: (1 + w t) exp(-w t) of it is left, of energy its square
      EXPECT_NEAR(ledger.spring_lost / whole, 1, 0.01);
    }
    rig.solver->advance();
    Rig<> other;
    set_pendulum(other, k, breaks ? 0 : 2 * mass * omega, strength);
    other.scene.bodies[0].velocity = {0, -v, 0};
    other.start();
    other.solver->restore(middle);
    while (other.solver->step() + 1 < rig.solver->step()) other.step();
    other.solver->evaluate();
    other.solver->energies();
    other.solver->advance();
    EXPECT_TRUE(other.solver->save() == rig.solver->save());
  }
}

/// However stiff it is, and whatever it hangs on: the step follows it.
TEST(Verify, L4_TheStepFollowsIt) {
  for (double const stiffness : {1e6, 1e10, 1e13}) {
    Rig<> rig;
    set_pendulum(rig, stiffness);
    rig.scene.springs.push_back(rig.scene.springs[0]);  // a second one beside it
    rig.scene.bodies[0].velocity = {0, -0.01, 0};
    rig.start();
    double worst = 0;
    double const whole = 0.5 * mass * 1e-4;
    for (int k = 0; k < 3000; ++k) {
      rig.step();
      if (k % 10 != 0) continue;
      rig.solver->evaluate();
      worst = std::max(worst, std::abs(rig.solver->energies().residual()) / whole);
    }
    EXPECT_LT(worst, 0.01) << stiffness;
    if (stiffness > 1e12) {
      EXPECT_NE(rig.solver->step_limit().owner.find("spring"), std::string::npos);
    }
  }
}

/// It pulls at the very point that was asked for, wherever nodes are: with no moment about it; outside is refused.
TEST(Verify, L5_ItHangsAtItsPoint) {
  Rig<> rig;
  rig.add_material(material(rock));
  rig.add_box({0, 0, 0}, {0.1, 0.1, 0.1}, 0.05);
  rig.scene.out_of_plane = 0.1;
  Vec3 const point(0.013, 0.021, flat ? 0 : -0.017);
  scene::Spring rope;
  rope.name = "rope", rope.bodies = {0, -1}, rope.at = {point, point + Vec3(0.3, 0.4, 0)};
  rope.stiffness = 1e6, rope.length = 0.4;
  rig.scene.springs.push_back(rope);
  rig.start();
  EXPECT_LT((rig.solver->springs().end(0, 0) - point).norm(), 1e-12);
  rig.solver->evaluate();
  auto const force = rig.solver->model().vertices.force.download();
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  for (Index i = 0; i < rig.solver->model().vertices.count; ++i) {
    if (!(rig.solver->model().vertices.mass[i] > 0)) continue;
    Vec3 f = Vec3::Zero(), arm = -point;
    for (int c = 0; c < D; ++c) f[c] = force[static_cast<std::size_t>(i) * D + c], arm[c] += rig.place_of(i)[c];
    for (int c = D; c < 3; ++c) arm[c] = 0;
    sum += f, moment += arm.cross(f);
  }
  EXPECT_LT((sum - 1e5 * Vec3(0.6, 0.8, 0)).norm(), 1e-6);  // 0.1 m longer than free
  EXPECT_LT(moment.norm(), 1e-7);
  Rig<> outside;
  outside.add_material(material(rock));
  outside.add_box({0, 0, 0}, {0.1, 0.1, 0.1}, 0.05);
  rope.at[0] = Vec3(0.2, 0, 0);
  outside.scene.springs.push_back(rope);
  EXPECT_THROW(outside.start(), Error);
}

}  // namespace
}  // namespace fissure::verify
