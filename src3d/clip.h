// Cutting a flat piece of boundary in three dimensions: a convex polygon, cut as Sutherland & Hodgman do
// (1974, doi 10.1145/360767.360802), but kept as directed edges in any order, which is all that integrals ask for. So
// many polygons are cut side by side, one in every lane, without a branch.
//   integral of f g over a triangle:  A/12 [(f_p + f_q + f_r)(g_p + g_q + g_r) + f_p g_p + f_q g_q + f_r g_r],
//   exact for linear f and g.
#pragma once
#include <limits>

#include "base/dim.h"
#include "base/gap.h"

namespace fissure {

template <>
struct Clip<3> {
  /// A point of a plane that three points span: its weights on the second and the third, and the value there of a
  /// linear function f. That is carried along, for where f is small its digits would be lost in the weights.
  template <class S>
  using Point = Vec<S, 3>;

  /// A convex polygon.
  template <class S>
  struct Patch {
    // the 4 edges of a rectangle and one more per cut, by the 6 planes of a box at most
    static constexpr int most = 10;
    Point<S> from[most], to[most];  // edges, anticlockwise; one that was cut away has its ends in the same place
    int n = 0;
    S left = S(1);  // 0 where nothing is left of it

    FISSURE_HD Patch() {}
    FISSURE_HD void edge(Point<S> const& one, Point<S> const& other) {
      from[n] = one;
      to[n++] = other;
    }
  };

  /// A linear function at a point, given by its values at the points that span the plane.
  template <class S>
  FISSURE_HD static S value(S const (&f)[3], Point<S> const& point) {
    return f[0] + (f[1] - f[0]) * point[0] + (f[2] - f[0]) * point[1];
  }
  template <class S>
  FISSURE_HD static Point<S> point(double second, double third, S const& f) {
    return {as<S>(second), as<S>(third), f};
  }
  /// The triangle of the spanning points.
  template <class S>
  FISSURE_HD static Patch<S> simplex_patch(S const (&f)[3]) {
    Point<S> const a = point(0, 0, f[0]), b = point(1, 0, f[1]), c = point(0, 1, f[2]);
    Patch<S> patch;
    patch.edge(a, b), patch.edge(b, c), patch.edge(c, a);
    return patch;
  }
  /// The box spanned by the edges from the first point to the others.
  template <class S>
  FISSURE_HD static Patch<S> box_patch(S const (&f)[3]) {
    Point<S> const a = point(0, 0, f[0]), b = point(1, 0, f[1]), c = point(1, 1, f[1] + (f[2] - f[0])),
                   d = point(0, 1, f[2]);
    Patch<S> patch;
    patch.edge(a, b), patch.edge(b, c), patch.edge(c, d), patch.edge(d, a);
    return patch;
  }

  /// Keeps the part where a linear function is not negative.
  template <class S>
  FISSURE_HD static void cut(Patch<S>& patch, S const (&height)[3]) {
    S size = S(0);
    for (S const& h : height) size += larger(h, -h);
    keep<false>(
        patch, [&](Point<S> const& at) { return value(height, at); }, size);
  }
  /// Keeps the part where f is not negative.
  template <class S>
  FISSURE_HD static void keep_positive(Patch<S>& patch) {
    S size = S(0);
    for (int e = 0; e < patch.n; ++e) size = larger(size, larger(patch.from[e][2], -patch.from[e][2]));
    keep<true>(
        patch, [](Point<S> const& at) { return at[2]; }, size);
  }

  /// Integrals over a patch by the weights on the spanning points, per unit of twice their triangle's area.
  template <class S>
  struct Integral {
    S share[3], moment[3];  // of the weights; of the weights times f
    S highest;              // f on the patch
  };
  template <class S>
  FISSURE_HD static Integral<S> integrate(Patch<S> const& patch) {
    Point<S> const& o = patch.from[0];
    S area = S(0), moment = S(0), highest = larger(o[2], patch.to[0][2]), share[2] = {area, area},
      moments[2] = {area, area};
    for (int e = 1; e < patch.n; ++e) {
      Point<S> const &p = patch.from[e], &q = patch.to[e];
      S const a = ((p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0])) * as<S>(1.0 / 2);
      S const f = o[2] + p[2] + q[2];
      area += a;
      moment += a * f;
      for (int c = 0; c < 2; ++c) {
        S const points = o[c] + p[c] + q[c];
        share[c] += a * points;
        moments[c] += a * (f * points + o[2] * o[c] + p[2] * p[c] + q[2] * q[c]);
      }
      highest = larger(highest, larger(p[2], q[2]));
    }
    Integral<S> result;
    for (int c = 0; c < 2; ++c) {
      result.share[c + 1] = patch.left * share[c] * as<S>(1.0 / 3);
      result.moment[c + 1] = patch.left * moments[c] * as<S>(1.0 / 12);
    }
    result.share[0] = patch.left * area - result.share[1] - result.share[2];
    result.moment[0] = patch.left * moment * as<S>(1.0 / 3) - result.moment[1] - result.moment[2];
    result.highest = patch.left * highest;
    return result;
  }

