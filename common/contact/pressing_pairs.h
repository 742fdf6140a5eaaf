// Of the watched pairs those that have pressed since these were chosen: vertices sum their slots alone, and they alone
// rub. The others have no force.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "contact/candidates.h"

namespace fissure {

template <int D, class Real>
class PressingPairs {
 public:
  std::vector<Index> const& places() const { return places_; }  // among those that are watched, ascending
  Index count() const { return static_cast<Index>(places_.size()); }
  Index const* list() const { return list_.data(); }  // as places()
  // For kernels::PairForces.
  std::uint8_t const* listed() const { return listed_.data(); }
  int* news() { return news_.data(); }

  /// Others are watched now, and none of them has pressed.
  void forget(Device& device, std::size_t watched) {
    places_.clear();
    news_ = Buffer<int>(device, "contact flags", 1);
    place(device, watched);
  }
  /// Whether a pair has pressed that is not among them.
  bool stale() const { return !news_.empty() && news_.download_one(0) != 0; }
  /// It joins them, with all others like it.
  void renew(Device& device, Candidates<D, Real> const& watched) {
    news_.upload_one(0, 0);
    std::vector<Real> copies[3];
    auto const penetration = watched.penetration.look(copies[0]), work = watched.work.look(copies[1]),
               spring = watched.spring.look(copies[2]);
    std::vector<Index> now;
    std::size_t next = 0;
    for (std::size_t k = 0; k < watched.pairs.size(); ++k) {
      bool const known = next < places_.size() && places_[next] == static_cast<Index>(k);
      next += known;
      if (known || penetration[k] > 0 || work[k] != 0 || spring[k * kernels::spring_size<D> + D] > 0)
        now.push_back(static_cast<Index>(k));
    }
    places_ = std::move(now);
    place(device, watched.pairs.size());
  }

  void save(State& state) const { state["pressing pairs"] = state_bytes(places_); }
  /// After slots have been placed, which forgets them.
  void restore(Device& device, State const& state, std::size_t watched) {
    places_ = state_values<Index>(state, "pressing pairs");
    for (std::size_t k = 0; k < places_.size(); ++k)
      check_index("pressing pairs", places_[k], watched, k > 0 ? places_[k - 1] + 1 : 0);
    place(device, watched);
  }

 private:
  void place(Device& device, std::size_t watched) {
    std::vector<std::uint8_t> listed(watched, 0);
    for (Index const place : places_) listed[place] = 1;
    list_ = Buffer<Index>(device, "contact candidates", places_);
    listed_ = Buffer<std::uint8_t>(device, "contact candidates", listed);
  }

  std::vector<Index> places_;
  Buffer<Index> list_;
  Buffer<std::uint8_t> listed_;  // by watched pair
  Buffer<int> news_;
};

}  // namespace fissure
