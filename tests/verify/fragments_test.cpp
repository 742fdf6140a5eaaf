// Fragments: pieces that hang together by faces, against bars that are cut where they are told to be.
#include "rig.h"

namespace fissure::verify {
namespace {

/// A bar of 8 cells that is cut behind its second and fifth: 2, 3 and 3 eighths of its mass. It flies apart, so each
/// piece keeps the momentum it began with.
void cut_bar(bool blocks, double scaling) {
  double const h = 5 * mm;
  Rig<> rig;
  auto stuff = material(rock);
  stuff.joint = joint(25 * MPa, 50 * MPa, 500, 1500, 20 * rock.young);
  rig.add_material(stuff);
  rig.scene.out_of_plane = h;
  rig.scene.run.mass_scaling = scaling;
  rig.add_box({4 * h, h / 2, h / 2}, {8 * h, h, h}, h);
  if (blocks) rig.scene.bodies[0].mesh.cells = "block";
  rig.scene.joint_sets.push_back(
      {"cuts",
       {},
       0,
       {},
       [=](double x, double, double) { return std::abs(x - 2 * h) < 1e-6 || std::abs(x - 5 * h) < 1e-6; },
       {},
       0,
       0.0});
  rig.scene.bodies[0].velocity_at = [=](double x, double, double) { return std::array{x / h, 0.0, 0.0}; };
  rig.start();
  for (int i = 0; i < 3; ++i) rig.step();
  rig.solver->evaluate();
  auto const pieces = rig.solver->now().fragments(-1);
  ASSERT_EQ(pieces.size(), 3u);
  double const whole = rock.density * 8 * h * h * h;
  for (std::size_t k = 0; k < 3; ++k) {
    double const share = k == 2 ? 2.0 / 8 : 3.0 / 8;
    EXPECT_NEAR(pieces[k].mass, share * whole, 1e-12 * whole) << k;
    EXPECT_NEAR(pieces[k].size[0], share * 8 * h, 1e-3 * h) << k;  // its corners move on
    EXPECT_NEAR(pieces[k].size[1], h, 1e-3 * h) << k;
  }
  double middle = 0;
  for (auto const& piece : pieces) {
    double const x = piece.center[0] / h, at_rest = x < 2 ? 1 : x < 5 ? 3.5 : 6.5;
    EXPECT_NEAR(piece.velocity[0], at_rest, 1e-9);
    EXPECT_NEAR(x, at_rest + at_rest * rig.solver->time() / h, 1e-9);
    middle += x;
  }
  EXPECT_NEAR(middle, 11, 0.01);  // each of them once
  EXPECT_EQ(rig.solver->now().fragments(0).size(), 3u);
  EXPECT_EQ(rig.solver->now().extreme("fragment"), 3);
}

TEST(Verify, Fragments_OfACutBarOfSimplices) { cut_bar(false, 1); }
TEST(Verify, Fragments_OfACutBarOfBlocks) { cut_bar(true, 1); }
TEST(Verify, Fragments_WeighNoScaledMass) { cut_bar(false, 4); }

/// Bodies without joints are a piece each; asked for one, others do not count.
TEST(Verify, Fragments_OfWholeBodies) {
  Rig<> rig;
  rig.add_material(material(rock));
  rig.add_box({0, 0, 0}, {20 * mm, 10 * mm, 10 * mm}, 5 * mm);
  rig.add_box({50 * mm, 0, 0}, {10 * mm, 10 * mm, 10 * mm}, 5 * mm);
  rig.start();
  EXPECT_EQ(rig.solver->now().fragments(-1).size(), 2u);
  auto const one = rig.solver->now().fragments(1);
  ASSERT_EQ(one.size(), 1u);
  EXPECT_NEAR(one[0].center[0], 50 * mm, 1e-9);
}

}  // namespace
}  // namespace fissure::verify
