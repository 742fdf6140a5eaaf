// Cutting a flat piece of boundary in three dimensions: a convex polygon in the weights of the three points that span
// its plane (Sutherland & Hodgman 1974, doi 10.1145/360767.360802).
//   integral of f w_k over a triangle:  A/12 [(f_p + f_q + f_r)(w_p + w_q + w_r) + f_p w_p + f_q w_q + f_r w_r],
//   exact for linear f and w.
#pragma once
#include <limits>

#include "base/gap.h"

namespace fissure {

template <int D>
struct Clip;

template <>
struct Clip<3> {
  /// A convex polygon; each point by its weights on the three points that span the plane (they sum to one).
  template <class Real>
  struct Patch {
    static constexpr int most = 12;  // 4 points of a box and one more per cut: 4 by an element, 3 by a part of its fan
    Vec<Real, 3> point[most];
    int n = 0;

    FISSURE_HD Patch() {}
    FISSURE_HD Patch(Patch const& other) : n(other.n) {
      for (int i = 0; i < n; ++i) point[i] = other.point[i];
    }
    FISSURE_HD Patch& operator=(Patch const& other) {
      n = other.n;
      for (int i = 0; i < n; ++i) point[i] = other.point[i];
      return *this;
    }
    FISSURE_HD void add(Vec<Real, 3> const& p) {
      if (n < most) point[n++] = p;
    }
  };

  /// The triangle of the spanning points.
  template <class Real>
  FISSURE_HD static Patch<Real> simplex_patch() {
    Patch<Real> patch;
    for (int k = 0; k < 3; ++k) patch.add(Vec<Real, 3>::Unit(k));
    return patch;
  }
  /// The box spanned by the edges from the first point to the others.
  template <class Real>
  FISSURE_HD static Patch<Real> box_patch() {
    Patch<Real> patch;
    patch.add({Real(1), Real(0), Real(0)});
    patch.add({Real(0), Real(1), Real(0)});
    patch.add({Real(-1), Real(1), Real(1)});
    patch.add({Real(0), Real(0), Real(1)});
    return patch;
  }

  /// How many points have the linear function with values `h` at the spanning points >= 0 (`open`: > 0).
  template <class Real>
  FISSURE_HD static int kept(Patch<Real> const& patch, Vec<Real, 3> const& h, bool open) {
    int count = 0;
    for (int i = 0; i < patch.n; ++i) {
      Real const value = h.dot(patch.point[i]);
      count += open ? value > 0 : value >= 0;
    }
    return count;
  }

  /// Keeps the part where the linear function with values `h` at the spanning points is >= 0 (`open`: > 0, so that two
  /// cuts by h and -h share nothing). False when nothing is left.
  template <class Real>
  FISSURE_HD static bool cut(Patch<Real>& patch, Vec<Real, 3> const& h, bool open) {
    Real value[Patch<Real>::most];
    int kept = 0;
    for (int i = 0; i < patch.n; ++i) {
      value[i] = h.dot(patch.point[i]);
      kept += open ? value[i] > 0 : value[i] >= 0;
    }
    if (kept == patch.n) return true;
    if (kept == 0) return false;
    Patch<Real> left;
    for (int i = 0; i < patch.n; ++i) {
      int const next = i + 1 < patch.n ? i + 1 : 0;
      Real const a = value[i], b = value[next];
      bool const keep_a = open ? a > 0 : a >= 0, keep_b = open ? b > 0 : b >= 0;
      if (keep_a) left.add(patch.point[i]);
      if (keep_a != keep_b) left.add(patch.point[i] + (patch.point[next] - patch.point[i]) * (a / (a - b)));
    }
    patch = left;
    return patch.n > 2;
  }

  /// Adds the integrals of w_k to `share` and of f w_k to `moment`, in units in which the spanning points' simplex has
  /// the measure 1/(D-1)!; raises `deepest` to the largest f.
  template <class Real>
  FISSURE_HD static void integrate(Patch<Real> const& patch, Vec<Real, 3> const& f, Vec<Real, 3>& share,
                                   Vec<Real, 3>& moment, Real& deepest) {
    Vec<Real, 3> const& p = patch.point[0];
    Real const a = f.dot(p);
    deepest = larger(deepest, a);
    Real b = f.dot(patch.point[1]);
    for (int i = 2; i < patch.n; ++i) {
      Vec<Real, 3> const &q = patch.point[i - 1], &r = patch.point[i];
      Real const c = f.dot(r);
      Real const area = ((q[1] - p[1]) * (r[2] - p[2]) - (q[2] - p[2]) * (r[1] - p[1])) / 2;
      Vec<Real, 3> const sum = p + q + r;
      share += sum * (area / 3);
      moment += (sum * (a + b + c) + p * a + q * b + r * c) * (area / 12);
      deepest = larger(deepest, larger(b, c));
      b = c;
    }
  }

  /// At right angles to the face opposite to corner i, and to an edge of each of two simplices: which, one number of 36 tells.
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

  /// Gap between two simplices along directions at right angles to an edge of each, the widest [m], and the pair it belongs to;
  /// negative where none of them separates the simplices (S. Gottschalk, M. C. Lin, D. Manocha, OBBTree, SIGGRAPH 1996: faces and
  /// pairs of edges are enough).
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
