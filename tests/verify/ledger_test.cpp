// The ledger of energy where contact begins or ends within a step, and where it holds energy before anything has moved.
#include "rig.h"

namespace fissure::verify {
namespace {

using Velocity = std::array<double, 3>;

/// A soft damped block on a hold; a plate presses it slowly for 0.2 ms, then moves as told for some time and stays
/// where it is.
struct Pressed {
  double residual, contact, work;  // at the end; the largest external work [J]
};

Pressed pressed_then(Velocity const& then, double how_long) {
  Rig<> rig;
  auto stuff = material({5 * GPa, 0.2, 2500});
  stuff.critical_share = 0.1;
  stuff.contact = laws::ContactLaw{5 * GPa, 0.4};
  rig.add_material(stuff);
  double const L = 10 * mm, pressing = 200 * us;
  rig.add_box({0, 0, 0}, {L, L, L}, L / 4);
  rig.scene.out_of_plane = L;
  rig.hold(0, place("bottom"), still());
  scene::Directions velocity;
  for (int c = 0; c < 3; ++c)
    velocity[c] = of_time([=](double t) {
      return t < pressing ? (c == 1 ? -0.1 : 0) : t < pressing + how_long ? then[c] : 0;
    });
  rig.scene.plates.push_back({"plate", {}, {{0, 0.75 * L, 0}, {4 * L, L / 2, 4 * L}}, velocity, {}});
  auto& solver = rig.start();
  double most = 0;
  while (solver.time() < 1.5 * pressing) {
    solver.evaluate();
    if (solver.step() % 10 == 0 || solver.time() > pressing)
      most = std::max(most, std::abs(solver.now().energy("external")));
    solver.advance();
  }
  solver.evaluate();
  std::printf("plate then at %g, %g m/s: residual %.2e of the largest work %.2e J, contact %.2e\n", then[0], then[1],
              solver.now().energy("residual") / most, most, solver.now().energy("contact") / most);
  return {solver.now().energy("residual"), solver.now().energy("contact"), most};
}

constexpr double warned_of = 0.05;  // the share of a run's balance above which it is not to be trusted

/// However fast it leaves: the force acts along the overlap only, not along the way of the step.
TEST(Ledger, APlateTornAwayTakesOutWhatContactHeld) {
  for (double v : {1.0, 10.0, 100.0, 1000.0})
    for (auto const& then : {Velocity{0, v, 0}, Velocity{v, v, 0}, Velocity{-v, 0.01 * v, 0}}) {
      auto const end = pressed_then(then, 1);
      EXPECT_LT(std::abs(end.residual), warned_of * end.work) << then[0] << ", " << then[1];
      EXPECT_LT(end.contact, warned_of * end.work) << then[0] << ", " << then[1];
    }
}

/// Rubbing at any speed goes to the slider.
TEST(Ledger, APlatePulledSidewaysKeepsTheBalance) {
  for (double v : {1.0, 10.0, 100.0, 1000.0}) {
    auto const end = pressed_then({v, 0, 0}, 10 * us);
    EXPECT_LT(std::abs(end.residual), warned_of * end.work) << v;
  }
}

/// By 0.2 mm, an edge's twelfth, in five steps or many. In a single step (1000 m/s) the trapezoid of so steep a force
/// is off by 8 %.
TEST(Ledger, APlateDrivenInKeepsTheBalance) {
  for (double v : {1.0, 10.0, 80.0}) {
    auto const end = pressed_then({0, -v, 0}, 0.2 * mm / v);
    EXPECT_LT(std::abs(end.residual), warned_of * end.work) << v;
  }
}

/// Lists of contacts end with the contacts: the plate's force must end too.
TEST(Ledger, APlateThatIsGoneFeelsNoForce) {
  Rig<> rig;
  rig.add_material(material(rock));
  rig.add_box({0, 0, 0}, {4 * mm, 4 * mm, 4 * mm}, 2 * mm);
  rig.scene.plates.push_back(
      {"plate", {}, {{0, 2.999 * mm, 0}, {6 * mm, 2 * mm, 6 * mm}}, along(1, constant(20000)), {}});
  auto& solver = rig.start();
  solver.evaluate();
  EXPECT_GT(solver.now().plate_force(0)[1], 0);
  solver.advance();
  solver.evaluate();
  EXPECT_EQ(solver.now().plate_force(0)[1], 0);
}

enum class Partner { body, plate, wall };

/// A block that begins 5 % of an edge deep in something and is pushed out.
void set_overlapping(Rig<>& rig, Partner partner, double friction) {
  auto stuff = material(rock);
  stuff.contact = laws::ContactLaw{rock.young, friction};
  rig.add_material(stuff);
  double const L = 10 * mm, depth = 0.05 * L / 4;
  rig.add_box({0, 0, 0}, {L, L, L}, L / 4);
  Vec3 const below(0.3 * mm, depth - L, 0.2 * mm);
  if (partner == Partner::body) rig.add_box(below, {1.5 * L, L, 1.5 * L}, L / 4);
  if (partner == Partner::plate) rig.scene.plates.push_back({"plate", {}, {below, {2 * L, L, 2 * L}}, still(), {}});
  if (partner == Partner::wall) rig.scene.walls.push_back({"wall", {}, {0, depth - L / 2, 0}, {0, 1, 0}, {}});
  rig.start();
}

TEST(Ledger, StartsWithWhatOverlapsHold) {
  for (auto partner : {Partner::body, Partner::plate, Partner::wall})
    for (double friction : {0.0, 0.4}) {
      Rig<> rig, again;
      set_overlapping(rig, partner, friction), set_overlapping(again, partner, friction);
      auto& solver = *rig.solver;
      solver.evaluate();
      double const held = solver.now().energy("contact");
      EXPECT_GT(held, 0);
      EXPECT_NEAR(solver.now().energy("residual"), 0, 1e-12 * held);
      rig.run_for(2 * us);
      again.solver->restore(solver.save());
      for (Rig<>* one : {&rig, &again}) one->run_for(20 * us), one->solver->evaluate();
      double const residual = solver.now().energy("residual"), kinetic = solver.now().energy("kinetic");
      std::printf("held %.3e J at the start; kinetic %.3e J, contact %.1e, residual %.1e of it\n", held, kinetic,
                  solver.now().energy("contact") / kinetic, residual / kinetic);
      EXPECT_LT(std::abs(residual), warned_of * kinetic);
      EXPECT_EQ(again.solver->now().energy("residual"), residual) << "restarted";
    }
}

/// Blocks meet so fast that a step without contact would take them through the gap and far into each other.
TEST(Ledger, AFirstTouchIsForeseen) {
  for (double gap : {0.01, 0.02, 0.3}) {
    Rig<> rig;
    auto stuff = material<laws::NeoHookean>({10 * MPa, 0.3, 1000});
    stuff.contact = laws::ContactLaw{20 * MPa, 0};
    rig.add_material(stuff);
    rig.add_box({0, 0, 0}, {1, 1, 1}, 0.34);
    rig.add_box({0.13, 1 + gap, 0}, {1, 1, 1}, 0.34);
    double const v = 0.2 * std::sqrt(10 * MPa / 1000);
    rig.scene.bodies[1].velocity_at = [=](double, double, double) { return std::array<double, 3>{0, -v, 0}; };
    auto& solver = rig.start();
    double const given = 0.5 * 1000 * v * v * rig.mass() / 2000;
    rig.run_for(0.03);
    solver.evaluate();
    std::printf("gap %g: residual %.2e of the impact\n", gap, solver.now().energy("residual") / given);
    EXPECT_LT(std::abs(solver.now().energy("residual")), warned_of * given) << gap;
  }
}

/// A block that rattles in a box: every contact shrinks the step, and it grows back slowly. Grown back at once, the
/// same block gains 9 %, for leapfrog keeps another energy with every step.
TEST(Ledger, ARattlingBlockGainsNothing) {
  Rig<> rig;
  auto stuff = material({100 * MPa, 0.3, 1000});
  stuff.contact = laws::ContactLaw{1 * GPa, 0};
  rig.add_material(stuff);
  rig.add_box({0, 0, 0}, {1, 1, 1}, flat ? 0.25 : 0.34);
  for (double side : {1, -1}) {
    rig.scene.walls.push_back({"", {}, {0, -0.8 * side, 0}, {0, side, 0}, {}});
    rig.scene.walls.push_back({"", {}, {-0.75 * side, 0, 0}, {side, 0, 0}, {}});
  }
  rig.scene.bodies[0].velocity = {1.5, -5, 0};
  auto& solver = rig.start();
  solver.evaluate();
  double const energy = solver.now().energy("kinetic"), first = solver.dt();
  double least = first;
  while (solver.time() < 1) solver.advance(), solver.evaluate(), least = std::min(least, solver.dt());
  double const left = solver.now().energy("kinetic") + solver.now().energy("elastic") +
                      solver.now().energy("hourglass") + std::max(solver.now().energy("contact"), 0.0);
  std::printf("least step %.2f of the first; gained %.1e, residual %.1e of the energy\n", least / first,
              left / energy - 1, solver.now().energy("residual") / energy);
  EXPECT_LT(least, 0.5 * first);
  EXPECT_NEAR(left / energy, 1, 0.025);  // from there on a verdict says so
}

}  // namespace
}  // namespace fissure::verify
