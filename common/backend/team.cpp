#include "backend/team.h"

#include <algorithm>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace fissure::cpu {

namespace {

using Clock = std::chrono::steady_clock;

// A launch is tens of microseconds to milliseconds: members wait awake for the next about as long as it takes to wake
// them.
constexpr int spins = 2000;
// A share is handed out in so many pieces: where some cost far more than others nobody waits long for the last.
constexpr Index pieces_of_share = 64;
// The caller waited this long for a member, and for this part of the time that its own pieces took, which is longer
// than any piece takes: the member does not run at present.
constexpr double stall = 100e-6, stalled_part = 0.25;  // [s], [-]
constexpr int watched_rounds = 256, tolerated_stalls = 4;
constexpr double first_pause = 0.02, longest_pause = 2;  // [s]

void breathe() {
#if defined(__x86_64__)
  _mm_pause();
#endif
}

/// Awake for a moment, then asleep, until `value` is no longer `old`.
template <class T>
void wait_while(std::atomic<T> const& value, T old) {
  for (int i = 0; i < spins; ++i) {
    if (value.load(std::memory_order_acquire) != old) return;
    breathe();
  }
  value.wait(old, std::memory_order_acquire);
}

}  // namespace

Team& Team::get() {
  static Team team;
  return team;
}

Team::~Team() {
  leaving_ = true;
  ++round_;
  round_.notify_all();
  for (auto& thread : members_) thread.join();
}

void Team::grow(int threads) {
  if (threads <= capacity_) return;
  shares_ = std::make_unique<Share[]>(static_cast<std::size_t>(threads));  // nobody is inside
  capacity_ = threads;
  while (static_cast<int>(members_.size()) < threads - 1) {
    int const me = static_cast<int>(members_.size()) + 1;
    members_.emplace_back([this, me] { member(me); });
  }
}

void Team::member(int me) {
  for (unsigned seen = 0;;) {
    wait_while(round_, seen);
    seen = round_;
    if (leaving_) return;
    // Who is inside before the round closes may take pieces; who comes later sees it closed.
    ++inside_;
    if (open_ && me < parts_) take_pieces(me);
    if (--inside_ == 0) inside_.notify_all();
  }
}

/// One's own share first, then what others have left.
void Team::take_pieces(int me) {
  int const parts = parts_;
  for (int k = 0; k < parts; ++k) {
    Share& share = shares_[(me + k) % parts];
    for (;;) {
      Index const from = share.next.fetch_add(share.block, std::memory_order_relaxed);
      if (from >= share.end) break;
      call_(work_, from, std::min(share.end, from + share.block));
    }
  }
}

void Team::run_erased(int threads, Index pieces, Call call, void const* work) {
  if (busy_.exchange(true)) return call(work, 0, pieces);
  struct Release {
    std::atomic<bool>& busy;
    ~Release() { busy = false; }
  } const release{busy_};
  if (threads != asked_) asked_ = active_ = threads, stalls_ = rounds_ = 0, pause_ = 0;
  if (active_ < asked_ && Clock::now() >= retry_) active_ = asked_, stalls_ = rounds_ = 0;
  if (active_ < 2) return call(work, 0, pieces);
  grow(active_);
  parts_ = active_;
  call_ = call, work_ = work;
  for (int k = 0; k < parts_; ++k) {
    Share& share = shares_[k];
    auto const cut = [&](int part) { return static_cast<Index>(static_cast<long>(pieces) * part / parts_); };
    share.end = cut(k + 1);
    share.block = std::max<Index>(1, (share.end - cut(k)) / pieces_of_share);
    share.next.store(cut(k), std::memory_order_relaxed);
  }
  open_ = true;
  auto const begin = Clock::now();
  ++round_;
  round_.notify_all();
  take_pieces(0);
  open_ = false;
  for (int i = 0; i < spins && inside_.load(std::memory_order_acquire) != 0; ++i) breathe();
  if (inside_ == 0) return judge(0);
  auto const start = Clock::now();
  for (int still = inside_; still != 0; still = inside_) inside_.wait(still);
  auto const seconds = [](Clock::duration time) { return std::chrono::duration<double>(time).count(); };
  double const waited = seconds(Clock::now() - start);
  judge(waited > stalled_part * seconds(start - begin) ? waited : 0);
}

/// Halves the team when it had to wait too often of late; it is tried in full again after a pause that doubles each
/// time.
void Team::judge(double waited) {
  stalls_ += waited > stall;
  if (stalls_ >= tolerated_stalls) {
    pause_ = std::clamp(2 * pause_, first_pause, longest_pause);
    retry_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(pause_));
    active_ = (active_ + 1) / 2;
    stalls_ = rounds_ = 0;
  } else if (++rounds_ == watched_rounds) {
    if (stalls_ == 0) pause_ = 0;
    stalls_ = rounds_ = 0;
  }
}

}  // namespace fissure::cpu
