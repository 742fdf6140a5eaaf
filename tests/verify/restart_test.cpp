// A solver that goes on from another's state.
#include "rig.h"

namespace fissure::verify {
namespace {

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

}  // namespace
}  // namespace fissure::verify
