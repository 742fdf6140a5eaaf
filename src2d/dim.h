// The contract of base/dim.h in two dimensions.
#pragma once
#include "base/dim.h"
#include "base/lanes.h"

namespace fissure {

template <>
struct Dim<2> {
  static constexpr char const* name = "2D";
  static constexpr char const* program = "fissure2d";
  static constexpr int corners = 3, face_corners = 2;
  static constexpr int vtk_simplex = 5, vtk_block = 9;  // VTK's numbers of cells
  static constexpr int stresses = 4;                    // numbers of a symmetric tensor, in the order xx yy zz xy yz zx
  static constexpr bool has_plane_stress = true, can_revolve = true;
  static constexpr double simplex_share = 1.0 / 2;  // measure of a simplex over the determinant of its edges

  /// With the strain out of the plane: none in plane strain, the hoop strain in axisymmetry.
  template <class S>
  FISSURE_HD static Mat<S, 3> embed(Mat<S, 2> const& H, S const& out = S(0)) {
    Mat<S, 3> padded = Mat<S, 3>::Constant(S(0));
    padded(0, 0) = H(0, 0), padded(0, 1) = H(0, 1);
    padded(1, 0) = H(1, 0), padded(1, 1) = H(1, 1);
    padded(2, 2) = out;
    return padded;
  }

  /// cof(M): M^-1 = cof(M)^T / det(M), and det(M) = M.col(0) . cof(M).col(0).
  template <class S>
  FISSURE_HD static Mat<S, 2> cofactor(Mat<S, 2> const& M) {
    Mat<S, 2> C;
    C(0, 0) = M(1, 1), C(0, 1) = -M(1, 0);
    C(1, 0) = -M(0, 1), C(1, 1) = M(0, 0);
    return C;
  }

  /// det(I + H) - 1 without cancellation.
  template <class S>
  FISSURE_HD static S volume_change(Mat<S, 2> const& H) {
    return H(0, 0) + H(1, 1) + (H(0, 0) * H(1, 1) - H(0, 1) * H(1, 0));
  }

  /// Normal of the edge p[0] -> p[1], to its right; its length is the edge's [m].
  template <class S>
  FISSURE_HD static Vec<S, 2> face_normal(Vec<S, 2> const (&p)[2]) {
    Vec<S, 2> n;
    n[0] = p[1][1] - p[0][1];
    n[1] = p[0][0] - p[1][0];
    return n;
  }

  /// Share of a slip that is out of the plane of loading (along z): mode III in a through-going crack [-].
  template <class S>
  FISSURE_HD static S out_of_plane_share(Vec<S, 2> const&) {
    return S(0);
  }
};

static_assert(Dimension<2>);

}  // namespace fissure
