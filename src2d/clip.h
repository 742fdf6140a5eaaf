// Cutting a straight piece of boundary in two dimensions: an interval.
//   integral of f g over a segment:  L/6 [(f_a + f_b)(g_a + g_b) + f_a g_a + f_b g_b],  exact for linear f and g.
#pragma once
#include <limits>

#include "base/dim.h"
#include "base/lanes.h"

namespace fissure {

template <>
struct Clip<2> {
  /// A convex part of a line: both ends, each by the values there of K linear functions, of which the first two are its
  /// weights on the two points that span the line (they sum to one).
  template <class Real, int K>
  struct Patch {
    Vec<Real, K> point[2];
    static constexpr int n = 2;
  };

  /// The segment between the two spanning points.
  template <class Real, int K>
  FISSURE_HD static Patch<Real, K> simplex_patch(Vec<Real, K> const (&spanning)[2]) {
    return {{spanning[0], spanning[1]}};
  }
  /// The box spanned by the edges from the first point to the others: in 2D the same segment.
  template <class Real, int K>
  FISSURE_HD static Patch<Real, K> box_patch(Vec<Real, K> const (&spanning)[2]) {
    return simplex_patch<Real, K>(spanning);
  }

  /// Puts into `above` the part where height(end) >= 0, a linear function, and into `below`, if that is asked for, the
  /// rest; unless one of them is nothing.
  template <class Real, int K, class Height>
  FISSURE_HD static Cut cut(Patch<Real, K> const& from, Height const& height, Patch<Real, K>& above,
                            Patch<Real, K>* below = nullptr) {
    Vec<Real, K> const &p = from.point[0], &q = from.point[1];
    Real const a = height(p), b = height(q);
    bool const keep_a = a >= 0, keep_b = b >= 0;
    if (keep_a == keep_b) return keep_a ? Cut::whole : Cut::none;
    Vec<Real, K> const middle = p + (q - p) * (a / (a - b));
    above.point[0] = keep_a ? p : middle;
    above.point[1] = keep_a ? middle : q;
    if (below) {
      below->point[0] = keep_a ? middle : p;
      below->point[1] = keep_a ? q : middle;
    }
    return Cut::part;
  }

  /// Adds the integrals of the K functions g to `share` and of f g to `moment`, in units in which the spanning points'
  /// simplex has the measure 1/(D-1)!; raises `deepest` to the largest f.
  template <class Real, int K, class F>
  FISSURE_HD static void integrate(Patch<Real, K> const& patch, F const& f, Vec<Real, K>& share, Vec<Real, K>& moment,
                                   Real& deepest) {
    Vec<Real, K> const &p = patch.point[0], &q = patch.point[1];
    Real const length = q[1] - p[1], a = f(p), b = f(q);
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
