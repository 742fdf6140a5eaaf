// What for_each.h declares for CUDA: a thread per index, and sums by a tree whose shape depends on n alone, so that a
// result is the same from run to run. Only CUDA files include this.
#pragma once
#include "backend/for_each.h"

namespace fissure::cuda {

/// Throws Error when the device refused the launch just made of `kernel`, or something before it failed.
void check_launch(char const* kernel);
/// Device memory for n partial results, kept between calls.
double* scratch(std::size_t n);

inline constexpr int threads_per_block = 128, most_sum_blocks = 1024;

template <class Kernel>
__global__ void __launch_bounds__(threads_per_block) run(Kernel kernel, Index first, Index n) {
  unsigned const i = blockIdx.x * threads_per_block + threadIdx.x;
  if (i < static_cast<unsigned>(n)) kernel.template operator()<typename Kernel::Real>(first + static_cast<Index>(i));
}

/// Combines the sums of a block's threads pairwise: thread t with t + 64, t + 32, ...
template <int n_sums, class Combine>
__device__ void combine_block(Sums<n_sums> const& mine, double* to) {
  __shared__ double sums[n_sums][threads_per_block];
  int const t = static_cast<int>(threadIdx.x);
  for (int k = 0; k < n_sums; ++k) sums[k][t] = mine[k];
  for (int half = threads_per_block / 2; half > 0; half /= 2) {
    __syncthreads();
    if (t < half)
      for (int k = 0; k < n_sums; ++k) sums[k][t] = Combine()(sums[k][t], sums[k][t + half]);
  }
  if (t == 0)
    for (int k = 0; k < n_sums; ++k) to[k] = sums[k][0];
}

template <int n_sums, class Combine, class Kernel>
__global__ void __launch_bounds__(threads_per_block)
    sum_blocks(Kernel kernel, Index first, Index n, Sums<n_sums> start, double* partial) {
  Sums<n_sums> mine = start;
  long const stride = static_cast<long>(gridDim.x) * threads_per_block;
  for (long i = static_cast<long>(blockIdx.x) * threads_per_block + threadIdx.x; i < n; i += stride)
    kernel.template operator()<typename Kernel::Real>(first + static_cast<Index>(i), mine);
  combine_block<n_sums, Combine>(mine, partial + blockIdx.x * n_sums);
}

template <int n_sums, class Combine>
__global__ void __launch_bounds__(threads_per_block)
    sum_partial(double const* partial, int n, Sums<n_sums> start, double* total) {
  Sums<n_sums> mine = start;
  for (int i = static_cast<int>(threadIdx.x); i < n; i += threads_per_block)
    for (int k = 0; k < n_sums; ++k) mine[k] = Combine()(mine[k], partial[i * n_sums + k]);
  combine_block<n_sums, Combine>(mine, total);
}

template <class Kernel>
void launch(Index first, Index n, Kernel const& kernel) {
  int const blocks = (n - 1) / threads_per_block + 1;
  run<<<blocks, threads_per_block>>>(kernel, first, n);
  check_launch(Kernel::name);
}

template <int n_sums, class Combine, class Kernel>
Sums<n_sums> launch_sum(Index first, Index n, Kernel const& kernel, Sums<n_sums> const& start) {
  int const needed = (n - 1) / threads_per_block + 1, blocks = needed < most_sum_blocks ? needed : most_sum_blocks;
  double* const partial = scratch(static_cast<std::size_t>(blocks + 1) * n_sums);
  double* const on_device = partial + static_cast<std::size_t>(blocks) * n_sums;
  sum_blocks<n_sums, Combine><<<blocks, threads_per_block>>>(kernel, first, n, start, partial);
  sum_partial<n_sums, Combine><<<1, threads_per_block>>>(partial, blocks, start, on_device);
  check_launch(Kernel::name);
  Sums<n_sums> total;
  download(total.data(), on_device, sizeof total);
  return total;
}

}  // namespace fissure::cuda
