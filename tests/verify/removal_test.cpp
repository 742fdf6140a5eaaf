// Crushed pieces that leave the run (run.crushed = "remove"): with all their mass and all that they held.
#include <limits>

#include "rig.h"
#include "small_motions.h"

namespace fissure::verify {
namespace {

constexpr double h = 2 * mm, speed = 20;

/// A cube of loose cells, or of cells that hang together, in a die whose lid comes down.
void set_die(Rig<>& rig, bool loose, bool averaged = false) {
  Stuff const soft{100 * MPa, 0.2, 2500};
  scene::Material m = material(soft);
  if (averaged) m.flow = flow({0, 0, 2 * MPa}), m.flow->averaged = true;
  m.joint = unbreakable(soft.young);
  m.contact = laws::ContactLaw{200 * soft.young, 0.3};
  rig.add_material(m);
  rig.scene.out_of_plane = 2 * h;
  rig.cell_name = "simplex";  // blocks stay
  rig.add_box({0, 0, 0}, {2 * h, 2 * h, 2 * h}, h);
  if (loose)
    rig.scene.joint_sets.push_back({"all", {}, 0, {}, [](double, double, double) { return true; }, {}, 0, 0.0});
  auto const still_plate = scene::Directions{constant(0), constant(0), constant(0)};
  for (int c = 0; c < D; ++c)
    for (int side : {-1, 1}) {
      Vec3 center{0, 0, 0}, size{8 * h, 8 * h, 8 * h};
      center[c] = side * 2 * h, size[c] = 2 * h;
      bool const lid = c == 1 && side > 0;
      rig.scene.plates.push_back({"plate", {}, {center, size}, lid ? along(1, constant(-speed)) : still_plate, {}});
    }
  rig.scene.run.remove_crushed = true;
  rig.start();
}

/// Of the work, or, while that has only begun, of a tenth of Young's modulus times the volume.
double residual(Rig<>& rig) {
  auto const& ledger = rig.solver->energies();
  return std::abs(ledger.residual()) / std::max(ledger.plates, 0.1 * 100 * MPa * std::pow(2 * h, 3));
}

/// Until nothing is left: mass to rounding; the ledger to 1 % of the work: the lid hits at a tenth of the speed of
/// waves.
void crush(bool averaged) {
  Rig<> rig;
  set_die(rig, true, averaged);
  double const whole = 2500 * std::pow(2 * h, 3);
  double before = 0;
  while (rig.solver->time() < 0.98 * 2 * h / speed) {
    rig.step();
    rig.solver->evaluate();
    auto const& now = rig.solver->now();
    double left = now.removed_mass();
    for (auto const& piece : now.fragments(-1)) left += piece.mass;
    ASSERT_NEAR(left, whole, 1e-12 * whole) << rig.solver->time();
    ASSERT_GE(now.removed_mass(), before);
    before = now.removed_mass();
    ASSERT_LT(residual(rig), 1e-2) << rig.solver->time();
    rig.solver->advance();
  }
  if (averaged) {  // a few may be left, and what flows has spent most of the work
    EXPECT_GT(before, 0.5 * whole);
    return;
  }
  EXPECT_NEAR(before, whole, 1e-12 * whole);
  EXPECT_EQ(rig.solver->now().removed_pieces(), static_cast<long>(rig.solver->element_count()));
  EXPECT_GT(rig.solver->energies().removed, 0.5 * rig.solver->energies().plates);
}
TEST(Verify, D12_CrushedPiecesLeaveWithWhatTheyHeld) { crush(false); }
/// What is stored by patches of averaged pressure counts, too.
TEST(Verify, D12_CrushedPiecesThatFlowLeaveWithWhatTheyHeld) { crush(true); }

/// Places that are no numbers are no crushed pieces: the run ends, and names the cell.
TEST(Verify, D12_WhatIsNoNumberIsNotCrushed) {
  Rig<> rig;
  set_die(rig, true);
  rig.step();
  auto u = rig.solver->model().vertices.u.download();
  u[0] = std::numeric_limits<double>::quiet_NaN();
  rig.solver->model().vertices.u.upload(u);
  EXPECT_THROW(rig.solver->evaluate(), Error);
}

/// What others hold is no lone piece, however flat it is.
TEST(Verify, D12_WhatHangsTogetherStays) {
  Rig<> rig;
  set_die(rig, false);
  while (rig.solver->time() < 0.95 * 2 * h / speed) rig.step();
  rig.solver->evaluate();
  EXPECT_EQ(rig.solver->now().removed_pieces(), 0);
  EXPECT_EQ(rig.solver->energies().removed, 0);
}

/// From the step that removed the first piece on, to the last bit.
TEST(Restart, GoesOnAfterACrushedPieceHasLeft) {
  Rig<> one, other;
  set_die(one, true), set_die(other, true);
  while (one.solver->now().removed_pieces() == 0) one.step();
  for (int k = 0; k < 3; ++k) {
    auto const state = one.solver->save();
    other.solver->restore(state);
    for (int i = 0; i < 40; ++i) one.step(), other.step();
    ASSERT_EQ(one.solver->save(), other.solver->save()) << k;
  }
  EXPECT_GT(one.solver->now().removed_pieces(), 1);
}

}  // namespace
}  // namespace fissure::verify
