// The CPU's threads, as a team that shares out the pieces of a range. A barrier waits for the slowest thread, and on a
// busy machine that is one which does not run at all. So a thread that has done its share helps the others, waits are
// short before they sleep, and a team that had to wait for a member goes on with fewer for a while. What a piece
// computes never depends on who computes it.
#pragma once
#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

#include "base/lanes.h"

namespace fissure::cpu {

class Team {
 public:
  /// The process has one.
  static Team& get();
  ~Team();
  Team(Team const&) = delete;

  /// Runs work(from, to) until every piece of [0, pieces) has been run once, on at most `threads` threads, the caller
  /// among them. Calls from inside a piece, or from another thread meanwhile, run alone.
  template <class F>
  void run(int threads, Index pieces, F const& work) {
    if (threads < 2 || pieces < 2) return work(Index(0), pieces);
    run_erased(
        threads, pieces, [](void const* f, Index from, Index to) { (*static_cast<F const*>(f))(from, to); }, &work);
  }

  /// Threads that take part at present, of those that were asked for last.
  int active() const { return active_; }

 private:
  using Call = void (*)(void const*, Index, Index);
  struct alignas(64) Share {
    std::atomic<Index> next{0};
    Index end = 0, block = 1;
  };

  Team() = default;
  void run_erased(int threads, Index pieces, Call call, void const* work);
  void grow(int threads);
  void member(int me);
  void take_pieces(int me);
  void judge(double waited);

  std::atomic<bool> busy_{false};  // somebody runs something
  std::vector<std::thread> members_;
  std::unique_ptr<Share[]> shares_;
  int capacity_ = 0;  // of shares_

  Call call_ = nullptr;
  void const* work_ = nullptr;
  int parts_ = 0;                   // shares of what is being run
  std::atomic<unsigned> round_{0};  // one more for each run; members sleep on it
  std::atomic<bool> open_{false}, leaving_{false};
  std::atomic<int> inside_{0};  // members that may hold a piece

  int active_ = 0, asked_ = 0, stalls_ = 0, rounds_ = 0;
  std::chrono::steady_clock::time_point retry_{};
  double pause_ = 0;  // how long the team stays small [s]
};

}  // namespace fissure::cpu
