// The tests' kernels for CUDA.
#include "backend/launch.cuh"
#include "backend_kernels.h"

namespace fissure::cuda {
template void launch(Index, Index, test::Scale<double> const&);
template void launch(Index, Index, test::Scale<float> const&);
template void launch(Index, Index, test::Number const&);
template Sums<2> launch_sum<2, Add>(Index, Index, test::Moments const&, Sums<2> const&);
template Sums<1> launch_sum<1, Add>(Index, Index, test::Total<double> const&, Sums<1> const&);
template Sums<1> launch_sum<1, Add>(Index, Index, test::Total<float> const&, Sums<1> const&);
template Sums<2> launch_sum<2, Larger>(Index, Index, test::Range const&, Sums<2> const&);
}  // namespace fissure::cuda
