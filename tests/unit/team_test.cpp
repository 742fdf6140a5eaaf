// The team of threads: every piece once, whoever runs it.
#include "backend/team.h"

#include <gtest/gtest.h>

#include <numeric>

namespace fissure {
namespace {

using cpu::Team;

/// How often each of n pieces was run by a team of `threads`.
std::vector<int> counts(int threads, Index n) {
  std::vector<std::atomic<int>> times(static_cast<std::size_t>(n));
  Team::get().run(threads, n, [&](Index from, Index to) {
    for (Index i = from; i < to; ++i) ++times[static_cast<std::size_t>(i)];
  });
  return {times.begin(), times.end()};
}

TEST(Team, RunsEveryPieceOnce) {
  for (int threads : {1, 2, 3, 8, 2, 5})
    for (Index n : {1, 2, 3, 7, 16, 1000, 4097}) {
      std::vector<int> const once(static_cast<std::size_t>(n), 1);
      for (int repeat = 0; repeat < 50; ++repeat)
        ASSERT_EQ(counts(threads, n), once) << threads << " threads, " << n << " pieces";
    }
}

TEST(Team, NothingIsNothing) { EXPECT_TRUE(counts(4, 0).empty()); }

TEST(Team, PiecesInsidePiecesAndOtherThreadsRunAlone) {
  std::atomic<int> inner{0};
  Team::get().run(4, 8, [&](Index from, Index to) {
    for (Index i = from; i < to; ++i) Team::get().run(4, 10, [&](Index a, Index b) { inner += b - a; });
  });
  EXPECT_EQ(inner, 80);
  std::vector<std::thread> others;
  std::atomic<int> all{0};
  for (int k = 0; k < 4; ++k)
    others.emplace_back([&] {
      for (int repeat = 0; repeat < 100; ++repeat) Team::get().run(3, 40, [&](Index a, Index b) { all += b - a; });
    });
  for (auto& thread : others) thread.join();
  EXPECT_EQ(all, 4 * 100 * 40);
}

TEST(Team, GoesOnSmallerWhenAMemberIsSlow) {
  // A member that took a piece keeps it for two milliseconds, twenty times what is tolerated; the caller begins once it
  // has one.
  auto const caller = std::this_thread::get_id();
  int rounds = 0;
  do {
    std::atomic<int> done{0};
    std::atomic<bool> taken{false};
    auto const late = std::chrono::steady_clock::now() + std::chrono::milliseconds(50);
    Team::get().run(2, 64, [&](Index from, Index to) {
      if (std::this_thread::get_id() != caller) taken = true, std::this_thread::sleep_for(std::chrono::milliseconds(2));
      while (!taken && std::chrono::steady_clock::now() < late) std::this_thread::yield();
      done += to - from;
    });
    ASSERT_EQ(done, 64);
  } while (Team::get().active() == 2 && ++rounds < 100);
  EXPECT_EQ(Team::get().active(), 1);
}

/// The last piece of a long launch is waited for, for as long as a piece takes: the member does run. On a busy machine
/// one may not, so that some teams are tried, each of other threads than the last one had.
TEST(Team, StaysWholeWherePiecesAreLong) {
  int whole = 0;
  for (int threads = 3; threads <= 8 && whole == 0; ++threads) {
    for (int rounds = 0; rounds < 8; ++rounds) {
      std::atomic<int> begun{0};
      Team::get().run(threads, 60, [&](Index from, Index to) {
        for (Index i = from; i < to; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(begun++ == 59 ? 4 : 1));
      });
      EXPECT_EQ(begun, 60);
    }
    whole += Team::get().active() == threads;
  }
  EXPECT_EQ(whole, 1);
}

}  // namespace
}  // namespace fissure
