// The force between two simplices that overlap: Munjiza's potential (Munjiza 2004, ch. 2; paper eqs. 9-10).
//   Two elements that overlap store U = p * integral over the overlap of (phi_A + phi_B), phi = (D+1) min_i lambda_i:
//   1 at the centroid, 0 on the surface, linear in each simplex of the centroid's fan, lambda barycentric coordinates.
//   U itself is a sum over the faces f of the overlap, h_f from the centroid: phi - 1 is linear along every ray from
//   it, so
//     integral of phi = sum over f of h_f/(D+1) (integral over f of phi + area of f/D)
//   f_B = -dU/dx_B = p * integral over (faces of A in B) of phi_B n_A
//                    - p * integral over (faces of B in A) of phi_A n_B
// for any rigid motion, so no closed path makes work. Nodal forces are integrals of phi times the weights of the face
// and of the element it is in: what force at the point of action x_c = M/I and interpolation give, with no division.
// The area vector of the face opposite to corner i is -|det| grad lambda_i / (D-1)!, whatever D.
//   A face is parted by the fan of the element that it is in: over each part one lambda is the least, and positive.
// All of this is written over lanes: a pack has a pair in every lane, and of the parts of their faces, few in each, one
// in every lane.
#pragma once
#include <limits>

#include "base/dim.h"
#include "base/gap.h"
#include "kernels/views.h"

namespace fissure::kernels {

/// A simplex where it stands now, relative to some origin nearby, and the gradients of its barycentric coordinates.
template <int D, class S>
struct Simplex {
  using Real = ScalarOf<S>;
  Vec<S, D> x[D + 1];         // [m]
  Vec<S, D> gradient[D + 1];  // [1/m]
  S det = S(0);               // D! times its volume, > 0
  MaskOf<S> turned{};         // its corners turn the other way than their order

  FISSURE_HD void place(MeshView<D, Real> const& mesh, Index e, Vec<Real, D> const& X0, Vec<Real, D> const& u0) {
    for (int a = 0; a <= D; ++a) x[a] = (mesh.reference(e, a) - X0) + (mesh.displacement(mesh.vertex(e, a)) - u0);
  }

  /// False for an element with no volume to speak of: it touches nothing.
  FISSURE_HD MaskOf<S> differentiate() {
    Mat<S, D> edges;
    S longest = S(0);
    for (int a = 1; a <= D; ++a) {
      edges.col(a - 1) = x[a] - x[0];
      longest = larger(longest, S(edges.col(a - 1).squaredNorm()));
    }
    Mat<S, D> const cofactor = Dim<D>::cofactor(edges);
    S const signed_det = edges.col(0).dot(cofactor.col(0));
    turned = signed_det < S(0);
    det = larger(signed_det, -signed_det);
    S volume = S(16 * std::numeric_limits<Real>::epsilon());
    for (int c = 0; c < D; ++c) volume = volume * root(longest);
    S const inverse = S(1) / signed_det;
    for (int c = 0; c < D; ++c) gradient[0][c] = S(0);
    for (int a = 1; a <= D; ++a) {
      gradient[a] = cofactor.col(a - 1) * inverse;
      gradient[0] -= gradient[a];
    }
    return det > volume;
  }

  /// Barycentric coordinate i of a point.
  FISSURE_HD S lambda(int i, Vec<S, D> const& point) const {
    return S(i == 0 ? 1 : 0) + S(gradient[i].dot(point - x[0]));
  }

  FISSURE_HD Vec<S, D> center() const {
    Vec<S, D> sum = x[0];
    for (int a = 1; a <= D; ++a) sum += x[a];
    return sum * as<S>(1.0 / (D + 1));
  }

