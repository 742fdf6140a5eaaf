// What a scene does not require costs nothing: arrays that do not exist, kernels that are never launched.
#include "rig.h"

namespace fissure::verify {
namespace {

struct Cost {
  std::map<std::string, std::size_t> arrays;
  std::map<std::string, long> launches;
  bool array(std::string const& name) const { return arrays.contains(name); }
  bool launch(std::string const& name) const { return launches.contains(name); }
};

/// A small box under a plate if asked for, ten steps.
Cost cost_of(bool fracture, bool plate, bool wall, bool damped, int bodies = 1) {
  Rig<> rig;
  auto m = material(rock);
  if (fracture) m.joint = joint(3e6, 1e7, 5, 5, 500e9);
  m.viscosity = damped ? 10 : 0;
  rig.add_material(m);
  for (int b = 0; b < bodies; ++b) rig.add_box({0, 5 * mm * b, 0}, {4 * mm, 4 * mm, 4 * mm}, 2 * mm);
  if (plate) rig.scene.plates.push_back({"plate", {}, {{0, -3 * mm, 0}, {6 * mm, 2 * mm, 6 * mm}}, still(), {}});
  if (wall) rig.scene.walls.push_back({"wall", {}, {0, -2 * mm, 0}, {0, 1, 0}, {}});
  auto& solver = rig.start();
  for (int i = 0; i < 10; ++i) rig.step();
  solver.now().energy("kinetic");
  return {rig.device.arrays(), rig.device.launches()};
}

TEST(Plan, ElasticBodyAloneHasNoJointsNoContactNoLoads) {
  Cost const cost = cost_of(false, false, false, false);
  for (char const* name :
       {"joint links", "joint areas", "joint stiffness", "joint history", "joint work", "joint dissipation",
        "joint softening", "viscous work", "contact laws", "contact slots", "contact candidates", "plates", "walls",
        "crack faces", "prescribed motion", "surface loads", "plastic memory", "plastic work", "patches"})
    EXPECT_FALSE(cost.array(name)) << name;
  for (char const* name : {"contact pairs", "contact plates", "contact walls", "contact forces", "contact work",
                           "contact drift", "crack faces", "loads", "hold reaction", "reactions"})
    EXPECT_FALSE(cost.launch(name)) << name;
  EXPECT_EQ(cost.launches.at("advance"), 10);
  EXPECT_TRUE(cost.array("corner vertices"));  // shared vertices
}

TEST(Plan, BodyThatCanCrackHasJointsAndAVertexPerCorner) {
  Cost const cost = cost_of(true, false, false, false);
  EXPECT_TRUE(cost.array("joint history"));
  EXPECT_FALSE(cost.array("corner vertices"));
  EXPECT_TRUE(cost.array("viscous work"));  // of dampers in joints that have softened
  EXPECT_FALSE(cost.launch("sum corners"));
  EXPECT_FALSE(cost.launch("contact plates"));
}

TEST(Plan, FlowKeepsItsMemoryAndPatchesOnlyWhenAskedFor) {
  for (bool averaged : {false, true}) {
    Rig<> rig;
    auto m = material(rock);
    laws::JohnsonCookFlow law;
    law.A = 1e6;
    m.flow.emplace();
    m.flow->law = law;
    m.flow->averaged = averaged;
    rig.add_material(m);
    rig.add_box({0, 0, 0}, {4 * mm, 4 * mm, 4 * mm}, 2 * mm);
    rig.start();
    for (int i = 0; i < 10; ++i) rig.step();
    auto const arrays = rig.device.arrays();
    // tau, ep and its rate: no back stress, no temperature, no thickness.
    EXPECT_EQ(arrays.at("plastic memory"), (flat ? 6u : 8u) * sizeof(double) * rig.solver->model().elements.count);
    EXPECT_EQ(arrays.contains("patches"), averaged);
    EXPECT_EQ(rig.device.launches().contains("patch pressure"), averaged);
    EXPECT_FALSE(arrays.contains("yield curves"));
  }
}

/// What is foreseen before the first allocation is what the arrays take then, but for padding and the small ones: 5 %.
TEST(Plan, ForeseesTheMemoryThatBodiesTake) {
  for (int cells : {0, 1})
    for (int what : {0, 1, 2, 3}) {
      Rig<> rig;
      if (cells == 1) rig.cell_name = "block";
      auto m = material(rock);
      if (what >= 1) m.joint = joint(3e6, 1e7, 5, 5, 500e9);
      if (what >= 2) m.flow.emplace(), m.flow->law = laws::JohnsonCookFlow{};
      if (what == 3) m.joint.reset();
      if (m.flow) std::get<laws::JohnsonCookFlow>(m.flow->law).A = 1e9;
      rig.add_material(m);
      rig.scene.contact = false;
      rig.add_box({0, 0, 0}, {40 * mm, 40 * mm, flat ? 0 : 20 * mm}, flat ? 0.5 * mm : 1.6 * mm);
      rig.start();
      double const foreseen = static_cast<double>(model::bytes_foreseen(rig.scene, rig.mesh, sizeof(double))),
                   taken = static_cast<double>(rig.device.bytes());
      EXPECT_NEAR(foreseen / taken, 1, 0.05) << "cells " << cells << ", scene " << what;
    }
}

TEST(Plan, RefusesASceneThatHasNoRoomAndSaysWhatWouldFit) {
  Rig<> rig;
  rig.add_material(material(rock));
  rig.add_box({0, 0, 0}, {40 * mm, 40 * mm, flat ? 0 : 20 * mm}, 2 * mm);
  rig.make();
  setenv("FISSURE_MEMORY", "10000", 1);
  std::string message;
  try {
    model::require_room(rig.device, rig.scene, rig.mesh, sizeof(double));
  } catch (Error const& error) {
    message = error.what();
  }
  setenv("FISSURE_MEMORY", "1e9", 1);
  EXPECT_NO_THROW(model::require_room(rig.device, rig.scene, rig.mesh, sizeof(double)));
  unsetenv("FISSURE_MEMORY");
  EXPECT_NE(message.find("elements fit; make mesh sizes"), std::string::npos) << message;
  EXPECT_NE(message.find("or take --precision single"), std::string::npos) << message;
}

TEST(Plan, PlatesWallsAndDampingAreThereOnlyWhenAskedFor) {
  Cost const plate = cost_of(false, true, false, false), wall = cost_of(false, false, true, true);
  EXPECT_TRUE(plate.launch("contact plates"));
  EXPECT_FALSE(plate.launch("contact walls"));
  EXPECT_FALSE(plate.launch("contact pairs"));
  EXPECT_FALSE(plate.array("viscous work"));
  EXPECT_TRUE(wall.launch("contact walls"));
  EXPECT_FALSE(wall.launch("contact plates"));
  EXPECT_TRUE(wall.array("viscous work"));
}

TEST(Plan, BodyThatIsNotConvexMayTouchItself) {
  Rig<> rig;
  rig.add_material(material(rock));
  rig.add_box({0, 0, 0}, {4 * mm, 4 * mm, 4 * mm}, 2 * mm);
  rig.make();
  EXPECT_FALSE(model::make_plan(rig.scene, rig.mesh).pairs);
  for (auto& x : rig.mesh.nodes)
    if (x.head<2>().norm() < 1e-9) x[1] += 0.5 * mm;
  EXPECT_FALSE(model::make_plan(rig.scene, rig.mesh).pairs) << "only what is inside has moved";
  for (auto& x : rig.mesh.nodes)
    if (std::abs(x[0]) < 1e-9 && x[1] > 1.9 * mm) x[1] -= 0.8 * mm;
  EXPECT_TRUE(model::make_plan(rig.scene, rig.mesh).pairs);
}

TEST(Plan, DescriptionSaysWhatIsModelledAndWhy) {
  Rig<> rig;
  rig.add_material(material(rock));
  rig.add_box({0, 0, 0}, {4 * mm, 4 * mm, 4 * mm}, 2 * mm);
  rig.make();
  EXPECT_EQ(model::describe(model::make_plan(rig.scene, rig.mesh)),
            "  no  joints                     no material has a fracture part\n"
            "  no  plastic flow               no material has a plastic part\n"
            "  no  blocks                     all cells are simplices\n"
            "  yes shared vertices            bodies that cannot crack need no vertices of their own for each cell\n"
            "  no  contact between elements   one convex body that cannot crack has nothing to touch\n"
            "  no  plates                     0 given\n"
            "  no  walls                      0 given\n"
            "  no  viscous damping            no material has damping\n"
            "  no  mass-proportional damping  run{} has no mass_damping\n"
            "  no  gravity                    no gravity{}\n"
            "  no  tractions, pressures, forces 0 given\n"
            "  no  absorbing boundary         0 given\n"
            "  no  prescribed motion          0 given\n");
}

}  // namespace
}  // namespace fissure::verify
