// The d-linear cell on the cube -1..1 of each axis: quadrilateral and hexahedron with VTK's order of corners.
//   N_a = product over axes of (1 + s_a xi)/2.  Every nodal field is a sum of 2^d modes: constant, linear in each
//   axis, and products of axes, the hourglass modes, whose gradient vanishes at the centre: in 2D xi eta; in 3D eta
//   zeta, zeta xi,
//   xi eta, xi eta zeta.
#pragma once
#include "base/algebra.h"

namespace fissure {

template <int D>
struct BlockShape {
  static constexpr int corners = 1 << D, modes = corners - 1 - D, points = 1 << D;
  static constexpr int faces = 2 * D, face_corners = 1 << (D - 1);

  /// Corner i of face a, in turn around the face so that its normal points outward.
  FISSURE_HD static constexpr int face(int a, int i) {
    if constexpr (face_corners == 2) {
      return (a + i) % corners;
    } else {
      constexpr int corner[6][4] = {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}};
      return corner[a][i];
    }
  }

  /// Where corner a lies on an axis: -1 or +1.
  FISSURE_HD static constexpr int sign(int a, int axis) {
    int const around = a % 4;
    bool const high = axis == 0 ? around == 1 || around == 2 : axis == 1 ? around >= 2 : a >= 4;
    return high ? 1 : -1;
  }

  /// Value of hourglass mode m at corner a: the last one is the product of all axes, mode m of the others leaves out
  /// axis m.
  FISSURE_HD static constexpr int mode(int m, int a) {
    int product = 1;
    for (int axis = 0; axis < D; ++axis)
      if (m == modes - 1 || axis != m) product *= sign(a, axis);
    return product;
  }

  /// Gauss point p of the rule with two points per axis, exact up to cubes; its weight is 1.
  FISSURE_HD static constexpr double point(int p, int axis) { return 0.57735026918962576451 * sign(p, axis); }

  /// N_a at Gauss point p; p < 0: at the centre.
  FISSURE_HD static constexpr double value(int a, int p) {
    double product = 1;
    for (int axis = 0; axis < D; ++axis) product *= 0.5 * (1 + (p < 0 ? 0 : sign(a, axis) * point(p, axis)));
    return product;
  }

  /// dN_a/d(axis) at Gauss point p; p < 0: at the centre.
  FISSURE_HD static constexpr double slope(int a, int axis, int p) {
    double product = 0.5 * sign(a, axis);
    for (int other = 0; other < D; ++other)
      if (other != axis) product *= 0.5 * (1 + (p < 0 ? 0 : sign(a, other) * point(p, other)));
    return product;
  }
};

}  // namespace fissure
