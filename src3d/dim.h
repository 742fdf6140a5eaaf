// The contract of base/dim.h in three dimensions.
#pragma once
#include "base/dim.h"
#include "base/lanes.h"

namespace fissure {

template <>
struct Dim<3> {
  static constexpr char const* name = "3D";
  static constexpr char const* program = "fissure3d";
  static constexpr int corners = 4, face_corners = 3;
  static constexpr int vtk_simplex = 10, vtk_block = 12;  // VTK's numbers of cells
  static constexpr int stresses = 6;  // numbers of a symmetric tensor, in the order xx yy zz xy yz zx
  static constexpr bool has_plane_stress = false, can_revolve = false;
  static constexpr double simplex_share = 1.0 / 6;  // measure of a simplex over the determinant of its edges

  template <class S>
  FISSURE_HD static Mat<S, 3> const& embed(Mat<S, 3> const& H, S const& = S(0)) {
    return H;
  }

  /// cof(M): M^-1 = cof(M)^T / det(M), and det(M) = M.col(0) . cof(M).col(0).
  template <class S>
  FISSURE_HD static Mat<S, 3> cofactor(Mat<S, 3> const& M) {
    Mat<S, 3> C;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        int const a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
        C(i, j) = M(a, c) * M(b, d) - M(a, d) * M(b, c);
      }
    return C;
  }

  /// det(I + H) - 1 without cancellation.
  template <class S>
  FISSURE_HD static S volume_change(Mat<S, 3> const& H) {
    Mat<S, 3> const C = cofactor(H);
    return H.trace() + C.trace() + H.col(0).dot(C.col(0));
  }

  /// Normal of the triangle p; its length is the triangle's area [m^2].
  template <class S>
  FISSURE_HD static Vec<S, 3> face_normal(Vec<S, 3> const (&p)[3]) {
    return half_cross<S>(p[1] - p[0], p[2] - p[0]);
  }

  /// Normal of the quadrilateral p, warped or not: half the cross product of its diagonals. Its length is the area
  /// [m^2].
  template <class S>
  FISSURE_HD static Vec<S, 3> face_normal(Vec<S, 3> const (&p)[4]) {
    return half_cross<S>(p[2] - p[0], p[3] - p[1]);
  }

  /// Share of a slip that is out of the plane of loading (along z): mode III in a through-going crack [-].
  template <class S>
  FISSURE_HD static S out_of_plane_share(Vec<S, 3> const& slip) {
    S const squared = slip.squaredNorm();
    return squared > S(0) ? slip[2] * slip[2] / squared : S(0);
  }

 private:
  template <class S>
  FISSURE_HD static Vec<S, 3> half_cross(Vec<S, 3> const& a, Vec<S, 3> const& b) {
    Vec<S, 3> n;
    n[0] = as<S>(0.5) * (a[1] * b[2] - a[2] * b[1]);
    n[1] = as<S>(0.5) * (a[2] * b[0] - a[0] * b[2]);
    n[2] = as<S>(0.5) * (a[0] * b[1] - a[1] * b[0]);
    return n;
  }
};

static_assert(Dimension<3>);

}  // namespace fissure
