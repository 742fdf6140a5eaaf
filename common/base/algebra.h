// Small fixed vectors and matrices (Eigen) over any scalar: double, float or a pack of either.
#pragma once
#if !defined(__CUDACC__) && !defined(EIGEN_STRONG_INLINE) && !defined(FISSURE_CONTRACTS)
// Else g++ passes packs through memory from one of Eigen's layers to the next.
#define EIGEN_STRONG_INLINE inline __attribute__((always_inline))
#endif
#include <Eigen/Dense>

#if defined(__CUDACC__)
#define FISSURE_HD __host__ __device__ inline
#define FISSURE_DEVICE __host__ __device__
#define FISSURE_HOT __host__ __device__ inline
#define FISSURE_RARE
#define FISSURE_CALL __host__ __device__ inline
#if defined(__CUDA_ARCH__)
#define FISSURE_UNROLL _Pragma("unroll")
#else
#define FISSURE_UNROLL
#endif
#elif defined(FISSURE_CONTRACTS)  // nothing is forced into another: compiles in less memory, and can be stepped through
#define FISSURE_HD inline
#define FISSURE_DEVICE
#define FISSURE_HOT __attribute__((noinline))
#define FISSURE_RARE __attribute__((noinline, cold))
#define FISSURE_CALL __attribute__((noinline))
#define FISSURE_UNROLL
#else
#define FISSURE_HD inline __attribute__((always_inline))
#define FISSURE_DEVICE
#define FISSURE_HOT __attribute__((noinline, flatten))  // inlines everything it calls: packs must stay in registers
#define FISSURE_RARE __attribute__((noinline, cold))
#define FISSURE_CALL __attribute__((noinline, flatten))  // one copy that several kernels call
#define FISSURE_UNROLL _Pragma("GCC unroll 16")  // small matrices of packs stay in registers only when no index is left
#endif

namespace fissure {

template <class S, int D>
using Vec = Eigen::Matrix<S, D, 1>;
template <class S, int D>
using Mat = Eigen::Matrix<S, D, D>;

using Vec3 = Eigen::Vector3d;

}  // namespace fissure
