// Running a kernel over a range, and summing over one, with the same result for any number of threads.
//
// A kernel is a small struct of pointers and numbers with
//   static constexpr char const* name;
//   template <class S> void operator()(Index i) const;                  for_each: lanes i .. i + lane_width<S>
//   template <class S> void operator()(Index i, Sums<n>& sums) const;   sum: adds to sums
// S is the kernel's Real on a GPU (one thread per index) and, where `packed` is true, a SIMD pack of it on the CPU.
#pragma once
#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "backend/device.h"
#include "base/lanes.h"

namespace fissure {

/// n sums in double, whatever the precision of the run.
template <int n>
using Sums = std::array<double, n>;

/// Adds every lane of `value` to `sum`, in order.
template <class S>
FISSURE_HD void add_lanes(S const& value, double& sum) {
  for (int l = 0; l < lane_width<S>; ++l) sum += static_cast<double>(lane(value, l));
}

/// How two partial results become one.
struct Add {
  FISSURE_HD double operator()(double a, double b) const { return a + b; }
};
struct Larger {
  FISSURE_HD double operator()(double a, double b) const { return a > b ? a : b; }
};

#if !defined(__CUDACC__)

/// Defined in backend/launch.cuh, instantiated for every kernel by src2d and src3d (kernels/instances.cuh).
namespace cuda {
template <class Kernel>
void launch(Index first, Index n, Kernel const& kernel);
template <int n_sums, class Combine, class Kernel>
Sums<n_sums> launch_sum(Index first, Index n, Kernel const& kernel, Sums<n_sums> const& start);
}  // namespace cuda

/// The lane type with which the CPU runs a kernel: a pack where it says so, else its scalar.
template <class Kernel>
struct CpuLaneOf {
  using type = typename Kernel::Real;
};
template <class Kernel>
  requires(Kernel::packed)
struct CpuLaneOf<Kernel> {
  using type = Pack<typename Kernel::Real>;
};
template <class Kernel>
using CpuLane = typename CpuLaneOf<Kernel>::type;

/// Runs kernel(i) for all i in [first, first + n). For packed kernels both are multiples of the layout width.
template <class Kernel>
void for_each(Device& device, Index first, Index n, Kernel const& kernel) {
  if (n <= 0) return;
  device.count(Kernel::name);
#if defined(FISSURE_CUDA)
  if (device.backend() == Backend::cuda) return cuda::launch(first, n, kernel);
#endif
  using S = CpuLane<Kernel>;
  constexpr Index grain = 16;  // a thread never shares a block of the element layout with another
  Index const grains = (n + grain - 1) / grain;
#pragma omp parallel num_threads(device.threads()) if (grains >= 128)
  {
    Kernel const mine = kernel;  // a private copy: its numbers can stay in registers across stores
#pragma omp for schedule(static)
    for (Index g = 0; g < grains; ++g) {
      Index const end = std::min(n, (g + 1) * grain);
      for (Index i = g * grain; i < end; i += lane_width<S>) mine.template operator()<S>(first + i);
    }
  }
}

/// Runs two packed kernels, of which the second may read what the first wrote at the same index: on the CPU they take turns piece by
/// piece, so that it is still near. Pieces are long, for a processor foresees only so many arrays at a time.
template <class Before, class After>
void for_each(Device& device, Index first, Index n, Before const& before, After const& after) {
  if (device.backend() == Backend::cuda) {
    for_each(device, first, n, before);
    return for_each(device, first, n, after);
  }
  if (n <= 0) return;
  device.count(Before::name);
  device.count(After::name);
  using S = CpuLane<Before>;
  static_assert(std::is_same_v<S, CpuLane<After>>);
  constexpr Index grain = 16, longest = 512;
  Index const piece = std::clamp(n / (4 * device.threads()) / grain * grain, grain, longest);
  Index const pieces = (n + piece - 1) / piece;
#pragma omp parallel num_threads(device.threads()) if (n >= 16 * grain)
  {
    Before const one = before;
    After const other = after;
#pragma omp for schedule(static)
    for (Index p = 0; p < pieces; ++p) {
      Index const end = std::min(n, (p + 1) * piece);
      for (Index i = p * piece; i < end; i += lane_width<S>) one.template operator()<S>(first + i);
      for (Index i = p * piece; i < end; i += lane_width<S>) other.template operator()<S>(first + i);
    }
  }
}

/// Reduces over [first, first + n) in chunks of fixed size, combined in order: the same bits for any number of threads.
/// `start` is Combine's neutral element: every chunk begins with it.
template <int n_sums, class Combine = Add, class Kernel>
Sums<n_sums> sum_over(Device& device, Index first, Index n, Kernel const& kernel, Sums<n_sums> const& start = {}) {
  Sums<n_sums> total = start;
  if (n <= 0) return total;
  device.count(Kernel::name);
#if defined(FISSURE_CUDA)
  if (device.backend() == Backend::cuda) return cuda::launch_sum<n_sums, Combine>(first, n, kernel, start);
#endif
  using S = CpuLane<Kernel>;
  constexpr Index chunk = 1024;
  Index const chunks = (n + chunk - 1) / chunk;
  std::vector<Sums<n_sums>> partial(chunks, start);
#pragma omp parallel num_threads(device.threads()) if (chunks > 2)
  {
    Kernel const mine = kernel;
#pragma omp for schedule(static)
    for (Index c = 0; c < chunks; ++c) {
      Index const end = std::min(n, (c + 1) * chunk);
      for (Index i = c * chunk; i < end; i += lane_width<S>) mine.template operator()<S>(first + i, partial[c]);
    }
  }
  for (auto const& part : partial)
    for (int k = 0; k < n_sums; ++k) total[k] = Combine()(total[k], part[k]);
  return total;
}

/// The largest of each of n values; `kernel` keeps the larger in its sums.
template <int n_values, class Kernel>
Sums<n_values> largest_over(Device& device, Index first, Index n, Kernel const& kernel) {
  Sums<n_values> least;
  least.fill(-std::numeric_limits<double>::infinity());
  return sum_over<n_values, Larger>(device, first, n, kernel, least);
}
#endif

}  // namespace fissure