 private:
  /// The cut runs from where the boundary leaves the side that is kept to where it comes back: the same points end the
  /// edges there, so that the boundary stays closed. What is below by no more than the rounding of numbers of this
  /// `size` lies in the plane, so that the boundary leaves but once. `by_f`: the height is f itself.
  template <bool by_f, class S, class Height>
  FISSURE_HD static void keep(Patch<S>& patch, Height const& height, S const& size) {
    S const margin = size * S(-4 * std::numeric_limits<ScalarOf<S>>::epsilon());
    auto const seen = [&](Point<S> const& at) {
      S const h = height(at);
      return select(h < margin, h, positive(h));
    };
    S at_from[Patch<S>::most], at_to[Patch<S>::most], lowest = S(0), highest = S(-1);
    for (int e = 0; e < patch.n; ++e) {
      at_from[e] = seen(patch.from[e]);
      at_to[e] = seen(patch.to[e]);
      lowest = smaller(lowest, smaller(at_from[e], at_to[e]));
      highest = larger(highest, at_from[e]);
    }
    if (!any_lane(lowest < S(0))) return;
    patch.left = select(highest < S(0), S(0), patch.left);
    // Of all edges of a lane one leaves and one returns: a division for each of these.
    S leaves_at = S(0), leaves_by = S(1), returns_at = S(0), returns_by = S(1);
    for (int e = 0; e < patch.n; ++e) {
      auto const kept = !(at_from[e] < S(0)), keeps = !(at_to[e] < S(0));
      auto const leaving = kept && !keeps, returning = keeps && !kept;
      S const falls = at_from[e] - at_to[e];
      leaves_at = select(leaving, at_from[e], leaves_at), leaves_by = select(leaving, falls, leaves_by);
      returns_at = select(returning, at_from[e], returns_at), returns_by = select(returning, falls, returns_by);
    }
    S const leaves_share = leaves_at / leaves_by, returns_share = returns_at / returns_by;
    Point<S> leaves = patch.from[0], returns = patch.from[0];
    for (int e = 0; e < patch.n; ++e) {
      auto const kept = !(at_from[e] < S(0)), keeps = !(at_to[e] < S(0));
      auto const leaving = kept && !keeps, returning = keeps && !kept;
      S const share = select(leaving, leaves_share, returns_share);
      for (int c = 0; c < 3; ++c) {
        S const crossing = by_f && c == 2 ? S(0) : patch.from[e][c] + (patch.to[e][c] - patch.from[e][c]) * share;
        patch.to[e][c] = select(leaving, crossing, patch.to[e][c]);
        patch.from[e][c] = select(returning, crossing, patch.from[e][c]);
        leaves[c] = select(leaving, crossing, leaves[c]);
        returns[c] = select(returning, crossing, returns[c]);
      }
    }
    for (int e = 0; e < patch.n; ++e) {
      auto const gone = at_from[e] < S(0) && at_to[e] < S(0);
      for (int c = 0; c < 3; ++c) {
        patch.from[e][c] = select(gone, leaves[c], patch.from[e][c]);
        patch.to[e][c] = select(gone, leaves[c], patch.to[e][c]);
      }
    }
    patch.edge(leaves, returns);
  }

 public:
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
  template <class S>
  FISSURE_HD static S edge_gap(Vec<S, 3> const (&a)[4], Vec<S, 3> const (&b)[4], S& pair) {
    S widest = as<S>(-std::numeric_limits<double>::infinity()), length[6];
    for (int j = 0; j < 6; ++j) length[j] = root(S(edge(b, j).squaredNorm()));
    for (int i = 0; i < 6; ++i) {
      Vec<S, 3> const e = edge(a, i);
      S const least = as<S>(1e-3) * root(S(e.squaredNorm()));
      for (int j = 0; j < 6; ++j) {
        Vec<S, 3> const n = e.cross(edge(b, j));
        S const size = root(S(n.squaredNorm()));
        S const gap = gap_along(n, a, b) / size;
        // those along each other leave it to a face to show the gap
        auto const wider = size > least * length[j] && gap > widest;
        widest = select(wider, gap, widest);
        pair = select(wider, as<S>(6 * i + j), pair);
      }
    }
    return widest;
  }

  /// Of the faces of one simplex (opposite to corner i) those that pass an edge of another on its outer side do not
  /// reach it. `height`: of the corners (columns) above the planes of the other (rows), each in a unit of its own. A
  /// plane h_k + s h_l = 0 with s > 0 meets the other in no more than the edge between its faces k and l: where h_l is
  /// negative a corner is on its outer side from some s on, otherwise up to one.
  template <class S>
  FISSURE_HD static void pass_edges(Mat<S, 4> const& height, MaskOf<S> (&reaches)[4]) {
    using Real = ScalarOf<S>;
    S const never = S(std::numeric_limits<Real>::infinity()), least = S(std::numeric_limits<Real>::min());
    for (int l = 1; l < 4; ++l) {
      S inverse[4];
      for (int v = 0; v < 4; ++v) {
        S const h = height(l, v);
        inverse[v] = S(-1) / select(h < S(0), h, larger(h, least));  // of what lies in the plane the sign counts
      }
      for (int k = 0; k < l; ++k) {
        S from[4], to[4];
        for (int v = 0; v < 4; ++v) {
          S const s = height(k, v) * inverse[v];
          auto const behind = height(l, v) < S(0);
          from[v] = select(behind, s, S(0)), to[v] = select(behind, never, s);
        }
        for (int i = 0; i < 4; ++i) {
          S const first = larger(larger(from[(i + 1) % 4], from[(i + 2) % 4]), from[(i + 3) % 4]),
                  last = smaller(smaller(to[(i + 1) % 4], to[(i + 2) % 4]), to[(i + 3) % 4]);
          reaches[i] = reaches[i] && !(first < last);
        }
      }
    }
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
