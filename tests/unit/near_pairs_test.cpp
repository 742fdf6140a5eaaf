// Pairs near each other: which of them a step looks at, and what they bring along.
#include "contact/near_pairs.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "../../src2d/dim.h"

namespace fissure {
namespace {

using Pairs = std::vector<contact::ElementPair>;
constexpr int size = kernels::spring_size<2>;

struct Near : testing::Test {
  Device device = Device::select("cpu", 1);
  NearPairs<2, double> near;
  Candidates<2, double> watched{false};

  void watch(double path, double window, bool late = true) { near.watch(device, watched, path, window, late); }
  /// As kernels::PairForces leaves them: asleep until a path.
  void sleep_until(contact::ElementPair pair, double wake) {
    auto const at = std::lower_bound(watched.pairs.begin(), watched.pairs.end(), pair) - watched.pairs.begin();
    watched.wake.upload_one(static_cast<std::size_t>(at), wake);
  }
  using Axes = std::vector<std::uint8_t>;
  void part_along(contact::ElementPair pair, std::uint8_t axis) {
    auto const at = std::lower_bound(watched.pairs.begin(), watched.pairs.end(), pair) - watched.pairs.begin();
    watched.axis.upload_one(static_cast<std::size_t>(at), axis);
  }
  void set_spring(contact::ElementPair pair, int number, double value) {
    auto const at = std::lower_bound(watched.pairs.begin(), watched.pairs.end(), pair) - watched.pairs.begin();
    watched.spring.upload_one(static_cast<std::size_t>(at) * size + static_cast<std::size_t>(number), value);
  }
  NearPairs<2, double> again;
  Candidates<2, double> others{false};
  State state;
  void go_through_a_checkpoint() {
    watched.save(state, "pair"), near.save(state, watched);
    others.restore(device, state, "pair", 10, 10);
    again.restore(state, 10, others);
  }
  double spring(contact::ElementPair pair, int number) {
    auto const at = std::lower_bound(watched.pairs.begin(), watched.pairs.end(), pair) - watched.pairs.begin();
    return watched.spring.download()[static_cast<std::size_t>(at) * size + static_cast<std::size_t>(number)];
  }
};

TEST_F(Near, ThoseThatSleepLongAreNotWatched) {
  near.renew({{0, 5}, {1, 6}, {2, 7}}, watched);
  watch(0, 0);
  EXPECT_EQ(watched.pairs.size(), 3u);  // nobody knows yet
  sleep_until({0, 5}, 0.3), sleep_until({2, 7}, 0.05);
  EXPECT_TRUE(near.stale(1e-6));
  near.note(watched), watch(1e-6, 0.1);
  EXPECT_EQ(watched.pairs, (Pairs{{1, 6}, {2, 7}}));
  EXPECT_FALSE(near.stale(0.1));
  EXPECT_TRUE(near.stale(0.11));
  near.note(watched), watch(0.25, 0.1);
  EXPECT_EQ(watched.pairs, near.all());
}

TEST_F(Near, APairThatNobodyHasSeenBeginsWithoutForceAndOnlyOnce) {
  near.renew({{0, 5}}, watched);
  watch(0, 0, false);
  EXPECT_EQ(spring({0, 5}, size - 1), 0);  // the scene begins: what overlaps presses
  near.join({{1, 6}}, watched);
  watch(0.1, 0.1);
  EXPECT_EQ(spring({1, 6}, size - 1), -1);
  set_spring({1, 6}, size - 1, 0.25);  // the kernel has looked: its potential begins there
  near.note(watched), watch(0.3, 0.1);
  EXPECT_EQ(spring({1, 6}, size - 1), 0.25);
  near.renew({{0, 5}, {1, 6}}, watched);
  watch(0, 0);
  EXPECT_EQ(spring({1, 6}, size - 1), 0.25);
  EXPECT_EQ(spring({0, 5}, size - 1), 0);
}

TEST_F(Near, OneThatWakesAgainHasParted) {
  near.renew({{0, 5}}, watched);
  watch(0, 0);
  set_spring({0, 5}, size - 1, 0), sleep_until({0, 5}, 0.5);
  near.note(watched), watch(1e-6, 0.1);
  EXPECT_TRUE(watched.pairs.empty());
  watch(0.45, 0.1);
  EXPECT_EQ(spring({0, 5}, size - 1), 0);
}

TEST_F(Near, WakesOfAnOldListAreNoneOfANewOnes) {
  near.renew({{0, 5}, {1, 6}}, watched);
  watch(0, 0);
  sleep_until({0, 5}, 9), sleep_until({1, 6}, 9);
  near.renew({{0, 5}, {1, 6}}, watched);  // its path begins anew
  watch(0, 0);
  EXPECT_EQ(watched.pairs.size(), 2u);
  EXPECT_EQ(watched.wake.download(), (std::vector<double>{0, 0}));
}

TEST_F(Near, WhatHoldsStaysAndWhatIsHandedOverKeepsItsSpring) {
  near.renew({{0, 5}, {1, 6}}, watched);
  watch(0, 0);
  set_spring({1, 6}, 2, 1e6);  // its friction spring holds
  near.renew({{0, 5}}, watched);
  watch(0, 0);
  EXPECT_EQ(near.all(), (Pairs{{0, 5}, {1, 6}}));
  EXPECT_EQ(spring({1, 6}, 2), 1e6);
  // Crack faces that come apart set a pair with a spring of their own.
  watched.set(device, {{0, 5}, {1, 6}, {3, 4}}, std::vector<double>(3 * size, 0.125));
  near.join(watched.pairs, watched);
  EXPECT_TRUE(near.stale(0));
  near.note(watched), watch(0.2, 0.1);
  EXPECT_EQ(spring({3, 4}, size - 1), 0.125);
}

TEST_F(Near, UpToTheHorizonEveryPairThatMayTouchIsWatched) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> gap(0, 1);
  Pairs all;
  for (Index k = 0; k < 200; ++k) all.push_back({k, k + 300});
  near.renew(all, watched);
  watch(0, 0);
  std::map<contact::ElementPair, double> wake;
  for (auto const& pair : all) wake[pair] = 0;
  double path = 0;
  for (int step = 0; step < 400; ++step) {
    path += 0.01 * gap(random);
    if (near.stale(path)) near.note(watched), watch(path, 0.05);
    std::size_t awake = 0;
    for (auto const& [pair, until] : wake) {
      if (until > path) continue;
      ++awake;
      ASSERT_TRUE(std::binary_search(watched.pairs.begin(), watched.pairs.end(), pair)) << path;
    }
    EXPECT_LE(awake, watched.pairs.size());
    for (auto const& pair : watched.pairs)
      if (wake[pair] <= path && gap(random) > 0.3) sleep_until(pair, wake[pair] = path + gap(random));
  }
  EXPECT_LT(watched.pairs.size(), all.size() / 2);
}

/// Else every awake pair would be looked at along all its axes again whenever those that are watched are chosen anew.
TEST_F(Near, WhatPartedAPairIsRemembered) {
  near.renew({{0, 5}, {1, 6}}, watched);
  watch(0, 0);
  part_along({1, 6}, 3);
  near.note(watched), watch(1e-6, 0.1);  // chosen anew
  EXPECT_EQ(watched.axis.download(), (Axes{kernels::no_axis, 3}));
  near.join({{0, 7}}, watched), watch(0.1, 0.1);  // others join the list
  EXPECT_EQ(watched.axis.download(), (Axes{kernels::no_axis, kernels::no_axis, 3}));
  near.renew({{1, 6}, {2, 7}}, watched), watch(0, 0);  // a new list
  EXPECT_EQ(watched.axis.download(), (Axes{3, kernels::no_axis}));
  go_through_a_checkpoint();
  EXPECT_EQ(others.axis.download(), (Axes{3, kernels::no_axis}));
}

TEST_F(Near, StateIsKept) {
  near.renew({{0, 5}, {1, 6}, {2, 7}}, watched);
  watch(0, 0);
  sleep_until({0, 5}, 0.3), sleep_until({2, 7}, 0.05);
  near.note(watched), watch(1e-6, 0.1);
  sleep_until({2, 7}, 0.7);
  go_through_a_checkpoint();
  EXPECT_EQ(again.all(), near.all());
  EXPECT_EQ(others.wake.download(), watched.wake.download());
  EXPECT_EQ(again.stale(0.1), near.stale(0.1));
  EXPECT_EQ(again.stale(0.11), near.stale(0.11));
  again.note(others), near.note(watched);
  again.watch(device, others, 0.25, 0.1, true), watch(0.25, 0.1);
  EXPECT_EQ(others.pairs, watched.pairs);
  others.restore(device, state, "pair", 10, 10);
  EXPECT_THROW(again.restore(state, 3, others), Error);  // of another mesh
}

}  // namespace
}  // namespace fissure
