// Pairs of elements near each other. Most have a gap and sleep until things have moved so far (kernels::PairForces);
// those that may be looked at before the path is much longer are watched, and they alone cost a step anything.
#pragma once
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <vector>

#include "contact/candidates.h"

namespace fissure {

template <int D, class Real>
class NearPairs {
 public:
  std::vector<contact::ElementPair> const& all() const { return pairs_; }  // ascending

  /// A new list: `found`, ascending, and what flew apart faster than the list's buffer, until its friction spring has
  /// let go.
  void renew(std::vector<contact::ElementPair> const& found, Candidates<D, Real> const& watched) {
    note(watched);
    list(watched.with_holding(found), [](double) { return 0.0; });
  }
  /// These join it, ascending; those of them that are watched have been seen.
  void join(std::vector<contact::ElementPair> const& found, Candidates<D, Real> const& watched) {
    std::vector<contact::ElementPair> all;
    std::set_union(found.begin(), found.end(), pairs_.begin(), pairs_.end(), std::back_inserter(all));
    list(std::move(all), [](double wake) { return wake; });
    note(watched);
  }
  /// Only pairs of which keep(pair) is true.
  template <class Keep>
  void keep_only(Keep const& keep) {
    std::vector<contact::ElementPair> kept;
    std::copy_if(pairs_.begin(), pairs_.end(), std::back_inserter(kept), keep);
    list(std::move(kept), [](double wake) { return wake; });
  }

  /// Whether some that are not watched may touch at this path.
  bool stale(double path) const { return !pairs_.empty() && path > horizon_; }
  /// Watched are those that may touch before the path is longer by `window`, with their springs. `late`: one that
  /// nobody has looked at may overlap already, and begins without force.
  void watch(Device& device, Candidates<D, Real>& watched, double path, double window, bool late) {
    std::vector<contact::ElementPair> now;
    std::vector<double> wakes;
    std::vector<std::uint8_t> axes;
    std::vector<std::size_t> fresh;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      if (wake_[k] > path + window) continue;
      if (wake_[k] == unseen) fresh.push_back(now.size());
      now.push_back(pairs_[k]), wakes.push_back(std::max(wake_[k], 0.0)), axes.push_back(axis_[k]);
    }
    horizon_ = path + window;
    auto springs = watched.carried_to(now, watched.spring.download(), 0);
    for (std::size_t const k : fresh)
      if (late) springs[(k + 1) * kernels::spring_size<D> - 1] = -1;
    watched.set(device, std::move(now), springs);
    watched.wake.upload(wakes), watched.axis.upload(axes);
  }
  /// Until when those that are watched sleep, and what parted them.
  void note(Candidates<D, Real> const& watched) {
    auto const wakes = watched.wake.download();
    auto const axes = watched.axis.download();
    in_both(watched,
            [&](std::size_t mine, std::size_t theirs) { wake_[mine] = wakes[theirs], axis_[mine] = axes[theirs]; });
  }

  void save(State& state, Candidates<D, Real> const& watched) const {
    NearPairs now = *this;
    now.note(watched);
    state["near pairs"] = state_bytes(now.pairs_), state["near wakes"] = state_bytes(now.wake_);
    state["near axes"] = state_bytes(now.axis_);
    state["near horizon"] = state_bytes(std::vector<double>{horizon_});
  }
  /// `watched` has been restored.
  void restore(State const& state, std::size_t elements, Candidates<D, Real>& watched) {
    pairs_ = state_values<contact::ElementPair>(state, "near pairs");
    for (auto const& [a, b] : pairs_) check_index("near pairs", a, elements), check_index("near pairs", b, elements);
    wake_ = state_values<double>(state, "near wakes", pairs_.size());
    axis_ = state_values<std::uint8_t>(state, "near axes", pairs_.size());
    horizon_ = state_values<double>(state, "near horizon", 1)[0];
    std::vector<double> wakes(watched.pairs.size(), 0);
    std::vector<std::uint8_t> axes(watched.pairs.size(), kernels::no_axis);
    in_both(watched,
            [&](std::size_t mine, std::size_t theirs) { wakes[theirs] = wake_[mine], axes[theirs] = axis_[mine]; });
    watched.wake.upload(wakes), watched.axis.upload(axes);
  }

 private:
  static constexpr double unseen = -1;

  /// `now` is the list; of pairs that it had the wake is f(what it was), and what parted them is still known.
  template <class F>
  void list(std::vector<contact::ElementPair> now, F const& f) {
    std::vector<double> wakes;
    std::vector<std::uint8_t> axes;
    wakes.reserve(now.size()), axes.reserve(now.size());
    std::size_t k = 0;
    for (auto const& pair : now) {
      while (k < pairs_.size() && pairs_[k] < pair) ++k;
      bool const known = k < pairs_.size() && pairs_[k] == pair && wake_[k] != unseen;
      wakes.push_back(known ? f(wake_[k]) : unseen), axes.push_back(known ? axis_[k] : kernels::no_axis);
    }
    pairs_ = std::move(now), wake_ = std::move(wakes), axis_ = std::move(axes);
    horizon_ = unseen;
  }
  template <class Each>
  void in_both(Candidates<D, Real> const& watched, Each const& each) const {
    std::size_t k = 0;
    for (std::size_t w = 0; w < watched.pairs.size(); ++w) {
      while (k < pairs_.size() && pairs_[k] < watched.pairs[w]) ++k;
      if (k < pairs_.size() && pairs_[k] == watched.pairs[w]) each(k, w);
    }
  }

  std::vector<contact::ElementPair> pairs_;
  std::vector<double> wake_;        // path at which each must be looked at again [m]
  std::vector<std::uint8_t> axis_;  // along which a gap was last seen (kernels::PairForces)
  double horizon_ = unseen;         // path up to which no other than those that are watched may touch [m]
};

}  // namespace fissure
