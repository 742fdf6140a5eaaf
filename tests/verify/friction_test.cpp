// Ladder D, friction in motion: D9 and D11. Single pairs, joints and crack faces along random closed paths are
// tests/unit/friction_test.cpp.
#include "rig.h"

namespace fissure::verify {
namespace {

#if FISSURE_D == 2
constexpr double sizes[] = {1.4, 1.0, 0.8};  // [mm]
#else
constexpr double sizes[] = {2.0, 1.7, 1.5};  // at 2.5 mm two facets meet aslant and the balls do slip
#endif

/// Two balls of R = 4 mm that meet head-on along an inclined line, or one and what is given as its counterpart. Share
/// of the energy that friction took; `rebound` is the speed of the first over the one it came with.
struct Meeting {
  double taken = 0, rebound = 0, residual = 0;
};
Meeting meet_head_on(double size, double other_size, double mu) {
  Rig<> rig;
  auto stuff = material({50 * GPa, 0.2, 2500});
  stuff.contact = laws::ContactLaw{5 * GPa, mu};
  rig.add_material(stuff);
  double const R = 4 * mm, v = 6;
  Vec3 const line = Vec3(std::sin(0.3), std::cos(0.3), 0);
  rig.add_body({scene::Ball{line * (R + 0.005 * mm), R}, {}}, size * mm, false);
  rig.add_body({scene::Ball{line * (-R - 0.005 * mm), R}, {}}, other_size * mm, false);
  for (int b : {0, 1})
    for (int c = 0; c < D; ++c) rig.scene.bodies[b].velocity[c] = (b ? v : -v) * line[c];
  auto& solver = rig.start();
  double const energy = rig.kinetic();
  rig.run_for(70 * us);
  solver.evaluate();
  Meeting met;
  for (int c = 0; c < D; ++c) met.rebound += solver.now().mean_velocity(0)[c] * line[c] / v;
  met.taken = solver.now().energy("friction") / energy, met.residual = solver.now().energy("residual") / energy;
  std::printf("edges %.1f and %.1f mm, mu %g: rebound %.4f, friction took %.2e, residual %.1e\n", size, other_size, mu,
              met.rebound, met.taken, met.residual);
  return met;
}

/// Nothing slips by symmetry, so friction takes nothing, on any mesh; what is missing in the rebound rings in the
/// balls.
TEST(Verify, D11_BallsHeadOnDoNotRub) {
  for (double size : sizes) {
    double const smooth = meet_head_on(size, size, 0).rebound;
    for (double mu : {0.1, 0.6, 10.0}) {
      auto const met = meet_head_on(size, size, mu);
      EXPECT_LT(met.taken, 0.005);
      EXPECT_GT(met.rebound, smooth - 0.005);  // without friction facets that lean push a little to the side
      EXPECT_NEAR(met.residual, 0, 1e-3);
    }
  }
  // Meshes that do not match lean by the angle between their faces.
  EXPECT_LT(meet_head_on(sizes[0], sizes[1], 0.6).taken, 0.01);
}

/// Two blocks that can crack meet aslant, one turned, so that joints soften, rub, break, and their pieces slide.
/// Friction takes energy and gives none, at any coefficient: the balance closes to what the step costs without
/// friction.
struct Crash {
  double residual = 0, taken = 0;
  bool fell = false;  // what friction and fracture have taken
};
void set_crash(Rig<>& rig, double mu, double safety) {
  auto stuff = material({40 * GPa, 0.22, 2600});
  auto law = joint(4 * MPa, 8 * MPa, 8, 10, 400 * GPa);
  law.residual = mu;
  stuff.joint = law;
  stuff.contact = laws::ContactLaw{40 * GPa, mu};
  rig.add_material(stuff);
  double const L = 9 * mm;
  rig.add_box({0, -L / 2, 0}, {1.3 * L, L, L}, L / (flat ? 4 : 3));
  rig.add_box({1.5 * mm, L / 2 + 0.01 * mm, 0.4 * mm}, {L, L, L}, L / (flat ? 4 : 3));
  rig.scene.bodies[1].velocity = {2, -6, 0};
  rig.scene.run.safety = safety;
}
Crash crash(double mu, double safety) {
  Rig<> rig;
  set_crash(rig, mu, safety);
  auto& solver = rig.start();
  double const energy = rig.kinetic();
  Crash crash;
  double before = 0;
  while (true) {
    solver.evaluate();
    double const taken = solver.now().energy("friction") + solver.now().energy("fracture");
    crash.fell = crash.fell || taken < before - 1e-9 * energy;
    before = taken;
    if (solver.time() > 14 * us) break;
    solver.advance();
  }
  crash.residual = solver.now().energy("residual") / energy, crash.taken = before / energy;
  std::printf("mu %g, step %g of the limit: friction and fracture took %.3f, %ld joints broke, residual %.1e\n", mu,
              safety, crash.taken, solver.now().broken_joints(), crash.residual);
  return crash;
}

TEST(Verify, D11_FrictionOfBreakingJointsMakesNoEnergy) {
  double const smooth = std::abs(crash(0, 0.3).residual);
  for (double mu : {0.3, 1.0, 3.0, 10.0}) {
    auto const one = crash(mu, 0.3);
    EXPECT_LT(std::abs(one.residual), 2e-3 + 2 * smooth) << mu;
    EXPECT_FALSE(one.fell) << mu;
  }
}

/// A restart knows the springs of pairs, joints and cracks, and which forces make up one contact.
TEST(Verify, D11_RestartAmidFriction) {
  Rig<> one, other;
  for (Rig<>* rig : {&one, &other}) set_crash(*rig, 0.7, 0.8), rig->start();
  while (one.solver->now().broken_joints() == 0 && one.solver->time() < 60 * us) one.run_for(6 * us);
  EXPECT_GT(one.solver->now().broken_joints(), 0);
  other.solver->restore(one.solver->save());
  for (int i = 0; i < 150; ++i) one.step(), other.step();
  EXPECT_GT(one.solver->now().energy("friction"), 0);
  EXPECT_EQ(one.solver->now().energy("friction"), other.solver->now().energy("friction"));
  auto const state = one.solver->save(), again = other.solver->save();
  EXPECT_EQ(state.size(), again.size());
  for (auto const& [name, bytes] : state) EXPECT_TRUE(bytes == again.at(name)) << name;
}

/// A block that is pressed, and slid apart at 20 m/s along its joints, far beyond the reach of crack faces. What
/// contacts gave back beyond what they took would be energy out of nothing. (Stiff contacts that chatter at the
/// automatic step are good for some tenths of a per cent.)
TEST(Verify, D9_PressedSlideMakesNoEnergy) {
  Rig<> rig;
  Stuff const weak{5 * GPa, 0.25, 2700};
  auto stuff = material(weak);
  auto law = joint(50 * MPa, 5 * MPa, 2000, 30, weak.young);
  law.residual = 0.3;
  stuff.joint = law;
  stuff.contact = laws::ContactLaw{weak.young, 0.3};
  rig.add_material(stuff);
  rig.add_box({0, 0, 0}, {8 * mm, 4 * mm, 4 * mm}, 2 * mm);
  rig.hold(0, place("bottom"), still());
  rig.hold(0, place("top"), {constant(20), of_time([](double t) { return t < 5 * us ? -10.0 : 0.0; }), constant(0)});
  // Blocks interlock and are pressed far into each other: what is lost there comes down to 1.8 % of the work with the
  // step (hexahedra).
  if (test_cells()[0] == "block") rig.scene.run.safety = 0.2;
  auto& solver = rig.start();
  double least = 0, most = 0;
  bool released = false;
  while (solver.time() < 60 * us) {
    solver.evaluate();
    double const held = solver.contact().work().stored();
    least = std::min(least, held);
    most = std::max(most, held);
    released = released || solver.largest_penetration() > 0;
    solver.advance();
  }
  double const external = solver.now().energy("external");
  std::printf("of the external work, contacts hold %.4f at least, %.4f at most; residual %.4f\n", least / external,
              most / external, solver.now().energy("residual") / external);
  EXPECT_TRUE(released);
  EXPECT_GT(least, -0.01 * external);
  EXPECT_LT(std::abs(solver.now().energy("residual")), 0.02 * external);
}

}  // namespace
}  // namespace fissure::verify
