// Pairs that press, and the slots that vertices sum.
#include "contact/pressing_pairs.h"

#include <gtest/gtest.h>

#include "../../src2d/dim.h"
#include "contact/force_slots.h"

namespace fissure {
namespace {

using Places = std::vector<Index>;
constexpr int size = kernels::spring_size<2>;

struct Pressing : testing::Test {
  Device device = Device::select("cpu", 1);
  Candidates<2, double> watched{false};
  PressingPairs<2, double> pressing;

  void watch(std::size_t n) {
    std::vector<contact::ElementPair> pairs;
    for (Index k = 0; k < static_cast<Index>(n); ++k) pairs.push_back({k, k + 100});
    watched.set(device, pairs, std::vector<double>(n * size, 0));
    pressing.forget(device, n);
  }
  void raise() { *pressing.news() = 1; }
};

TEST_F(Pressing, AreThosePressedRubbedOrSprungSinceTheyWereForgotten) {
  EXPECT_FALSE(pressing.stale());  // before anything is watched
  watch(5);
  EXPECT_FALSE(pressing.stale());
  watched.penetration.upload_one(3, 1e-9);
  watched.work.upload_one(0, 1e-9);
  watched.spring.upload_one(1 * size + 2, 1e9);  // carried by a stiffness
  raise();
  EXPECT_TRUE(pressing.stale());
  pressing.renew(device, watched);
  EXPECT_FALSE(pressing.stale());
  EXPECT_EQ(pressing.places(), (Places{0, 1, 3}));
  EXPECT_EQ(std::vector<int>(pressing.listed(), pressing.listed() + 5), (std::vector<int>{1, 1, 0, 1, 0}));
  EXPECT_EQ(Places(pressing.list(), pressing.list() + 3), pressing.places());

  watched.penetration.upload({0, 0, 1e-9, 0, 0}), watched.work.upload(std::vector<double>(5, 0));
  watched.spring.upload(std::vector<double>(5 * size, 0));
  raise(), pressing.renew(device, watched);
  EXPECT_EQ(pressing.places(), (Places{0, 1, 2, 3}));  // they stay, and may press again
  watch(2);
  EXPECT_EQ(pressing.count(), 0);
}

TEST_F(Pressing, GoThroughACheckpointThatFits) {
  watch(5);
  watched.penetration.upload({0, 1e-9, 0, 0, 1e-9});
  pressing.renew(device, watched);
  State state;
  pressing.save(state);
  PressingPairs<2, double> again;
  again.forget(device, 5), again.restore(device, state, 5);
  EXPECT_EQ(again.places(), (Places{1, 4}));
  EXPECT_EQ(std::vector<int>(again.listed(), again.listed() + 5), (std::vector<int>{0, 1, 0, 0, 1}));
  EXPECT_THROW(again.restore(device, state, 4), Error);  // of another list
  state["pressing pairs"] = state_bytes(Places{4, 1});
  EXPECT_THROW(again.restore(device, state, 5), Error);  // damaged: ascending they are
}

TEST_F(Pressing, SlotsKeepTheirForcesWhenOthersJoin) {
  ForceSlots<2, double> slots;
  EXPECT_TRUE(slots.empty());
  slots.place(device, 2);
  for (int k = 0; k < 4; ++k) slots.force(0)[k] = 1 + k;
  slots.stiffness(0)[1] = 7;
  for (std::size_t const n : {3, 4, 40}) {
    slots.grow(device, n);
    auto const forces = slots.forces();
    ASSERT_GE(forces.size(), 2 * n);
    EXPECT_EQ(std::vector<double>(forces.begin(), forces.begin() + 4), (std::vector<double>{1, 2, 3, 4}));
    for (std::size_t k = 4; k < forces.size(); ++k) EXPECT_EQ(forces[k], 0);
    EXPECT_EQ(slots.stiffness(0)[1], 7);
  }
  slots.list(device, {1, 5, 39}, {8, 3, 8}, 10);
  EXPECT_EQ(slots.vertices(), (Places{3, 8}));
  slots.place(device, 2);
  EXPECT_EQ(slots.forces(), std::vector<double>(4, 0));
}

}  // namespace
}  // namespace fissure