  FISSURE_HD void bounds(Vec<S, D>& low, Vec<S, D>& high) const {
    low = high = x[0];
    for (int a = 1; a <= D; ++a)
      for (int c = 0; c < D; ++c) {
        low[c] = smaller(low[c], x[a][c]);
        high[c] = larger(high[c], x[a][c]);
      }
  }
};

/// Axes along which two simplices may be apart, by number: of the coordinates, normals of the faces of the first, of
/// the second, and what is at right angles to an edge of each.
template <int D, class Real>
FISSURE_HD Vec<Real, D> axis_between(Vec<Real, D> const (&a)[D + 1], Vec<Real, D> const (&b)[D + 1], int axis) {
  if (axis < D) return Vec<Real, D>::Unit(axis);
  if (axis < 2 * D + 1) return Clip<D>::face_normal(a, axis - D);
  if (axis < 3 * D + 2) return Clip<D>::face_normal(b, axis - (2 * D + 1));
  return Clip<D>::edge_normal(a, b, axis - (3 * D + 2));
}
inline constexpr std::uint8_t no_axis = 255;

/// Gap between the boxes of two simplices, the widest of all axes [m]; negative where they overlap on every axis.
template <int D, class S>
FISSURE_HD S box_gap(Simplex<D, S> const& a, Simplex<D, S> const& b, S& axis) {
  Vec<S, D> low_a, high_a, low_b, high_b;
  a.bounds(low_a, high_a);
  b.bounds(low_b, high_b);
  S widest = as<S>(-std::numeric_limits<double>::infinity());
  for (int c = 0; c < D; ++c) {
    S const gap = larger(low_a[c] - high_b[c], low_b[c] - high_a[c]);
    axis = select(gap > widest, as<S>(c), axis);
    widest = larger(widest, gap);
  }
  return widest;
}

/// Gap between the corners of `one` and the planes of the faces of `other`, the widest [m]; negative where no plane has
/// all corners on its outer side. `lambda`: barycentric coordinates (columns) of the corners in `other` (rows).
template <int D, class S>
FISSURE_HD S face_gap(Simplex<D, S> const& one, Simplex<D, S> const& other, Mat<S, D + 1>& lambda, S& face) {
  S widest = as<S>(-std::numeric_limits<double>::infinity());
  for (int j = 0; j <= D; ++j) {
    S highest = as<S>(-std::numeric_limits<double>::infinity());
    for (int v = 0; v <= D; ++v) {
      lambda(j, v) = other.lambda(j, one.x[v]);
      highest = larger(highest, lambda(j, v));
    }
    S const gap = -highest / root(S(other.gradient[j].squaredNorm()));
    auto const wider = gap > widest;
    widest = select(wider, gap, widest);
    face = select(wider, as<S>(j), face);
  }
  return widest;
}

/// A distance that two simplices keep at least [m], and the axis along which it is seen: the first gap that boxes,
/// faces or edges show, 0 for one without volume (it touches nothing); negative where they overlap: then the corners'
/// coordinates in each other are set. Of a pair that `touched` a moment ago edges are not asked: what they part, the
/// cuts leave nothing of.
template <int D, class S>
FISSURE_HD S separation(Simplex<D, S>& a, Simplex<D, S>& b, Mat<S, D + 1>& a_in_b, Mat<S, D + 1>& b_in_a,
                        MaskOf<S> touched, S& axis) {
  S const boxes = box_gap(a, b, axis);
  auto meet = boxes < S(0);
  if (!any_lane(meet)) return boxes;
  auto const solid = a.differentiate() && b.differentiate();
  S of_a = S(0), of_b = S(0), pair = S(0);
  S gap = face_gap(b, a, b_in_a, of_a);
  S const theirs = face_gap(a, b, a_in_b, of_b);
  S along = select(theirs > gap, as<S>(2 * D + 1) + of_b, as<S>(D) + of_a);
  gap = larger(gap, theirs);
  meet = meet && solid && gap < S(0) && !touched;
  if (any_lane(meet)) {
    S const edges = Clip<D>::edge_gap(a.x, b.x, pair);
    auto const wider = meet && edges > gap;
    along = select(wider, as<S>(3 * D + 2) + pair, along);
    gap = select(wider, edges, gap);
  }
  gap = select(solid, gap, S(0));
  axis = select(boxes < S(0), along, axis);
  return select(boxes < S(0), gap, boxes);
}

/// What acts on the corners of one element of a contact.
template <int D, class S>
struct CornerSums {
  Vec<S, D> force[D + 1];  // [N]
  S weight[D + 1];         // share in the point of action, times the size of the force [N]
  S stiffness[D + 1];      // d(force)/d(approach) [N/m]

