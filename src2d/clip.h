// Cutting a straight piece of boundary in two dimensions: an interval, one in every lane.
//   integral of f g over a segment:  L/6 [(f_a + f_b)(g_a + g_b) + f_a g_a + f_b g_b],  exact for linear f and g.
#pragma once
#include <limits>

#include "base/dim.h"
#include "base/lanes.h"

namespace fissure {

template <>
struct Clip<2> {
  /// A point of a line that two points span: its weight on the second, and the value there of a linear function f. That
  /// is carried along, for where f is small its digits would be lost in the weight.
  template <class S>
  using Point = Vec<S, 2>;

  /// A part of the line.
  template <class S>
  struct Patch {
    Point<S> from, to;
    S left = S(1);  // 0 where nothing is left of it
  };

  /// The segment between the two spanning points.
  template <class S>
  FISSURE_HD static Patch<S> simplex_patch(S const (&f)[2]) {
    return {{S(0), f[0]}, {S(1), f[1]}};
  }
  /// The box spanned by the edges from the first point to the others: in 2D the same segment.
  template <class S>
  FISSURE_HD static Patch<S> box_patch(S const (&f)[2]) {
    return simplex_patch(f);
  }

  /// Keeps the part where a linear function is not negative, given by its values at the points that span the line.
  template <class S>
  FISSURE_HD static void cut(Patch<S>& patch, S const (&height)[2]) {
    auto const value = [&](S const& at) { return height[0] + (height[1] - height[0]) * at; };
    keep<false>(patch, value(patch.from[0]), value(patch.to[0]));
  }
  /// Keeps the part where f is not negative.
  template <class S>
  FISSURE_HD static void keep_positive(Patch<S>& patch) {
    keep<true>(patch, S(patch.from[1]), S(patch.to[1]));
  }

  /// Integrals over a patch by the weights on the spanning points, per unit of the segment's length.
  template <class S>
  struct Integral {
    S share[2], moment[2];  // of the weights; of the weights times f
    S highest;              // f on the patch
  };
  template <class S>
  FISSURE_HD static Integral<S> integrate(Patch<S> const& patch) {
    S const p = patch.from[0], q = patch.to[0], f_p = patch.from[1], f_q = patch.to[1], sum = f_p + f_q,
            length = patch.left * (q - p);
    S const share = length * (p + q) * as<S>(1.0 / 2);
    S const moment = length * (sum * (p + q) + f_p * p + f_q * q) * as<S>(1.0 / 6);
    return {{length - share, share}, {length * sum * as<S>(1.0 / 2) - moment, moment}, patch.left * larger(f_p, f_q)};
  }

 private:
  /// `a`, `b`: heights of the ends. `by_f`: they are f itself.
  template <bool by_f, class S>
  FISSURE_HD static void keep(Patch<S>& patch, S const& a, S const& b) {
    auto const leaves = !(a < S(0)) && b < S(0), returns = a < S(0) && !(b < S(0));
    S const share = a / (a - b);
    patch.left = select(larger(a, b) < S(0), S(0), patch.left);
    for (int c = 0; c < 2; ++c) {
      S const crossing = by_f && c == 1 ? S(0) : patch.from[c] + (patch.to[c] - patch.from[c]) * share;
      patch.to[c] = select(leaves, crossing, S(patch.to[c]));
      patch.from[c] = select(returns, crossing, S(patch.from[c]));
    }
  }

 public:
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
  template <class S>
  FISSURE_HD static S edge_gap(Vec<S, 2> const (&)[3], Vec<S, 2> const (&)[3], S&) {
    return as<S>(-std::numeric_limits<double>::infinity());
  }

  /// Nor does a face pass what planes do not show.
  template <class S>
  FISSURE_HD static void pass_edges(Mat<S, 3> const&, MaskOf<S> (&)[3]) {}

  /// D - 1 unit vectors at right angles to the unit vector `normal` and to each other.
  template <class Real>
  FISSURE_HD static void tangents(Vec<Real, 2> const& normal, Vec<Real, 2> (&tangent)[1]) {
    tangent[0] << -normal[1], normal[0];
  }
};

}  // namespace fissure
