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

namespace cuda {
template <class Kernel>
void launch(Index n, Kernel const& kernel);
template <int n_sums, class Kernel>
Sums<n_sums> launch_sum(Index n, Kernel const& kernel);
}  // namespace cuda

#if !defined(__CUDACC__)

/// The lane type with which the CPU runs a kernel.
template <class Kernel>
using CpuLane = std::conditional_t<Kernel::packed, Pack<typename Kernel::Real>, typename Kernel::Real>;

/// Runs kernel(i) for all i in [first, first + n). For packed kernels both are multiples of the layout width.
template <class Kernel>
void for_each(Device& device, Index first, Index n, Kernel const& kernel) {
  if (n <= 0) return;
  device.count(Kernel::name);
#if defined(FISSURE_CUDA)
  if (device.backend() == Backend::cuda) return cuda::launch(n, kernel.shifted(first));
#endif
  using S = CpuLane<Kernel>;
  constexpr Index grain = 16;  // a thread never shares a block of the element layout with another
  Index const grains = (n + grain - 1) / grain;
#pragma omp parallel num_threads(device.threads()) if (grains > 16)
  {
    Kernel const mine = kernel;  // a private copy: its numbers can stay in registers across stores
#pragma omp for schedule(static)
    for (Index g = 0; g < grains; ++g) {
      Index const end = std::min(n, (g + 1) * grain);
      for (Index i = g * grain; i < end; i += lane_width<S>) mine.template operator()<S>(first + i);
    }
  }
}

/// Sums over [first, first + n) in chunks of fixed size, added up in order: the same bits for any number of threads.
template <int n_sums, class Kernel>
Sums<n_sums> sum_over(Device& device, Index first, Index n, Kernel const& kernel) {
  Sums<n_sums> total{};
  if (n <= 0) return total;
  device.count(Kernel::name);
#if defined(FISSURE_CUDA)
  if (device.backend() == Backend::cuda) return cuda::launch_sum<n_sums>(n, kernel.shifted(first));
#endif
  using S = CpuLane<Kernel>;
  constexpr Index chunk = 1024;
  Index const chunks = (n + chunk - 1) / chunk;
  std::vector<Sums<n_sums>> partial(chunks, Sums<n_sums>{});
#pragma omp parallel num_threads(device.threads()) if (chunks > 1)
  {
    Kernel const mine = kernel;
#pragma omp for schedule(static)
    for (Index c = 0; c < chunks; ++c) {
      Index const end = std::min(n, (c + 1) * chunk);
      for (Index i = c * chunk; i < end; i += lane_width<S>) mine.template operator()<S>(first + i, partial[c]);
    }
  }
  for (auto const& part : partial)
    for (int k = 0; k < n_sums; ++k) total[k] += part[k];
  return total;
}
#endif

}  // namespace fissure