  FISSURE_HD CornerSums() {
    for (int a = 0; a <= D; ++a) {
      for (int c = 0; c < D; ++c) force[a][c] = S(0);
      weight[a] = stiffness[a] = S(0);
    }
  }
  FISSURE_HD void add(int a, Vec<S, D> const& pressure, S size, S share, S slope) {
    force[a] += pressure * share;
    weight[a] += size * share;
    stiffness[a] += size * slope;
  }
  FISSURE_HD Vec<S, D> total() const {
    Vec<S, D> sum = force[0];
    for (int a = 1; a <= D; ++a) sum += force[a];
    return sum;
  }
  /// Weights become shares that sum to one, the interpolation at the mean point of action; or zero where nothing acts.
  FISSURE_HD void normalise() {
    S sum = S(0);
    for (int a = 0; a <= D; ++a) sum += weight[a];
    for (int a = 0; a <= D; ++a) weight[a] = select(sum > S(0), weight[a] / sum, S(0));
  }
  FISSURE_HD S total_stiffness() const {
    S sum = S(0);
    for (int a = 0; a <= D; ++a) sum += stiffness[a];
    return sum;
  }
};

/// Integrals over the part of a patch inside an element, per unit of (D-1)! times the measure that the points span that
/// the patch is given by: of their weights times phi [-], and times |grad phi| [1/m].
template <int D, class S>
struct PotentialIntegral {
  S moment[D], slope[D];
  S deepest = S(0);  // largest phi on it

  FISSURE_HD PotentialIntegral() {
    for (int k = 0; k < D; ++k) moment[k] = slope[k] = S(0);
  }
};

/// The functions that part i of an element's fan keeps positive, lambda_i and lambda_j - lambda_i for all others, at
/// the points that span a patch, whose barycentric coordinates these are (by coordinate and point).
template <int D, class S>
FISSURE_HD void part_heights(S const (&lambda)[D + 1][D], int i, S (&height)[D + 1][D]) {
  for (int k = 0; k < D; ++k) height[0][k] = lambda[i][k];
  for (int j = 0, n = 1; j <= D; ++j)
    if (j != i) {
      for (int k = 0; k < D; ++k) height[n][k] = lambda[j][k] - lambda[i][k];
      ++n;
    }
}

/// Cuts a patch, whose f is the first of these heights, to part of an element's fan and integrates phi = (D+1) f there;
/// `steep`: |grad lambda_i| [1/m].
template <int D, class S>
FISSURE_HD PotentialIntegral<D, S> integrate_part(typename Clip<D>::template Patch<S> patch,
                                                  S const (&height)[D + 1][D], S steep) {
  PotentialIntegral<D, S> result;
  Clip<D>::keep_positive(patch);
  for (int j = 1; j <= D; ++j) {
    if (!any_lane(patch.left > S(0))) return result;
    Clip<D>::cut(patch, height[j]);
  }
  auto const part = Clip<D>::integrate(patch);
  for (int k = 0; k < D; ++k) {
    result.moment[k] = as<S>(D + 1) * part.moment[k];
    result.slope[k] = as<S>(D + 1) * steep * part.share[k];
  }
  result.deepest = as<S>(D + 1) * positive(part.highest);
  return result;
}

/// What is nearer to a plane than this share of an edge lies in it: coordinates are rounded where an edge is a
/// hundredth of a body.
template <class Real>
inline constexpr Real in_plane = 128 * std::numeric_limits<Real>::epsilon();

/// Two simplices of this gap, one of them `a`, have no volume in common. Cells that share a corner have no gap but for
/// rounding; in single precision such a margin would be as deep as a stiff contact, which must not begin with a jump.
template <int D, class S>
FISSURE_HD MaskOf<S> clear(S gap, Simplex<D, S> const& a, double margin = in_plane<double>) {
  return gap > as<S>(-margin) * root(S((a.x[1] - a.x[0]).squaredNorm()));
}

/// Area of the part of a patch where all of these linear functions are above `least`, per unit of (D-1)! times the
/// measure that its points span. Faces that lie in each other must count once in an energy: so of two bodies the faces
/// of one are cut a little outside of the other, the other's a little inside.
template <int D, class S, int planes>
FISSURE_HD S area_above(typename Clip<D>::template Patch<S> patch, S const (&height)[planes][D], S least) {
  for (int j = 0; j < planes; ++j) {
    S above[D];
    for (int k = 0; k < D; ++k) above[k] = height[j][k] - least;
    Clip<D>::cut(patch, above);
    if (!any_lane(patch.left > S(0))) return S(0);
  }
  auto const part = Clip<D>::integrate(patch);
  S area = part.share[0];
  for (int k = 1; k < D; ++k) area += part.share[k];
  return area;
}

/// Forces of the potential on the corners of two elements, a pair in every lane, and the energy that it stores [J].
/// Where a potential `begins` later, at phi = o, it is phi - o above that: it is zero on a simplex (1 - o) times as
/// large about the same centroid, and all of the above holds of that one.
template <int D, class S>
class Overlap {
  using Real = ScalarOf<S>;
  static constexpr int W = lane_width<S>, C = D + 1, sides = 2;

