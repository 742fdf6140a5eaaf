// Small fixed vectors and matrices (Eigen) over any scalar: double, float or a pack of either.
#pragma once
#include <Eigen/Dense>

#if defined(__CUDACC__)
#define FISSURE_HD __host__ __device__ inline
#else
#define FISSURE_HD inline __attribute__((always_inline))
#endif

namespace fissure {

template <class S, int D>
using Vec = Eigen::Matrix<S, D, 1>;
template <class S, int D>
using Mat = Eigen::Matrix<S, D, D>;

using Vec3 = Eigen::Vector3d;

}  // namespace fissure
