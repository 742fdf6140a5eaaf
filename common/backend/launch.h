// What for_each.h declares for CPUs: packs of lanes, pieces of the range for a team of threads, partial sums added in
// order. Only files of kernels include this, which are built for the processor at hand (fissure_kernel_flags in
// CMakeLists.txt).
#pragma once
#include <algorithm>
#include <vector>

#include "backend/for_each.h"
#include "backend/team.h"

namespace fissure::cpu {

/// The lane type with which the CPU runs a kernel: a pack where it says so, else its scalar.
template <class Kernel>
struct LaneOf {
  using type = typename Kernel::Real;
};
template <class Kernel>
requires(Kernel::packed) struct LaneOf<Kernel> {
  using type = Pack<typename Kernel::Real>;
};
template <class Kernel>
using Lane = typename LaneOf<Kernel>::type;

template <class Kernel>
void launch(int threads, Index first, Index n, Kernel const& kernel) {
  using S = Lane<Kernel>;
  constexpr Index step = [] {
    if constexpr (requires { Kernel::gathers; }) return Kernel::template block<S>;
    return static_cast<Index>(lane_width<S>);
  }();
  constexpr Index grain = std::max(16, step);  // a thread never shares a block of the element layout with another
  Index const grains = (n + grain - 1) / grain;
  constexpr bool costly = requires { Kernel::costly; };  // an item takes microseconds, not nanoseconds
  Team::get().run(grains < (costly ? 4 : 128) ? 1 : threads, grains, [&](Index from, Index to) {
    Kernel const mine = kernel;  // a private copy: its numbers can stay in registers across stores
    Index const end = std::min(n, to * grain);
    for (Index i = from * grain; i < end; i += step) mine.template operator()<S>(first + i);
  });
}

template <class Before, class After>
void launch_pair(int threads, Index first, Index n, Before const& before, After const& after) {
  using S = Lane<Before>;
  static_assert(std::is_same_v<S, Lane<After>>);
  constexpr Index grain = 16, longest = 512;
  Index const piece = std::clamp(n / (4 * threads) / grain * grain, grain, longest);
  Index const pieces = (n + piece - 1) / piece;
  Team::get().run(n < 16 * grain ? 1 : threads, pieces, [&](Index from, Index to) {
    Before const one = before;
    After const other = after;
    for (Index p = from; p < to; ++p) {
      Index const end = std::min(n, (p + 1) * piece);
      for (Index i = p * piece; i < end; i += lane_width<S>) one.template operator()<S>(first + i);
      for (Index i = p * piece; i < end; i += lane_width<S>) other.template operator()<S>(first + i);
    }
  });
}

template <int n_sums, class Combine, class Kernel>
Sums<n_sums> launch_sum(int threads, Index first, Index n, Kernel const& kernel, Sums<n_sums> const& start) {
  using S = Lane<Kernel>;
  Sums<n_sums> total = start;
  constexpr Index chunk = 1024;
  Index const chunks = (n + chunk - 1) / chunk;
  std::vector<Sums<n_sums>> partial(chunks, start);
  Team::get().run(chunks < 3 ? 1 : threads, chunks, [&](Index from, Index to) {
    Kernel const mine = kernel;
    for (Index c = from; c < to; ++c) {
      Index const end = std::min(n, (c + 1) * chunk);
      for (Index i = c * chunk; i < end; i += lane_width<S>) mine.template operator()<S>(first + i, partial[c]);
    }
  });
  for (auto const& part : partial)
    for (int k = 0; k < n_sums; ++k) total[k] = Combine()(total[k], part[k]);
  return total;
}

}  // namespace fissure::cpu