 public:
  CornerSums<D, S> on_a, on_b;
  S deepest = S(0), held = S(0);  // largest potential on a face inside the other, 0..1; energy, if it is asked for [J]

  /// `a_in_b`: barycentric coordinates of a's corners in b. Only lanes whose pair is not clear() overlap, and only
  /// those that overlap by more than rounding have an energy, which is reckoned if it is asked for.
  FISSURE_HD Overlap(Simplex<D, S> const& a, Simplex<D, S> const& b, Mat<S, C> const& a_in_b, Mat<S, C> const& b_in_a,
                     S p, S begins, S gap, bool energy) {
    auto const meet = !clear<D, S>(gap, a);
    if (!any_lane(meet)) return;
    least_ = begins * as<S>(1.0 / C);
    store(least_, least_lambda_);
    gather(0, a_in_b, b_in_a, b, meet);
    gather(1, b_in_a, a_in_b, a, meet);
    if (waiting_ > 0) integrate();
    press(0, a, a_in_b, p, on_a, on_b);
    press(1, b, b_in_a, p, on_b, on_a);
    deepest = load<S>(deepest_);
    if (energy)
      held = select(!clear<D, S>(gap, a, in_plane<Real>),
                    stored(0, a, b, a_in_b, p, begins) + stored(1, b, a, b_in_a, p, begins), S(0));
  }

 private:
  /// Corner k of the face opposite to corner i.
  FISSURE_HD static int corner(int i, int k) { return k < i ? k : k + 1; }

