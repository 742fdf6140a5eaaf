// Cutting a flat piece of boundary in three dimensions: a convex polygon (Sutherland & Hodgman 1974,
// doi 10.1145/360767.360802).
//   integral of f g over a triangle:  A/12 [(f_p + f_q + f_r)(g_p + g_q + g_r) + f_p g_p + f_q g_q + f_r g_r],
//   exact for linear f and g.
#pragma once
#include <limits>

#include "base/dim.h"
#include "base/gap.h"

namespace fissure {

template <>
struct Clip<3> {
  /// A convex polygon: its points, each by the values there of K linear functions, of which the first three are its
  /// weights on the three points that span the plane (they sum to one).
  template <class Real, int K>
  struct Patch {
    static constexpr int most = 12;  // 4 points of a box and one more per cut: 4 by an element, 3 by a part of its fan
    Vec<Real, K> point[most];
    int n = 0;

    FISSURE_HD Patch() {}
    FISSURE_HD void add(Vec<Real, K> const& p) {
      if (n < most) point[n++] = p;
    }
  };

  /// The triangle of the spanning points.
  template <class Real, int K>
  FISSURE_HD static Patch<Real, K> simplex_patch(Vec<Real, K> const (&spanning)[3]) {
    Patch<Real, K> patch;
    for (auto const& p : spanning) patch.add(p);
    return patch;
  }
  /// The box spanned by the edges from the first point to the others.
  template <class Real, int K>
  FISSURE_HD static Patch<Real, K> box_patch(Vec<Real, K> const (&spanning)[3]) {
    Patch<Real, K> patch;
    patch.add(spanning[0]);
    patch.add(spanning[1]);
    patch.add(spanning[1] + (spanning[2] - spanning[0]));
    patch.add(spanning[2]);
    return patch;
  }

  /// Puts into `above` the part where height(point) >= 0, a linear function, and into `below`, if that is asked for,
  /// the rest; unless one of them is nothing.
  template <class Real, int K, class Height>
  FISSURE_HD static Cut cut(Patch<Real, K> const& from, Height const& height, Patch<Real, K>& above,
                            Patch<Real, K>* below = nullptr) {
    Real value[Patch<Real, K>::most];
    int kept = 0;
    for (int i = 0; i < from.n; ++i) {
      value[i] = height(from.point[i]);
      kept += value[i] >= 0;
    }
    if (kept == from.n) return Cut::whole;
    if (kept == 0) return Cut::none;
    above.n = 0;
    if (below) below->n = 0;
    for (int i = 0; i < from.n; ++i) {
      int const next = i + 1 < from.n ? i + 1 : 0;
      Real const a = value[i], b = value[next];
      if (a >= 0)
        above.add(from.point[i]);
      else if (below)
        below->add(from.point[i]);
      if ((a >= 0) == (b >= 0)) continue;
      Vec<Real, K> const middle = from.point[i] + (from.point[next] - from.point[i]) * (a / (a - b));
      above.add(middle);
      if (below) below->add(middle);
    }
    return Cut::part;
  }

  /// Adds the integrals of the K functions g to `share` and of f g to `moment`, in units in which the spanning points'
  /// simplex has the measure 1/(D-1)!; raises `deepest` to the largest f.
  template <class Real, int K, class F>
  FISSURE_HD static void integrate(Patch<Real, K> const& patch, F const& f, Vec<Real, K>& share, Vec<Real, K>& moment,
                                   Real& deepest) {
    Vec<Real, K> const& p = patch.point[0];
    Real const a = f(p);
    deepest = larger(deepest, a);
    Real b = f(patch.point[1]);
    for (int i = 2; i < patch.n; ++i) {
      Vec<Real, K> const &q = patch.point[i - 1], &r = patch.point[i];
      Real const c = f(r);
      Real const area = ((q[1] - p[1]) * (r[2] - p[2]) - (q[2] - p[2]) * (r[1] - p[1])) / 2;
      Vec<Real, K> const sum = p + q + r;
      share += sum * (area / 3);
      moment += (sum * (a + b + c) + p * a + q * b + r * c) * (area / 12);
      deepest = larger(deepest, larger(b, c));
      b = c;
    }
  }

  /// At right angles to the face opposite to corner i, and to an edge of each of two simplices: which, one number of 36
  /// tells.
  template <class Real>
  FISSURE_HD static Vec<Real, 3> face_normal(Vec<Real, 3> const (&x)[4], int i) {
    Vec<Real, 3> const& from = x[(i + 1) % 4];
    return (x[(i + 2) % 4] - from).cross(x[(i + 3) % 4] - from);
  }
  template <class Real>
  FISSURE_HD static Vec<Real, 3> edge(Vec<Real, 3> const (&x)[4], int i) {
    return i < 3 ? x[i + 1] - x[0] : i < 5 ? x[i - 1] - x[1] : x[3] - x[2];
  }
  template <class Real>
  FISSURE_HD static Vec<Real, 3> edge_normal(Vec<Real, 3> const (&a)[4], Vec<Real, 3> const (&b)[4], int pair) {
    return edge(a, pair / 6).cross(edge(b, pair % 6));
  }

  /// Gap between two simplices along directions at right angles to an edge of each, the widest [m], and the pair it
  /// belongs to; negative where none of them separates the simplices (S. Gottschalk, M. C. Lin, D. Manocha, OBBTree,
  /// SIGGRAPH 1996: faces and pairs of edges are enough).
  template <class Real>
  FISSURE_HD static Real edge_gap(Vec<Real, 3> const (&a)[4], Vec<Real, 3> const (&b)[4], int& pair) {
    Real widest = -std::numeric_limits<Real>::infinity(), length[6];
    for (int j = 0; j < 6; ++j) length[j] = edge(b, j).norm();
    for (int i = 0; i < 6; ++i) {
      Vec<Real, 3> const e = edge(a, i);
      Real const least = Real(1e-3) * e.norm();
      for (int j = 0; j < 6; ++j) {
        Vec<Real, 3> const n = e.cross(edge(b, j));
        Real const size = n.norm();
        if (!(size > least * length[j])) continue;  // along each other: a face shows the gap
        Real const gap = gap_along(n, a, b) / size;
        if (gap > widest) widest = gap, pair = 6 * i + j;
      }
    }
    return widest;
  }

  /// D - 1 unit vectors at right angles to the unit vector `normal` and to each other.
  template <class Real>
  FISSURE_HD static void tangents(Vec<Real, 3> const& normal, Vec<Real, 3> (&tangent)[2]) {
    int axis = 0;
    for (int c = 1; c < 3; ++c)
      if (std::abs(normal[c]) < std::abs(normal[axis])) axis = c;
    tangent[0] = normal.cross(Vec<Real, 3>::Unit(axis)).normalized();
    tangent[1] = normal.cross(tangent[0]);
  }
};

}  // namespace fissure
