// What a run has recorded: means over a time, and whether it rests.
#include "solver/recorded.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fissure {
namespace {

TEST(Recorded, MeanIsThatOfStraightLinesBetweenRows) {
  Recorded recorded;
  EXPECT_FALSE(recorded.has("load"));
  recorded.begin_row(0);
  recorded.add("load", 0);
  EXPECT_EQ(recorded.mean("load", 5), 0);
  for (auto const& [t, y] : {std::pair{1.0, 2.0}, {3.0, 2.0}, {4.0, 6.0}})
    recorded.begin_row(t), recorded.add("load", y);
  EXPECT_DOUBLE_EQ(recorded.mean("load", 1), 4);
  EXPECT_DOUBLE_EQ(recorded.mean("load", 2), 3);
  EXPECT_DOUBLE_EQ(recorded.mean("load", 0.5), 5);           // from 4 at 3.5 s
  EXPECT_DOUBLE_EQ(recorded.mean("load", 3.5), 8.75 / 3.5);  // from 1 at 0.5 s: 0.75 + 4 + 4
  EXPECT_DOUBLE_EQ(recorded.mean("load", 4), (1.0 + 4 + 4) / 4);
  EXPECT_DOUBLE_EQ(recorded.mean("load", 100), (1.0 + 4 + 4) / 4);  // all there is
  recorded.begin_row(5);                                            // a row whose value is not there yet
  EXPECT_DOUBLE_EQ(recorded.mean("load", 1), 4);
}

TEST(Recorded, IsCalmWhenATenthOfTheTimeWasQuiet) {
  Recorded recorded;
  EXPECT_FALSE(recorded.calm("kinetic", 1e-4));
  for (int k = 0; k <= 100; ++k) {  // it swings: at its turning points alone nothing moves
    recorded.begin_row(k);
    recorded.add("kinetic", std::exp(-0.1 * k) * (k % 4 == 0 ? 0 : 1));
    EXPECT_EQ(recorded.calm("kinetic", 1e-2), k >= 57) << k;  // from row 48 on it is below, exp(-4.6) of the largest
  }
  Recorded nothing;
  for (int k = 0; k <= 10; ++k) nothing.begin_row(k), nothing.add("kinetic", 0);
  EXPECT_FALSE(nothing.calm("kinetic", 1e-4));  // what never moved has not come to rest
}

}  // namespace
}  // namespace fissure
