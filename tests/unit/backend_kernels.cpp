// The tests' kernels for CPUs.
#include "backend_kernels.h"

#include "backend/launch.h"

namespace fissure::cpu {
template void launch(int, Index, Index, test::Scale<double> const&);
template void launch(int, Index, Index, test::Scale<float> const&);
template void launch(int, Index, Index, test::Number const&);
template Sums<2> launch_sum<2, Add>(int, Index, Index, test::Moments const&, Sums<2> const&);
template Sums<1> launch_sum<1, Add>(int, Index, Index, test::Total<double> const&, Sums<1> const&);
template Sums<1> launch_sum<1, Add>(int, Index, Index, test::Total<float> const&, Sums<1> const&);
template Sums<2> launch_sum<2, Larger>(int, Index, Index, test::Range const&, Sums<2> const&);
}  // namespace fissure::cpu
