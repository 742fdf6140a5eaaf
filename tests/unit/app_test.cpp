// What the command line works out by itself.
#include <gtest/gtest.h>

#include "app/run.h"

using namespace fissure;

namespace {

/// A clock that only steps advance: the first takes long, and the machine does something else at every twentieth.
struct Clock {
  double now = 0;
  long steps = 0;
  void step() { now += steps == 0 ? 0.4 : steps % 20 == 0 ? 0.1 : 1e-3, ++steps; }
};

double typical(Clock& clock, double most_steps) {
  return app::typical_step([&] { clock.step(); }, [&] { return clock.now; }, most_steps);
}

}  // namespace

TEST(TypicalStep, IsNeitherTheFirstNorOneThatHadToWait) {
  Clock clock;
  EXPECT_NEAR(typical(clock, 1e6), 1e-3, 1e-5);
  EXPECT_GE(clock.now - 0.4, 0.05);
}

TEST(TypicalStep, IsTimedOverNoMoreStepsThanThereAre) {
  Clock clock;
  EXPECT_NEAR(typical(clock, 12), 1e-3, 1e-5);
  EXPECT_EQ(clock.steps, 12);
  Clock one;
  EXPECT_NEAR(typical(one, 1), 0.4, 1e-9);
}
