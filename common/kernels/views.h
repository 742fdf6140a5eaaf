// What kernels see of a model: plain pointers into device memory, and how element arrays are laid out.
#pragma once
#include <cstdint>
#include <numbers>

#include "base/dim.h"
#include "base/expect.h"
#include "base/lanes.h"

namespace fissure::kernels {

/// Element arrays are blocked: `layout_width` elements stand side by side for each number, so that a pack of lanes is
/// one aligned load (and a warp's loads fall into whole cache lines). Ranges of elements are padded to whole blocks.
inline constexpr Index layout_width = 16;

/// Address of number `k` of `n` of element `e` in a blocked array.
FISSURE_HD std::size_t blocked(Index e, Index k, Index n) {
  FISSURE_EXPECT(e >= 0 && k >= 0 && k < n);
  return (static_cast<std::size_t>(e / layout_width) * n + k) * layout_width + e % layout_width;
}
/// Place of point p of block b, of which each has so many: points of a pack of blocks stand side by side.
FISSURE_HD Index point_of_block(Index b, Index p, Index points) {
  return b / layout_width * layout_width * points + p * layout_width + b % layout_width;
}

/// Tells the host that something happened; all threads that do so write the same word.
FISSURE_HD void raise(int* flag) {
#if defined(__CUDA_ARCH__)
  *flag = 1;
#else
  __atomic_store_n(flag, 1, __ATOMIC_RELAXED);
#endif
}

/// Faces of cells of whose joints a point began to soften or came to hold nothing in a step, cell * faces + face, in no
/// order.
struct FaceEvents {
  int* count = nullptr;
  Index* list = nullptr;  // room for every face: each tells at most once a step
  Index first_cell = 0;

  FISSURE_HD void tell(Index cell, int faces, int face) const {
#if defined(__CUDA_ARCH__)
    int const at = atomicAdd(count, 1);
#else
    int const at = __atomic_fetch_add(count, 1, __ATOMIC_RELAXED);
#endif
    list[at] = (first_cell + cell) * faces + face;
  }
};

/// What corner i of n gets of a piece whose centroid goes around at the mean radius of the corners, over a like share:
/// the integral of its linear shape function times the radius.
template <int n, class S>
FISSURE_HD S ring_share(S const& radius, S const& mean) {
  return (radius / mean + S(n)) * as<S>(1.0 / (n + 1));
}

/// Geometry and motion. A corner is one of the D + 1 of an element; a vertex carries displacement, velocity and mass.
/// Corners are sorted by mesh node, so the corners of a face stand in the same order in both elements that share it.
template <int D, class Real>
struct MeshView {
  Index n_elements = 0, n_vertices = 0;  // padded
  Real const* X = nullptr;               // reference coordinates [m]: blocked, number a * D + c of (D + 1) * D
  // blocked, number a of D + 1; null: vertex = e * (D + 1) + a (every corner its own)
  Index const* corner_vertex = nullptr;
  std::int8_t const* parity = nullptr;  // per element: +1 where the sorted corners are positively oriented, else -1
  Real* u = nullptr;                    // displacement [m], [vertex][D]
  Real* v = nullptr;                    // velocity [m/s], [vertex][D]
  double thickness = 1;                 // out of plane [m], unless:
  bool axisymmetric = false;            // a body of revolution; X[0] is the distance from its axis

  /// How far element e reaches out of the plane [m]; in axisymmetry once around, at its centroid's radius at rest.
  FISSURE_HD Real out_of_plane(Index e) const {
    if constexpr (Dim<D>::can_revolve)
      if (axisymmetric) {
        Real radii = 0;
        for (int a = 0; a <= D; ++a) radii += X[blocked(e, a * D, (D + 1) * D)];
        return Real(2 * std::numbers::pi / (D + 1)) * radii;
      }
    return Real(thickness);
  }
  FISSURE_HD Index vertex(Index e, Index a) const {
    return corner_vertex ? corner_vertex[blocked(e, a, D + 1)] : e * (D + 1) + a;
  }
  FISSURE_HD Vec<Real, D> reference(Index e, Index a) const {
    Vec<Real, D> x;
    for (int c = 0; c < D; ++c) x[c] = X[blocked(e, a * D + c, (D + 1) * D)];
    return x;
  }
  FISSURE_HD Vec<Real, D> displacement(Index vertex) const {
    Vec<Real, D> x;
    for (int c = 0; c < D; ++c) x[c] = u[static_cast<std::size_t>(vertex) * D + c];
    return x;
  }
  FISSURE_HD Vec<Real, D> velocity(Index vertex) const {
    Vec<Real, D> x;
    for (int c = 0; c < D; ++c) x[c] = v[static_cast<std::size_t>(vertex) * D + c];
    return x;
  }
  FISSURE_HD Vec<Real, D> position(Index e, Index a) const { return reference(e, a) + displacement(vertex(e, a)); }
};

}  // namespace fissure::kernels
