// Contracts end the program where they are looked at, and cost nothing elsewhere.
#include <gtest/gtest.h>

#include "base/face_id.h"

namespace fissure {
namespace {

#if defined(FISSURE_CONTRACTS)
TEST(Contracts, EndTheProgramAndSayWhere) {
  EXPECT_DEATH(FISSURE_EXPECT(1 + 1 == 3), "contracts_test.cpp:[0-9]+: contract broken: 1 \\+ 1 == 3");
  EXPECT_DEATH((FaceId{-1, 0}.packed()), "face_id.h:[0-9]+: contract broken");
}
#else
TEST(Contracts, AreNotAskedInARelease) {
  int asked = 0;
  FISSURE_EXPECT(++asked == 1);
  EXPECT_EQ(asked, 0);
}
#endif

}  // namespace
}  // namespace fissure