  /// Which faces of one element reach into the other, where its potential begins: not those that lie outside of one of
  /// its planes, whose own plane has all of it on one side, or that pass one of its edges.
  FISSURE_HD void reach(Mat<S, C> const& lambda, Mat<S, C> const& other_in_one, MaskOf<S> meet,
                        MaskOf<S> (&reaches)[C]) const {
    S const rest = S(1) - as<S>(C) * least_;
    Mat<S, C> height;
    for (int j = 0; j < C; ++j)
      for (int v = 0; v < C; ++v) height(j, v) = lambda(j, v) - least_;
    for (int i = 0; i < C; ++i) {
      S low = other_in_one(i, 0), high = low, sum = low;
      for (int v = 1; v < C; ++v) {
        S const at = other_in_one(i, v);
        low = smaller(low, at), high = larger(high, at), sum += at;
      }
      S const mean = sum * as<S>(1.0 / C);
      reaches[i] = meet && mean + (low - mean) * rest < S(0) && mean + (high - mean) * rest > S(0);
      for (int j = 0; j < C; ++j) {
        S highest = height(j, corner(i, 0));
        for (int k = 1; k < D; ++k) highest = larger(highest, S(height(j, corner(i, k))));
        reaches[i] = reaches[i] && !(highest < S(0));
      }
    }
    Clip<D>::pass_edges(height, reaches);
  }

  /// Parts of the faces of one element (side 0: a) that may lie inside the other wait until they fill a pack. Where two
  /// lambdas are alike all over a face the part belongs to the first.
  FISSURE_HD void gather(int side, Mat<S, C> const& lambda, Mat<S, C> const& other_in_one, Simplex<D, S> const& other,
                         MaskOf<S> meet) {
    for (int j = 0; j < C; ++j) {
      store(root(S(other.gradient[j].squaredNorm())), steep_[side][j]);
      for (int v = 0; v < C; ++v) store(S(lambda(j, v)), lambda_[side][j][v]);
    }
    MaskOf<S> reaches[C];
    reach(lambda, other_in_one, meet, reaches);
    alignas(sizeof(S)) Real inside[W];
    for (int i = 0; i < C; ++i)
      for (int part = 0; part < C && any_lane(reaches[i]); ++part) {
        auto here = reaches[i];
        for (int j = 0; j < C; ++j) {
          S highest = as<S>(-1);
          for (int k = 0; k < D; ++k) {
            S const above =
                j == part ? S(lambda(j, corner(i, k))) : S(lambda(j, corner(i, k)) - lambda(part, corner(i, k)));
            highest = k == 0 ? above : larger(highest, above);
          }
          here = here && (j == part ? highest > least_ : j > part ? !(highest < S(0)) : highest > S(0));
        }
        if (!any_lane(here)) continue;
        store(select(here, S(1), S(0)), inside);
        for (int l = 0; l < W; ++l)
          if (inside[l] > 0) wait(side, i, part, l);
      }
  }
  FISSURE_HD void wait(int side, int face, int part, int l) {
    for (int k = 0; k < D; ++k) {
      int const v = corner(face, k);
      Real const least = lambda_[side][part][v][l];
      height_[0][k][waiting_] = least - least_lambda_[l];
      for (int j = 0, n = 1; j < C; ++j)
        if (j != part) height_[n++][k][waiting_] = lambda_[side][j][v][l] - least;
    }
    gradient_[waiting_] = steep_[side][part][l];
    owner_[waiting_] = {side, face, l};
    if (++waiting_ == W) integrate();
  }

  /// Cuts a face to the parts that wait and integrates phi = (D+1) lambda over them.
  FISSURE_HD void integrate() {
    S height[C][D];
    for (int j = 0; j < C; ++j)
      for (int k = 0; k < D; ++k) height[j][k] = load<S>(height_[j][k]);
    auto const part = integrate_part<D, S>(Clip<D>::simplex_patch(height[0]), height, load<S>(gradient_));
    alignas(sizeof(S)) Real moment[D][W], slope[D][W], deepest[W];
    for (int k = 0; k < D; ++k) store(part.moment[k], moment[k]), store(part.slope[k], slope[k]);
    store(part.deepest, deepest);
    for (int q = 0; q < waiting_; ++q) {
      auto const& [side, face, l] = owner_[q];
      for (int k = 0; k < D; ++k) {
        moment_[side][face][k][l] += moment[k][q];
        slope_[side][face][k][l] += slope[k][q];
      }
      deepest_[l] = larger(deepest_[l], deepest[q]);
    }
    waiting_ = 0;
  }

