// Cutting a straight piece of boundary in two dimensions: an interval in the weights of the two points that span its
// line.
//   integral of f w_k over a segment:  L/6 [(f_a + f_b)(w_a + w_b) + f_a w_a + f_b w_b],  exact for linear f and w.
#pragma once
#include <limits>

#include "base/lanes.h"

namespace fissure {

template <int D>
struct Clip;

template <>
struct Clip<2> {
  /// A convex part of a line; each end by its weights on the two points that span the line (they sum to one).
  template <class Real>
  struct Patch {
    Vec<Real, 2> point[2];
    int n = 0;  // 2, or 0 when nothing is left
  };

  /// The segment between the two spanning points.
  template <class Real>
  FISSURE_HD static Patch<Real> simplex_patch() { return {{{Real(1), Real(0)}, {Real(0), Real(1)}}, 2}; }
  /// The box spanned by the edges from the first point to the others: in 2D the same segment.
  template <class Real>
  FISSURE_HD static Patch<Real> box_patch() { return simplex_patch<Real>(); }

  /// How many ends have the linear function with values `h` at the spanning points >= 0 (`open`: > 0).
  template <class Real>
  FISSURE_HD static int kept(Patch<Real> const& patch, Vec<Real, 2> const& h, bool open) {
    int count = 0;
    for (auto const& point : patch.point) {
      Real const value = h.dot(point);
      count += open ? value > 0 : value >= 0;
    }
    return count;
  }

  /// Keeps the part where the linear function with values `h` at the spanning points is >= 0 (`open`: > 0, so that two
  /// cuts by h and -h share nothing). False when nothing is left.
  template <class Real>
  FISSURE_HD static bool cut(Patch<Real>& patch, Vec<Real, 2> const& h, bool open) {
    Real const a = h.dot(patch.point[0]), b = h.dot(patch.point[1]);
    bool const keep_a = open ? a > 0 : a >= 0, keep_b = open ? b > 0 : b >= 0;
    if (keep_a && keep_b) return true;
    if (!keep_a && !keep_b) return false;
    Vec<Real, 2> const middle = patch.point[0] + (patch.point[1] - patch.point[0]) * (a / (a - b));
    patch.point[keep_a ? 1 : 0] = middle;
    return true;
  }

  /// Adds the integrals of w_k to `share` and of f w_k to `moment`, in units in which the spanning points' simplex has
  /// the measure 1/(D-1)!; raises `deepest` to the largest f.
  template <class Real>
  FISSURE_HD static void integrate(Patch<Real> const& patch, Vec<Real, 2> const& f, Vec<Real, 2>& share,
                                   Vec<Real, 2>& moment, Real& deepest) {
    Vec<Real, 2> const &p = patch.point[0], &q = patch.point[1];
    Real const length = q[1] - p[1], a = f.dot(p), b = f.dot(q);
    share += (p + q) * (length / 2);
    moment += ((p + q) * (a + b) + p * a + q * b) * (length / 6);
    deepest = larger(deepest, larger(a, b));
  }

  /// At right angles to the face opposite to corner i.
  template <class Real>
  FISSURE_HD static Vec<Real, 2> face_normal(Vec<Real, 2> const (&x)[3], int i) {
    Vec<Real, 2> const along = x[(i + 2) % 3] - x[(i + 1) % 3];
    return {along[1], -along[0]};
  }
  /// In the plane faces show every gap: there are no pairs of edges.
  template <class Real>
  FISSURE_HD static Vec<Real, 2> edge_normal(Vec<Real, 2> const (&)[3], Vec<Real, 2> const (&)[3], int) {
    return Vec<Real, 2>::Zero();
  }
  template <class Real>
  FISSURE_HD static Real edge_gap(Vec<Real, 2> const (&)[3], Vec<Real, 2> const (&)[3], int&) {
    return -std::numeric_limits<Real>::infinity();
  }

  /// D - 1 unit vectors at right angles to the unit vector `normal` and to each other.
  template <class Real>
  FISSURE_HD static void tangents(Vec<Real, 2> const& normal, Vec<Real, 2> (&tangent)[1]) {
    tangent[0] << -normal[1], normal[0];
  }
};

}  // namespace fissure
