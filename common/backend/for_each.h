// Running a kernel over a range, and summing over one, with the same result for any number of threads.
//
// A kernel is a small struct of pointers and numbers with
//   static constexpr char const* name;
//   template <class S> void operator()(Index i) const;                  for_each: lanes i .. i + lane_width<S>
//   template <class S> void operator()(Index i, Sums<n>& sums) const;   sum: adds to sums
// A kernel that `gathers` has many items at an index, block<S> of them, and itself fills packs with those that have
// something to do.
// S is the kernel's Real on a GPU (one thread per index) and, where `packed` is true, a SIMD pack of it on the CPU.
#pragma once
#include <array>
#include <limits>

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

/// Defined in backend/launch.cuh, instantiated for every kernel by src2d and src3d (kernels/instances.h).
namespace cuda {
template <class Kernel>
void launch(Index first, Index n, Kernel const& kernel);
template <int n_sums, class Combine, class Kernel>
Sums<n_sums> launch_sum(Index first, Index n, Kernel const& kernel, Sums<n_sums> const& start);
}  // namespace cuda

/// Defined in backend/launch.h, instantiated likewise, in files of kernels: they alone are built for the processor at
/// hand.
namespace cpu {
template <class Kernel>
void launch(int threads, Index first, Index n, Kernel const& kernel);
template <class Before, class After>
void launch_pair(int threads, Index first, Index n, Before const& before, After const& after);
template <int n_sums, class Combine, class Kernel>
Sums<n_sums> launch_sum(int threads, Index first, Index n, Kernel const& kernel, Sums<n_sums> const& start);
}  // namespace cpu

/// Runs kernel(i) for all i in [first, first + n). For packed kernels both are multiples of the layout width.
template <class Kernel>
void for_each(Device& device, Index first, Index n, Kernel const& kernel) {
  if (n <= 0) return;
  device.run(Kernel::name, [&] {
#if defined(FISSURE_CUDA)
    if (device.backend() == Backend::cuda) return cuda::launch(first, n, kernel);
#endif
    cpu::launch(device.threads(), first, n, kernel);
  });
}

/// Runs two packed kernels, of which the second may read what the first wrote at the same index: on the CPU they take
/// turns piece by piece, so that it is still near. Pieces are long, for a processor foresees only so many arrays at a
/// time.
template <class Before, class After>
void for_each(Device& device, Index first, Index n, Before const& before, After const& after) {
  if (device.backend() == Backend::cuda || device.watched()) {
    for_each(device, first, n, before);
    return for_each(device, first, n, after);
  }
  if (n <= 0) return;
  device.run(Before::name,
             [&] { device.run(After::name, [&] { cpu::launch_pair(device.threads(), first, n, before, after); }); });
}

/// Reduces over [first, first + n) in chunks of fixed size, combined in order: the same bits for any number of threads.
/// `start` is Combine's neutral element: every chunk begins with it.
template <int n_sums, class Combine = Add, class Kernel>
Sums<n_sums> sum_over(Device& device, Index first, Index n, Kernel const& kernel, Sums<n_sums> const& start = {}) {
  if (n <= 0) return start;
  return device.run(Kernel::name, [&] {
#if defined(FISSURE_CUDA)
    if (device.backend() == Backend::cuda) {
      device.count_copy(sizeof start);
      return cuda::launch_sum<n_sums, Combine>(first, n, kernel, start);
    }
#endif
    return cpu::launch_sum<n_sums, Combine>(device.threads(), first, n, kernel, start);
  });
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