  /// The faces of one push the other along their outward normals, and one against them.
  FISSURE_HD void press(int side, Simplex<D, S> const& one, Mat<S, C> const& lambda, S p, CornerSums<D, S>& on_one,
                        CornerSums<D, S>& on_other) const {
    for (int i = 0; i < C; ++i) {
      S moment[D], slope[D], whole = S(0);
      for (int k = 0; k < D; ++k) {
        moment[k] = load<S>(moment_[side][i][k]);
        slope[k] = load<S>(slope_[side][i][k]);
        whole += moment[k];
      }
      auto const acts = whole > S(0);
      if (!any_lane(acts)) continue;
      Vec<S, D> const pressure = one.gradient[i] * select(acts, -p * one.det, S(0));
      S const size = root(S(pressure.squaredNorm()));
      for (int k = 0; k < D; ++k) on_one.add(corner(i, k), -pressure, size, moment[k], slope[k]);
      for (int j = 0; j < C; ++j) {
        S share = S(0), rate = S(0);
        for (int k = 0; k < D; ++k) {
          share += lambda(j, corner(i, k)) * moment[k];
          rate += lambda(j, corner(i, k)) * slope[k];
        }
        on_other.add(j, pressure, size, share, rate);
      }
    }
  }

  /// The faces' part of the energy [J].
  FISSURE_HD S stored(int side, Simplex<D, S> const& one, Simplex<D, S> const& other, Mat<S, C> const& lambda, S p,
                      S begins) const {
    S const rest = S(1) - begins, plane = S(side == 0 ? -in_plane<Real> : in_plane<Real>), share = as<S>(1.0 / D);
    S shrunk = rest;
    for (int c = 0; c < D; ++c) shrunk = shrunk * rest;
    S sum = S(0);
    for (int i = 0; i < C; ++i) {
      S height[C][D], own[C][D], moment = S(0);  // `own`: of the face where one's own potential begins
      for (int j = 0; j < C; ++j) {
        S mean = S(0);
        for (int v = 0; v < C; ++v) mean += lambda(j, v) * as<S>(1.0 / C);
        for (int k = 0; k < D; ++k) {
          height[j][k] = lambda(j, corner(i, k)) - least_;
          own[j][k] = mean + (lambda(j, corner(i, k)) - mean) * rest;
        }
      }
      for (int k = 0; k < D; ++k) moment += load<S>(moment_[side][i][k]);
      auto const patch = Clip<D>::simplex_patch(height[0]);
      S const area = area_above<D, S, C>(patch, height, plane), own_area = area_above<D, S, C>(patch, own, plane);
      // Height above the other's centroid, times size [N m].
      S const height_p = -p * one.det * S(one.gradient[i].dot(one.x[i == 0 ? 1 : 0] - other.center()));
      sum += (height_p * (moment + rest * area * share) + p * one.det * as<S>(1.0 / C) * shrunk * own_area * share) *
             as<S>(1.0 / C);
    }
    return sum;
  }

  struct Owner {
    int side, face, lane;
  };
  S least_ = S(0);  // lambda where the potential begins
  int waiting_ = 0;
  Owner owner_[W] = {};
  alignas(sizeof(S)) Real height_[C][D][W] = {};  // as part_heights gives them
  alignas(sizeof(S)) Real gradient_[W] = {};      // |grad lambda| of the part [1/m]
  alignas(sizeof(S)) Real lambda_[sides][C][C][W];
  alignas(sizeof(S)) Real steep_[sides][C][W];
  alignas(sizeof(S)) Real moment_[sides][C][D][W] = {}, slope_[sides][C][D][W] = {};  // of faces, as PotentialIntegral
  alignas(sizeof(S)) Real deepest_[W] = {}, least_lambda_[W];
};

}  // namespace fissure::kernels
