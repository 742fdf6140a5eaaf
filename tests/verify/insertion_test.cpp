// Joints inserted on demand: a body is whole until it reaches its strength, and a joint takes over what was carried.
#include <map>
#include <numeric>
#include <set>

#include "rig.h"

namespace fissure::verify {
namespace {

/// A bar along x, 8 by 2 cells, whose middle plane has a fifth of the strength of all others.
struct Notched : Rig<> {
  static constexpr double h = 5 * mm, length = 8 * h, side = 2 * h, strength = 0.2;
  double const area = side * side;
  laws::CohesiveJoint law;

  explicit Notched(double penalty, bool rankine = true, double angle = 0) {
    auto stuff = material(rock);
    law = joint(25 * MPa, 50 * MPa, 500, 1500, penalty * rock.young);
    law.opens = law.slides = laws::Softening::linear();
    law.friction_angle = angle, law.rankine = rankine, law.inserted = true;
    law.prepare();
    stuff.joint = law;
    add_material(stuff);
    scene.out_of_plane = side;
    scene.contact = true;
    add_box({0, 0, 0}, {length, side, side}, h);
    scene.joint_sets.push_back(
        {"plane", {}, 0, {}, [](double x, double, double) { return std::abs(x) < 1e-6; }, {}, 0, strength});
  }
  /// Moves both halves apart but for two layers of cells, slowly, along component c.
  void part(int c, double speed) {
    auto const velocity = [=](double sign) {
      auto motion = still();
      motion[c] = of_time([=](double t) { return sign * speed * std::min(1.0, t / (200 * us)); });
      return motion;
    };
    hold(0, where([](double x, double, double) { return x < -h / 2; }), velocity(-1));
    hold(0, where([](double x, double, double) { return x > h / 2; }), velocity(1));
  }
};

/// Until then nothing is softer and nothing opens, to the order of the sums of forces.
TEST(Verify, C7_BodyIsWholeUntilItReachesItsStrength) {
  auto const moved = [](bool jointed) {
    Rig<> rig;
    auto stuff = material(rock);
    if (jointed) {
      auto law = joint(1 * GPa, 2 * GPa, 1e6, 1e6, 2 * rock.young);
      law.inserted = true;
      stuff.joint = law;
    }
    rig.add_material(stuff);
    rig.add_box({0, 0, 0}, {40 * mm, 10 * mm, 10 * mm}, 5 * mm);
    rig.scene.run.dt = 1e-7;  // that of the body alone is longer
    rig.hold(0, place("left"), still());
    rig.pull(0, place("right"), {constant(10 * MPa), constant(3 * MPa), constant(2 * MPa)});
    rig.start();
    rig.run_for(100 * us);
    EXPECT_EQ(rig.solver->now().broken_joints(), 0);
    return std::pair{rig.solver->now().displacement(0, {20 * mm, 5 * mm, 5 * mm}), rig.solver->now().energy("joint")};
  };
  auto const one = moved(false), other = moved(true);
  EXPECT_GT(one.first.norm(), 1e-6);
  EXPECT_LT((one.first - other.first).norm(), 1e-10 * one.first.norm());
  EXPECT_LT(std::abs(other.second), 1e-20);
}

/// Strength and work to separation of one plane, in opening and in slip, whatever the penalty; no energy is made.
TEST(Verify, C7_InsertedJointTakesItsEnergy) {
  for (double const penalty : {2.0, 20.0})
    for (int const c : {0, 1}) {
      double const speed = 0.01;
      Notched bar(penalty);
      bar.part(c, speed);
      bar.start();
      double const f = Notched::strength * (c == 0 ? bar.law.tension : bar.law.shear),
                   G = Notched::strength * Notched::strength * (c == 0 ? bar.law.G1 : bar.law.G2);
      double peak = 0, turned_over = 0;
      while (bar.solver->time() < 1e-3 + 2.2 * G / f / (2 * speed) && bar.solver->now().broken_joints() == 0) {
        bar.run_for(1 * us);
        bar.solver->evaluate();
        peak = std::max(peak, std::abs(bar.solver->now().reaction(1)[c]));
        turned_over = std::max(turned_over, std::abs(bar.solver->now().energy("external")));
        EXPECT_LT(std::abs(bar.solver->now().energy("residual")), 1e-3 * turned_over);
        bar.solver->advance();
      }
      bar.run_for(20 * us);
      bar.solver->evaluate();
      std::printf("penalty %g E, component %d: peak %.4f, work %.4f of the law's\n", penalty, c, peak / (f * bar.area),
                  bar.solver->now().energy("fracture") / (G * bar.area));
      EXPECT_NEAR(bar.solver->now().energy("fracture"), G * bar.area, 0.005 * G * bar.area);
      EXPECT_NEAR(bar.solver->now().crack_area(), bar.area, 1e-6 * bar.area);
      // Loads vibrate and are asked every eighth step; corners of cells and, in slip, the free edges carry less.
      EXPECT_LT(peak, 1.02 * f * bar.area);
      EXPECT_GT(peak, (c == 0 ? 0.95 : 0.9) * f * bar.area);
    }
}

/// What presses a joint when it is inserted presses its faces when it has broken: slip takes G2 and no more.
TEST(Verify, C7_PressureOnAnInsertedJointTakesNothing) {
  double const pressure = 40 * MPa, speed = 0.01;  // p^2/(2 k) is a G2 here; below what shears the whole bar
  Notched bar(2);
  auto const press = 100 * us, rest = 200 * us;
  auto const velocity = [&](double sign) {
    auto motion = still();
    motion[0] = of_time([=](double t) { return t < press ? -sign * pressure / rock.young * Notched::h / press : 0.0; });
    motion[1] = of_time([=](double t) { return sign * speed * std::clamp((t - rest) / (200 * us), 0.0, 1.0); });
    return motion;
  };
  bar.hold(0, where([](double x, double, double) { return x < -Notched::h / 2; }), velocity(-1));
  bar.hold(0, where([](double x, double, double) { return x > Notched::h / 2; }), velocity(1));
  bar.scene.run.mass_damping = 1e5;
  bar.start();
  double const f = Notched::strength * bar.law.shear, G = Notched::strength * Notched::strength * bar.law.G2;
  double turned_over = 0, pressed = 0;
  while (bar.solver->time() < rest + 1e-3 + 2.2 * G / f / (2 * speed) && bar.solver->now().broken_joints() == 0) {
    bar.run_for(1 * us);
    bar.solver->evaluate();
    if (bar.solver->time() < rest) pressed = bar.solver->now().reaction(0)[0] / bar.area;
    turned_over = std::max(turned_over, std::abs(bar.solver->now().energy("external")));
    bar.solver->advance();
  }
  bar.run_for(20 * us);
  bar.solver->evaluate();
  std::printf("pressure %.4f MPa before, %.4f after; work %.4f of the law's\n", pressed / MPa,
              bar.solver->now().reaction(0)[0] / bar.area / MPa, bar.solver->now().energy("fracture") / (G * bar.area));
  EXPECT_NEAR(bar.solver->now().energy("fracture"), G * bar.area, 0.005 * G * bar.area);
  EXPECT_LT(std::abs(bar.solver->now().energy("residual")), 1e-3 * turned_over);
  EXPECT_NEAR(bar.solver->now().reaction(0)[0] / bar.area, pressed, 0.01 * pressed);
}

/// A node that splits gives its pieces what it was: no momentum comes or goes, and a free body takes its own course.
TEST(Verify, C7_SplittingKeepsMomentum) {
  Notched bar(2);
  bar.scene.bodies[0].velocity_at = [](double x, double, double) {
    return std::array{2.0 + (x > 0 ? 2.0 : -2.0), 0.5, 0.0};
  };
  bar.start();
  bar.solver->evaluate();
  V const before = bar.momentum();
  for (int i = 0; i < 400; ++i) bar.step();
  EXPECT_GT(bar.solver->now().broken_joints(), 0);
  EXPECT_LT((bar.momentum() - before).norm(), 1e-12 * before.norm());
}

/// The groups of what is tied about nodes, in cells of any kind and after any splitting, against a union of what hangs
/// together by whole faces: such vertices are in one group, and where no node waits a group is nothing more.
TEST(Verify, C7_TiesAreTheUnionOfWholeFaces) {
  Notched bar(2);
  bar.scene.bodies[0].velocity_at = [](double x, double y, double z) {
    return std::array{x > 0 ? 4.0 : -4.0, 300 * y, D == 3 ? 200 * z : 0.0};
  };
  bar.start();
  auto const& model = bar.solver->model();
  std::map<int, std::vector<Index>> at_node;
  bar.each_corner([&](Index e, int a, Index vertex) {
    auto& list = at_node[model.elements.node[static_cast<std::size_t>(e) * C + a]];
    if (std::find(list.begin(), list.end(), vertex) == list.end()) list.push_back(vertex);
  });
  int split = 0;
  for (int step = 0; step < 200; ++step) {
    bar.step();
    if (step % 20 != 0) continue;
    State const state = bar.solver->save();
    auto const tied = state_values<Index>(state, "ties");
    auto const starts = state_values<std::uint8_t>(state, "tie starts");
    auto const waiting = state_values<Index>(state, "waiting nodes");
    std::vector<Index> group(model.vertices.count, -1), root(model.vertices.count);
    for (std::size_t k = 0; k < tied.size(); ++k)
      group[tied[k]] = starts[k] || k == 0 ? static_cast<Index>(k) : group[tied[k - 1]];
    std::iota(root.begin(), root.end(), 0);
    auto const find = [&](Index vertex) {
      while (root[vertex] != vertex) vertex = root[vertex];
      return vertex;
    };
    model.each_set([&](auto const& set) {
      auto const whole = set.of(model.interfaces).whole.download();
      auto const& cells = set.range(model.groups[0]);
      for (Index cell = cells.first; cell < cells.first + cells.count; ++cell)
        for (int a = 0; a < set.faces; ++a)
          for (int i = 0; i < set.face_points; ++i) {
            Index const mine = set.face_vertex(cell, a, i), theirs = set.across(cell, a, i);
            if (mine == theirs || !whole[kernels::blocked(cell, a, set.faces)]) continue;
            EXPECT_EQ(group[mine], group[theirs]) << step;
            root[find(mine)] = find(theirs);
          }
    });
    Index number = 0;
    for (auto const& [node, vertices] : at_node) {
      std::set<Index> groups, unions;
      for (Index const vertex : vertices) groups.insert(group[vertex]), unions.insert(find(vertex));
      bool const waits = std::find(waiting.begin(), waiting.end(), number++) != waiting.end();
      if (waits)
        EXPECT_LE(groups.size(), unions.size()) << "node " << node << ", step " << step;
      else
        EXPECT_EQ(groups.size(), unions.size()) << "node " << node << ", step " << step;
      split += groups.size() > 1;
    }
  }
  EXPECT_GT(split, 20);
}

/// What is tied, waits or has split is part of the state.
TEST(Restart, KnowsWhatIsStillWhole) {
  Notched one(2), other(2);
  for (auto* bar : {&one, &other}) bar->part(0, 1), bar->start();
  while (one.solver->now().energy("fracture") == 0) {
    one.run_for(1 * us);
    one.solver->evaluate(), one.solver->advance();
    ASSERT_LT(one.solver->time(), 1e-3);
  }
  other.solver->restore(one.solver->save());
  for (int i = 0; i < 100; ++i) one.step(), other.step();
  EXPECT_EQ(one.solver->save(), other.solver->save());
  auto damaged = one.solver->save();
  damaged.at("ties")[0] ^= 1;
  EXPECT_THROW(other.solver->restore(damaged), Error);
}

}  // namespace
}  // namespace fissure::verify
