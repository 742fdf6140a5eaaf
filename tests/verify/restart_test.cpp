// A solver that goes on from another's state, and numbers that must survive their arrays.
#include "rig.h"

namespace fissure::verify {
namespace {

/// A box that stands on a plate, its material the last of `n`.
void stand_on_plate(Rig<>& rig, int n) {
  for (int k = 0; k < n; ++k) {
    auto m = material(rock, "stuff " + std::to_string(k));
    m.contact = laws::ContactLaw{k == n - 1 ? 10 * GPa : 1 * GPa, 0};
    rig.add_material(m);
  }
  rig.add_box({0, 0, 0}, {4 * mm, 4 * mm, 4 * mm}, 2 * mm, n - 1);
  // 0.1 mm deep in it
  rig.scene.plates.push_back({"plate", {}, {{0, -2.9 * mm, 0}, {6 * mm, 2 * mm, 6 * mm}}, still(), {}});
}

double plate_force(int n_materials) {
  Rig<> rig;
  stand_on_plate(rig, n_materials);
  rig.start().evaluate();
  return rig.solver->now().plate_force(0).norm();
}

TEST(Materials, KeepTheirContactLawsHoweverManyThereAre) {
  EXPECT_GT(plate_force(1), 0);
  EXPECT_EQ(plate_force(257), plate_force(1));
}

TEST(Materials, AreRefusedBeyondWhatContactCanTellApart) {
  Rig<> rig;
  stand_on_plate(rig, 65537);
  try {
    rig.start();
    FAIL() << "not refused";
  } catch (Error const& error) {
    EXPECT_STREQ(error.what(),
                 "ladder: there are 65537 materials (contact can tell 65536 apart); let bodies share them");
  }
}

TEST(Restart, NeedsNoContactAndNoJoints) {
  Rig<> one, other;
  for (Rig<>* rig : {&one, &other}) {
    rig->add_material(material(rock));
    rig->add_box({0, 0, 0}, {4 * mm, 4 * mm, 4 * mm}, 2 * mm);
    rig->scene.bodies[0].velocity_at = [](double x, double, double) { return std::array{x, 0.0, 0.0}; };
    rig->start();
  }
  for (int i = 0; i < 10; ++i) one.step();
  other.solver->restore(one.solver->save());
  for (int i = 0; i < 10; ++i) one.step(), other.step();
  EXPECT_EQ(one.solver->save(), other.solver->save());
}

/// Two breakable boxes, one of blocks, that collide on a plate, held and pushed; the first flies at `speed`.
void collide(Rig<>& rig, bool adaptive, double speed) {
  auto stuff = material(rock);
  auto law = joint(2 * MPa, 4 * MPa, 2, 6, 20 * rock.young);
  law.inserted = adaptive;
  stuff.joint = law;
  stuff.contact = laws::ContactLaw{rock.young, 0.4};
  rig.add_material(stuff);
  rig.add_box({0, 0, 0}, {8 * mm, 8 * mm, 4 * mm}, 2 * mm, 0, false);
  rig.add_box({8.05 * mm, 0, 0}, {8 * mm, 8 * mm, 4 * mm}, 2 * mm);
  rig.scene.bodies[1].mesh.cells = "block";
  rig.scene.bodies[0].velocity = {speed, 0, 0};
  rig.scene.plates.push_back(
      {"plate", {}, {{15.1 * mm, 0, 0}, {6 * mm, 20 * mm, 20 * mm}}, {constant(-5), std::nullopt, std::nullopt}, {}});
  rig.roller(1, "top", 1);
  rig.press(0, place("left"), of_time([](double t) { return 1e12 * t; }));
  rig.scene.run.mass_damping = 10;
  rig.start();
}

/// A solver that has lived through something else goes on from a state to the last bit: whatever a checkpoint forgot
/// would still be that of the other life.
TEST(Restart, ForgetsNothing) {
  for (bool const adaptive : {false, true}) {
    Rig<> one, other;
    collide(one, adaptive, 20), collide(other, adaptive, 35);
    one.run_for(6 * us), other.run_for(9 * us);
    one.solver->evaluate(), other.solver->evaluate();
    ASSERT_GT(one.solver->now().broken_joints(), 0) << adaptive;
    ASSERT_NE(one.solver->now().broken_joints(), other.solver->now().broken_joints());
    one.solver->advance();
    other.solver->restore(one.solver->save());
    for (int i = 0; i < 60; ++i) one.step(), other.step();
    auto const expected = one.solver->save(), found = other.solver->save();
    ASSERT_EQ(expected.size(), found.size());
    for (auto const& [name, bytes] : expected) EXPECT_TRUE(found.at(name) == bytes) << name << " adaptive " << adaptive;
  }
}

TEST(Restart, KnowsWhatLimitedTheStep) {
  Rig<> rig;
  stand_on_plate(rig, 1);
  State state = rig.start().save();
  state.at("owner of the bound") = state_bytes(std::vector<char>{'i', 't'});
  rig.solver->restore(state);
  rig.solver->evaluate();  // first contact: the step is set anew, and named after the bound's owner
  EXPECT_EQ(rig.solver->step_limit().owner, "it");
}

}  // namespace
}  // namespace fissure::verify
