// Bodies that bonds join: as one while the bond holds, by the bond's own law when it breaks, as any two afterwards.
#include "rig.h"

namespace fissure::verify {
namespace {

/// A bar along x of two bodies, n cells a side, pulled to the right at the end of the second.
struct Bar : Rig<> {
  static constexpr double h = 10 * mm, length = 80 * mm;
  double side, area;

  Bar(double first, double second, std::optional<laws::CohesiveJoint> bond, laws::CohesiveJoint inside, int n = 2)
      : side(n * h), area(side * side) {
    cell_name = "simplex";  // bonds are for simplices
    scene.out_of_plane = side;
    for (double const young : {first, second}) {
      auto stuff = material({young, 0, 2700});
      stuff.joint = inside;
      add_material(stuff);
    }
    if (!bond) add_box({0, 0, 0}, {length, side, side}, h);
    if (bond)
      add_box({-length / 4, 0, 0}, {length / 2, side, side}, h),
          add_box({length / 4, 0, 0}, {length / 2, side, side}, h, 1);
    if (bond) scene.bonds.push_back({"glue", {}, {0, 1}, *bond, {}, {}});
    scene.contact = true;
  }
  int last() const { return static_cast<int>(scene.bodies.size()) - 1; }
};

/// The joint's own stiffness, law and order of sums are those of joints inside: only rounding may differ.
TEST(Verify, C6_BondedBodiesAreOne) {
  auto const moved = [](bool bonded) {
    auto const law = unbreakable(1000 * GPa);
    Bar bar(50e9, 50e9, bonded ? std::optional(law) : std::nullopt, law);
    bar.hold(0, place("left"), still());
    bar.pull(bar.last(), place("right"), {constant(1 * MPa), constant(0.3 * MPa), constant(0.2 * MPa)});
    bar.start();
    bar.run_for(100 * us);
    bar.solver->evaluate();
    return std::pair{bar.solver->now().displacement(bar.last(), {Bar::length / 2, Bar::h, Bar::h}),
                     bar.solver->now().energy("joint")};
  };
  auto const one = moved(false), two = moved(true);
  EXPECT_GT(one.first.norm(), 1e-6);
  EXPECT_LT((one.first - two.first).norm(), 1e-9 * one.first.norm());
  EXPECT_NEAR(two.second, one.second, 1e-9 * one.second);
}

TEST(Verify, C6_BondBreaksByItsOwnLaw) {
  double const strength = 2 * MPa, G = 20;
  auto bond = joint(strength, 10 * strength, G, 4 * G, 500 * GPa);
  bond.opens = bond.slides = laws::Softening::linear();
  bond.prepare();
  Bar bar(50e9, 20e9, bond, joint(5 * strength, 50 * strength, 50 * G, 50 * G, 1000 * GPa), 1);
  // It is pulled apart, pushed back, and pulled again.
  double const slow = 20 * mm;
  auto const speed = [=](double t) { return slow * (t < 1.5e-3 ? std::min(1.0, t / 0.5e-3) : t < 2.75e-3 ? -2 : 2); };
  bar.hold(0, place("left"), along(0, constant(0)));
  bar.hold(1, place("right"), along(0, of_time(speed)));
  bar.scene.run.mass_damping = 1e4;
  bar.start();
  auto& solver = *bar.solver;
  double most = 0, least = 0, last = 0;
  while (solver.time() < 3.75e-3) {
    solver.evaluate();
    double const force =
        -solver.now().reaction(0)[0];  // where nothing moves, so that neither inertia nor damping is in it
    if (solver.time() < 1.5e-3) most = std::max(most, force);
    least = std::min(least, force), last = force;
    solver.advance();
  }
  solver.evaluate();
  EXPECT_NEAR(most, strength * bar.area,
              std::sqrt(2700 * 20e9) * slow * bar.area);  // a wave of the drive, rho c v, passes while it breaks
  EXPECT_NEAR(solver.now().crack_area(), bar.area, 1e-9 * bar.area);
  EXPECT_NEAR(solver.now().energy("fracture"), G * bar.area, 5e-3 * G * bar.area);
  EXPECT_LT(least, -0.2 * strength * bar.area);          // the broken faces press
  EXPECT_LT(std::abs(last), 0.1 * strength * bar.area);  // and hold nothing
  EXPECT_LT(std::abs(solver.now().energy("residual")), 1e-3 * solver.now().energy("external"));
}

/// A patch that the bond leaves out presses like the rest.
TEST(Verify, C6_WhatABondLeavesOutPresses) {
  for (bool patch : {false, true}) {
    auto const law = unbreakable(1000 * GPa);
    Bar bar(30e9, 30e9, law, law, 4);
    if (patch)
      bar.scene.bonds[0].inside = [](double, double y, double z) {
        return std::abs(y) > 10 * mm || std::abs(z) > 10 * mm;
      };
    bar.roller(0, "left", 0);
    bar.press(1, place("right"), of_time([](double t) { return 10 * MPa * std::min(1.0, t / (100 * us)); }));
    bar.scene.run.mass_damping = 1e5;
    bar.start();
    bar.run_for(300 * us);
    bar.solver->evaluate();
    double worst = 0;
    for (double y : {-15, -5, 5, 15})
      for (double z : {-15, -5, 5, 15})
        worst = std::max(
            worst, std::abs(bar.solver->now().stress(1, {5 * mm, y * mm, (flat ? 0 : z) * mm})[0] / (-10 * MPa) - 1));
    EXPECT_LT(worst, 0.02) << patch;
    EXPECT_EQ(bar.solver->now().broken_joints() > 0, patch);
  }
}

/// A hold of one body does not hold the other where their nodes are twins.
TEST(Verify, C6_HoldsAreOfTheirBody) {
  auto const law = unbreakable(1000 * GPa);
  Bar bar(50e9, 50e9, law, law);
  bar.hold(0, where([](double, double, double) { return true; }), still());
  bar.start();
  auto const held = bar.solver->model().holds.at(0).list.size();
  EXPECT_EQ(held, static_cast<std::size_t>(bar.mesh.body_first_cell[1]) * C);
}

/// Two unlike bodies, glued, in a motion that no symmetry helps.
struct Whirl : Bar {
  Whirl()
      : Bar(50e9, 20e9, joint(2 * MPa, 4 * MPa, 20, 40, 500 * GPa), joint(20 * MPa, 60 * MPa, 100, 300, 1000 * GPa)) {
    scene.bodies[1].velocity_at = [](double x, double y, double z) {
      return std::array{2 + 10 * y, 1 - 20 * x + 3 * z, flat ? 0 : 5 * y};
    };
    start();
  }
  V momentum() const {
    auto const v = solver->model().vertices.v.download();
    auto const& mass = solver->model().vertices.mass;
    V sum = V::Zero();
    for (std::size_t i = 0; i < mass.size(); ++i)
      for (int c = 0; c < D; ++c) sum[c] += mass[i] * v[i * D + c];
    return sum;
  }
};

TEST(Verify, C6_BondedBodiesKeepMomentum) {
  Whirl pair;
  V const before = pair.momentum();
  pair.run_for(200 * us);
  pair.solver->evaluate();
  EXPECT_GT(pair.solver->now().broken_joints(), 0);
  EXPECT_LT((pair.momentum() - before).norm(), 1e-10 * before.norm());
  EXPECT_LT(std::abs(pair.solver->now().energy("residual")), 5e-3 * pair.solver->now().energy("kinetic"));
}

TEST(Verify, C6_BondedBodiesGoOnFromAState) {
  Whirl one, other;
  one.run_for(100 * us);
  other.solver->restore(one.solver->save());
  one.run_for(50 * us), other.run_for(50 * us);
  EXPECT_GT(one.solver->now().broken_joints(), 0);
  EXPECT_EQ(one.solver->save(), other.solver->save());
}

}  // namespace
}  // namespace fissure::verify
