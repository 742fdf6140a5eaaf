// Contact of simplices by Munjiza's potential (Munjiza 2004, ch. 2; paper eqs. 9-10) and Coulomb friction on a spring
// (friction.h).
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
#pragma once
#include <limits>

#include "base/dim.h"
#include "base/gap.h"
#include "kernels/friction.h"
#include "kernels/views.h"
#include "laws/contact.h"

namespace fissure::kernels {

/// Which law holds between which elements.
struct ContactTable {
  using Number = std::uint16_t;               // of a material: a byte would end at 256
  Number const* law = nullptr;                // of an element
  laws::ContactLaw const* between = nullptr;  // [n_laws][n_laws] for pairs; [body][n_laws] for rigid bodies
  Index n_laws = 1;

  FISSURE_HD laws::ContactLaw const& of(Index first, Index second) const { return between[first * n_laws + second]; }
};

/// Penalty of a pair, times how far it reaches out of the plane [Pa m, 3D: Pa]. In axisymmetry that is fixed at rest,
/// so that the forces still follow from a potential, and the smaller of both, so that no contact is stiffer for its
/// element than in the plane.
template <int D, class Real>
FISSURE_HD Real pair_penalty(MeshView<D, Real> const& mesh, laws::ContactLaw const& law, Index a, Index b) {
  return Real(law.penalty) * smaller(mesh.out_of_plane(a), mesh.out_of_plane(b));
}

/// A simplex where it stands now, relative to some origin nearby, and the gradients of its barycentric coordinates.
template <int D, class Real>
struct Simplex {
  Vec<Real, D> x[D + 1];         // [m]
  Vec<Real, D> gradient[D + 1];  // [1/m]
  Real det = 0;                  // D! times its volume, > 0
  bool turned = false;           // its corners turn the other way than their order

  FISSURE_HD void place(MeshView<D, Real> const& mesh, Index e, Vec<Real, D> const& X0, Vec<Real, D> const& u0) {
    for (int a = 0; a <= D; ++a) x[a] = (mesh.reference(e, a) - X0) + (mesh.displacement(mesh.vertex(e, a)) - u0);
  }

  /// False for an element with no volume to speak of: it touches nothing.
  FISSURE_HD bool differentiate() {
    Mat<Real, D> edges;
    Real longest = 0;
    for (int a = 1; a <= D; ++a) {
      edges.col(a - 1) = x[a] - x[0];
      longest = larger(longest, edges.col(a - 1).squaredNorm());
    }
    det = edges.determinant();
    turned = det < 0;
    det = std::abs(det);
    Real volume = 16 * std::numeric_limits<Real>::epsilon();
    for (int c = 0; c < D; ++c) volume *= root(longest);
    if (!(det > volume)) return false;
    Mat<Real, D> const inverse = edges.inverse();
    gradient[0].setZero();
    for (int a = 1; a <= D; ++a) {
      gradient[a] = inverse.row(a - 1).transpose();
      gradient[0] -= gradient[a];
    }
    return true;
  }

  /// Barycentric coordinate i of a point.
  FISSURE_HD Real lambda(int i, Vec<Real, D> const& point) const {
    return (i == 0 ? Real(1) : Real(0)) + gradient[i].dot(point - x[0]);
  }

  FISSURE_HD Vec<Real, D> center() const {
    Vec<Real, D> sum = x[0];
    for (int a = 1; a <= D; ++a) sum += x[a];
    return sum / Real(D + 1);
  }

  FISSURE_HD void bounds(Vec<Real, D>& low, Vec<Real, D>& high) const {
    low = high = x[0];
    for (int a = 1; a <= D; ++a) {
      low = low.cwiseMin(x[a]);
      high = high.cwiseMax(x[a]);
    }
  }
};

/// Axes along which two simplices may be apart, by number: of the coordinates, normals of the faces of the first, of
/// the second, and what is at right angles to an edge of each.
template <int D, class Real>
FISSURE_HD Vec<Real, D> axis_between(Simplex<D, Real> const& a, Simplex<D, Real> const& b, int axis) {
  if (axis < D) return Vec<Real, D>::Unit(axis);
  if (axis < 2 * D + 1) return Clip<D>::face_normal(a.x, axis - D);
  if (axis < 3 * D + 2) return Clip<D>::face_normal(b.x, axis - (2 * D + 1));
  return Clip<D>::edge_normal(a.x, b.x, axis - (3 * D + 2));
}
inline constexpr std::uint8_t no_axis = 255;

/// Gap between the boxes of two simplices, the widest of all axes [m]; negative where they overlap on every axis.
template <int D, class Real>
FISSURE_HD Real box_gap(Simplex<D, Real> const& a, Simplex<D, Real> const& b, int& axis) {
  Vec<Real, D> low_a, high_a, low_b, high_b;
  a.bounds(low_a, high_a);
  b.bounds(low_b, high_b);
  return (low_a - high_b).cwiseMax(low_b - high_a).maxCoeff(&axis);
}

/// Gap between the corners of `one` and the planes of the faces of `other`, the widest [m]; negative where no plane has
/// all corners on its outer side. `lambda`: barycentric coordinates (columns) of the corners in `other` (rows).
template <int D, class Real>
FISSURE_HD Real face_gap(Simplex<D, Real> const& one, Simplex<D, Real> const& other, Mat<Real, D + 1>& lambda,
                         int& face) {
  Real widest = -std::numeric_limits<Real>::infinity();
  for (int j = 0; j <= D; ++j) {
    for (int v = 0; v <= D; ++v) lambda(j, v) = other.lambda(j, one.x[v]);
    Real const gap = -lambda.row(j).maxCoeff() / other.gradient[j].norm();
    if (gap > widest) widest = gap, face = j;
  }
  return widest;
}

/// A distance that two simplices keep at least [m], and the axis along which it is seen: the first gap that boxes,
/// faces or edges show, 0 for one without volume (it touches nothing); negative where they overlap: then the corners'
/// coordinates in each other are set. Of a pair that `touched` a moment ago edges are not asked: what they part, the
/// cuts leave nothing of.
template <int D, class Real>
FISSURE_HD Real separation(Simplex<D, Real>& a, Simplex<D, Real>& b, Mat<Real, D + 1>& a_in_b, Mat<Real, D + 1>& b_in_a,
                           bool touched, int& axis) {
  Real gap = box_gap(a, b, axis);
  if (!(gap < 0)) return gap;
  if (!a.differentiate() || !b.differentiate()) return 0;
  int of_a = 0, of_b = 0, pair = 0;
  gap = face_gap(b, a, b_in_a, of_a);
  Real const theirs = face_gap(a, b, a_in_b, of_b);
  axis = theirs > gap ? 2 * D + 1 + of_b : D + of_a;
  gap = larger(gap, theirs);
  if (!(gap < 0) || touched) return gap;
  Real const edges = Clip<D>::edge_gap(a.x, b.x, pair);
  if (edges > gap) axis = 3 * D + 2 + pair;
  return larger(gap, edges);
}

/// What acts on the corners of one element of a contact.
template <int D, class Real>
struct CornerSums {
  Vec<Real, D> force[D + 1];  // [N]
  Real weight[D + 1];         // share in the point of action, times the size of the force [N]
  Real stiffness[D + 1];      // d(force)/d(approach) [N/m]

  FISSURE_HD CornerSums() {
    for (int a = 0; a <= D; ++a) {
      force[a].setZero();
      weight[a] = stiffness[a] = 0;
    }
  }
  FISSURE_HD void add(int a, Vec<Real, D> const& pressure, Real size, Real share, Real slope) {
    force[a] += pressure * share;
    weight[a] += size * share;
    stiffness[a] += size * slope;
  }
  FISSURE_HD Vec<Real, D> total() const {
    Vec<Real, D> sum = force[0];
    for (int a = 1; a <= D; ++a) sum += force[a];
    return sum;
  }
  /// Weights become shares that sum to one, the interpolation at the mean point of action; or zero where nothing acts.
  FISSURE_HD void normalise() {
    Real sum = 0;
    for (int a = 0; a <= D; ++a) sum += weight[a];
    for (int a = 0; a <= D; ++a) weight[a] = sum > 0 ? weight[a] / sum : Real(0);
  }
  FISSURE_HD Real total_stiffness() const {
    Real sum = 0;
    for (int a = 0; a <= D; ++a) sum += stiffness[a];
    return sum;
  }
};

/// What the points of a patch carry: weights on the D points that span it, barycentric coordinates in the element that
/// it is cut to, and none or one that is zero, so that packs are full.
template <int D>
inline constexpr int patch_values = (2 * D + 2) / 2 * 2;

/// Integrals over the part of a patch inside an element, per unit of the patch's measure, of what its points carry.
template <int D, class Real>
struct PotentialIntegral {
  Vec<Real, patch_values<D>> moment = Vec<Real, patch_values<D>>::Zero();  // times phi [-]
  Vec<Real, patch_values<D>> slope = Vec<Real, patch_values<D>>::Zero();   // times |grad phi| [1/m]
  Real deepest = 0;                                                        // largest phi on it
};

template <class T>
FISSURE_HD void swap_places(T*& a, T*& b) {
  T* const was = a;
  a = b, b = was;
}

/// Integrates over a patch on which barycentric coordinate i of the element is the least of the first j; where another
/// is less, that one goes on. So the patch is parted by the simplices of the element's fan, where phi = (D+1) lambda_i.
template <int j, int D, class Real>
FISSURE_CALL void integrate_fan(typename Clip<D>::template Patch<Real, patch_values<D>> const& patch, int i,
                                Simplex<D, Real> const& element, PotentialIntegral<D, Real>& sum) {
  constexpr int K = patch_values<D>;
  using Point = Vec<Real, K>;
  if constexpr (j > D) {
    Point share = Point::Zero();
    auto const potential = [i](Point const& p) { return p[D + i] * Real(D + 1); };
    Clip<D>::integrate(patch, potential, share, sum.moment, sum.deepest);
    sum.slope += share * (Real(D + 1) * element.gradient[i].norm());
  } else {
    typename Clip<D>::template Patch<Real, K> mine, theirs;
    Cut const how = Clip<D>::cut(
        patch, [i](Point const& p) { return p[D + j] - p[D + i]; }, mine, &theirs);
    if (how == Cut::whole) return integrate_fan<j + 1, D, Real>(patch, i, element, sum);
    if (how == Cut::none) return integrate_fan<j + 1, D, Real>(patch, j, element, sum);
    integrate_fan<j + 1, D, Real>(mine, i, element, sum);
    integrate_fan<j + 1, D, Real>(theirs, j, element, sum);
  }
}

/// Cuts the patch to the element, then along its fan.
template <int D, class Real>
FISSURE_HD PotentialIntegral<D, Real> integrate_potential(typename Clip<D>::template Patch<Real, patch_values<D>> start,
                                                          Simplex<D, Real> const& element) {
  constexpr int K = patch_values<D>;
  typename Clip<D>::template Patch<Real, K> buffer, *patch = &start, *spare = &buffer;
  PotentialIntegral<D, Real> sum;
  for (int j = 0; j <= D; ++j) {
    Cut const left = Clip<D>::cut(
        *patch, [j](Vec<Real, K> const& p) { return p[D + j]; }, *spare);
    if (left == Cut::none) return sum;
    if (left == Cut::part) swap_places(patch, spare);
  }
  integrate_fan<1, D, Real>(*patch, 0, element, sum);
  return sum;
}

/// What is nearer to a plane than this share of an edge lies in it: coordinates are rounded where an edge is a
/// hundredth of a body.
template <class Real>
inline constexpr Real in_plane = 128 * std::numeric_limits<Real>::epsilon();

/// Area of the part of a patch where all linear functions that its points carry from number `from` on, `planes` of
/// them, are above `least`; in units in which the spanning points' simplex has the measure 1/(D-1)!. Faces that lie in
/// each other must count once in an energy: so of two bodies the faces of one are cut a little outside of the other,
/// the other's a little inside.
template <int D, class Real, int K>
FISSURE_HD Real area_above(typename Clip<D>::template Patch<Real, K> start, int from, int planes, Real least) {
  typename Clip<D>::template Patch<Real, K> buffer, *patch = &start, *spare = &buffer;
  for (int j = from; j < from + planes; ++j) {
    Cut const left = Clip<D>::cut(
        *patch, [&](Vec<Real, K> const& p) { return p[j] - least; }, *spare);
    if (left == Cut::none) return 0;
    if (left == Cut::part) swap_places(patch, spare);
  }
  Vec<Real, K> share = Vec<Real, K>::Zero(), moment = share;
  Real deepest = 0;
  auto const nothing = [](Vec<Real, K> const&) { return Real(0); };
  Clip<D>::integrate(*patch, nothing, share, moment, deepest);
  return share.template head<D>().sum();
}

/// The points that span a patch: their weights are those of the unit vectors, and their coordinates in the element are
/// set by the caller.
template <int D, class Real, int K>
FISSURE_HD void spanning_points(Vec<Real, K> (&points)[D]) {
  for (int k = 0; k < D; ++k) points[k] = Vec<Real, K>::Unit(k);
}

/// What a contact remembers: the stretch of its friction spring (D numbers, [m]), the stiffness that carried it [N/m],
/// and the share of its penalty that it holds back until it has parted once (of pairs that were crack faces,
/// crack_faces.h).
template <int D>
inline constexpr int spring_size = D + 2;

/// Two simplices of this gap, one of them `a`, have a volume in common; or `apart`, have none, not by rounding alone.
template <int D, class Real>
FISSURE_HD bool overlap(Real gap, Simplex<D, Real> const& a) {
  return gap < -in_plane<Real> * (a.x[1] - a.x[0]).norm();
}
template <int D, class Real>
FISSURE_HD bool apart(Real gap, Simplex<D, Real> const& a) {
  return gap > in_plane<Real> * (a.x[1] - a.x[0]).norm();
}

/// Forces of the potential from the faces of `one` inside `other`: other is pushed along their outward normals, one
/// against them. `corner`: barycentric coordinates of one's corners in other. Adds the faces' part of the energy to
/// `held` [J], if that is asked for; `cut`: which side of the other's planes its area ends on (area_above).
template <int D, class Real>
FISSURE_HD void faces_inside(Simplex<D, Real> const& one, Simplex<D, Real> const& other, Mat<Real, D + 1> const& corner,
                             Real p, CornerSums<D, Real>& on_one, CornerSums<D, Real>& on_other, Real* held, Real cut,
                             Real& deepest) {
  constexpr int K = patch_values<D>;
  for (int i = 0; i <= D; ++i) {
    Vec<Real, K> points[D];
    spanning_points<D, Real, K>(points);
    for (int k = 0; k < D; ++k) points[k].template segment<D + 1>(D) = corner.col(k < i ? k : k + 1);
    bool outside = false;
    for (int j = 0; j <= D; ++j) {
      Real highest = points[0][D + j];
      for (int k = 1; k < D; ++k) highest = larger(highest, points[k][D + j]);
      outside = outside || highest < 0;
    }
    if (outside && !held) continue;
    auto const patch = Clip<D>::template simplex_patch<Real, K>(points);
    auto const sum = integrate_potential<D, Real>(patch, other);
    if (!held && !(sum.deepest > 0)) continue;
    Vec<Real, D> const pressure = one.gradient[i] * (-p * one.det);
    Real const size = pressure.norm();
    for (int k = 0; k < D; ++k) on_one.add(k < i ? k : k + 1, -pressure, size, sum.moment[k], sum.slope[k]);
    for (int j = 0; j <= D; ++j) on_other.add(j, pressure, size, sum.moment[D + j], sum.slope[D + j]);
    if (held) {
      Real const area = area_above<D, Real, K>(patch, D, D + 1, cut);
      // Heights, times size [N m].
      Real const height = pressure.dot(one.x[i == 0 ? 1 : 0] - other.center()), own_height = p * one.det / (D + 1);
      *held += (height * (sum.moment.template head<D>().sum() + area / D) + own_height * area / D) / (D + 1);
    }
    deepest = larger(deepest, sum.deepest);
  }
}

/// One candidate pair of elements: forces on the corners of both, without friction, zero when they do not overlap.
/// After the list is rebuilt `force`, `stiffness`, `work` and `penetration` must be zero: a pair that does not touch
/// and did not touch before is left alone.
template <int D, class Real_>
struct PairForces {
  static constexpr char const* name = "contact pairs";
  static constexpr bool packed = false, costly = true;
  using Real = Real_;

  MeshView<D, Real> mesh;
  ContactTable table;
  Index const* pair = nullptr;  // [pair][2]
  Real* spring = nullptr;       // [pair][spring_size<D>], carried over rebuilds
  Real* force = nullptr;        // [pair][2][D+1][D] [N]
  Real* stiffness = nullptr;    // [pair][2][D+1]: bound of the corner's row of the stiffness matrix [N/m]
  Real* weight = nullptr;       // [pair][2][D+1]: share of the corner in the point of action, where there is friction
  Real const* work = nullptr;   // [pair]: friction's, in the last step [J]
  Real* penetration = nullptr;  // [pair]: largest potential on a face inside the other, 0..1; > 0 where they touch
  // A pair with a gap sleeps until things have moved as far relative to each other (conservative advancement: B.
  // Mirtich, Impulse-based Dynamic Simulation of Rigid Body Systems, PhD thesis, Berkeley 1996).
  double path = 0;               // longest way of anything relative to anything since the list was built [m]
  double* wake = nullptr;        // [pair]: path at which it must be looked at again [m]
  std::uint8_t* axis = nullptr;  // [pair]: along which a gap was last seen, looked along first; or `no_axis`
  Real* held = nullptr;          // [pair]: by the overlap, where it is asked for [J]
  // set to 1 when an element that touches is inside out, as a part of a block may be; null: nobody asks
  int* fault = nullptr;

  template <class S = Real>
  FISSURE_HD void operator()(Index i) const {
    if (path < wake[i]) return;
    Simplex<D, Real> a, b;
    Index const ea = pair[2 * i], eb = pair[2 * i + 1];
    Vec<Real, D> const X0 = mesh.reference(ea, 0), u0 = mesh.displacement(mesh.vertex(ea, 0));
    a.place(mesh, ea, X0, u0);
    b.place(mesh, eb, X0, u0);

    Real* const memory = spring + static_cast<std::size_t>(i) * spring_size<D>;
    bool const touched = penetration[i] > 0;
    // nothing is left of a contact: without one, nothing is to be done
    bool const left = !touched && work[i] == 0 && !(memory[D] > 0);
    if (left && axis[i] != no_axis) {
      Vec<Real, D> const along = axis_between(a, b, axis[i]);
      Real const gap = gap_along(along, a.x, b.x) / along.norm();
      if (apart(gap, a)) {
        memory[D + 1] = 0;
        return sleep(i, gap);
      }
    }

    CornerSums<D, Real> on_a, on_b;
    Real deepest = 0, stored = 0;
    Mat<Real, D + 1> a_in_b, b_in_a;
    laws::ContactLaw const& law = table.of(table.law[ea], table.law[eb]);
    int along = 0;
    Real const gap = separation(a, b, a_in_b, b_in_a, touched, along);
    axis[i] = gap > 0 ? static_cast<std::uint8_t>(along) : no_axis;
    if (gap < 0) {
      if (fault && (a.turned != (mesh.parity[ea] < 0) || b.turned != (mesh.parity[eb] < 0))) raise(fault);
      Real const p = pair_penalty(mesh, law, ea, eb) * (1 - memory[D + 1]);
      Real* const energy = held && overlap(gap, a) ? &stored : nullptr;
      faces_inside(a, b, a_in_b, p, on_a, on_b, energy, -in_plane<Real>, deepest);
      faces_inside(b, a, b_in_a, p, on_b, on_a, energy, in_plane<Real>, deepest);
    }
    if (!(deepest > 0)) memory[D + 1] = 0;
    // Parting, friction books once more: new slots know no penetration, but the spring does.
    if (left && !(deepest > 0)) {
      if (gap > 0) sleep(i, gap);
      return;
    }

    if (law.rubs()) {
      on_a.normalise();
      on_b.normalise();
    }
    penetration[i] = deepest;
    if (held) held[i] = stored;
    write(on_a, 2 * static_cast<std::size_t>(i), law.rubs());
    write(on_b, 2 * static_cast<std::size_t>(i) + 1, law.rubs());
  }

 private:
  FISSURE_HD void sleep(Index i, Real gap) const { wake[i] = path + 0.99 * static_cast<double>(gap); }
  FISSURE_HD void write(CornerSums<D, Real> const& sums, std::size_t side, bool rubs) const {
    for (int a = 0; a <= D; ++a) {
      std::size_t const slot = side * (D + 1) + a;
      if (rubs) weight[slot] = sums.weight[a];
      stiffness[slot] = 2 * sums.stiffness[a];  // the row meets the corners of both sides
      for (int c = 0; c < D; ++c) force[slot * D + c] = sums.force[a][c];
    }
  }
};

/// Friction of the pairs, in the plane of the contact between two pieces. One pair's own force leans to the side: it
/// has faces that lie inside a body, whose pressures cancel among neighbours. So the normal is that of the pressures
/// that the two pieces exert on each other around the nodes of the pair, weighted like its point of action, and the
/// pair's share of them is its force along it.
template <int D, class Real_>
struct PairFriction {
  static constexpr char const* name = "contact friction";
  static constexpr bool packed = false;
  using Real = Real_;

  MeshView<D, Real> mesh;
  ContactTable table;
  Real dt = 0;                  // since the springs were last stretched [s]
  Index const* pair = nullptr;  // these as PairForces has them
  Real* spring = nullptr;
  Real* force = nullptr;  // friction is added
  Real const* stiffness = nullptr;
  Real const* weight = nullptr;
  Real* work = nullptr;
  Real const* penetration = nullptr;
  Index const* group = nullptr;    // [pair][2][D+1]: where the corner's node and the other piece have their sum
  Real const* pressure = nullptr;  // [group][D]: of the forces of pairs, without friction [N]

  template <class S = Real>
  FISSURE_HD void operator()(Index i) const {
    Real* const memory = spring + static_cast<std::size_t>(i) * spring_size<D>;
    if (!(penetration[i] > 0) && !(memory[D] > 0) && work[i] == 0) return;
    Index const ea = pair[2 * i], eb = pair[2 * i + 1];
    laws::ContactLaw const& law = table.of(table.law[ea], table.law[eb]);
    if (!(law.rubs())) return;
    std::size_t const a = static_cast<std::size_t>(i) * 2 * (D + 1), b = a + D + 1;
    Vec<Real, D> slip = Vec<Real, D>::Zero(), normal = slip, own = slip;
    Real k = 0;
    for (int c = 0; c <= D; ++c) {
      slip += mesh.velocity(mesh.vertex(eb, c)) * weight[b + c] - mesh.velocity(mesh.vertex(ea, c)) * weight[a + c];
      for (int d = 0; d < D; ++d) {
        normal[d] += pressure[group[b + c] * D + d] * weight[b + c] - pressure[group[a + c] * D + d] * weight[a + c];
        own[d] += force[(b + c) * D + d];
      }
      k += stiffness[a + c] / 2;
    }
    Real const size = normal.norm();
    if (size > 0) normal /= size;
    Real lost = 0;
    Real const pressing = positive(own.dot(normal));
    auto const drag = friction<D, Real>(normal, pressing, slip, dt, k, law.most(pressing), memory, lost);
    work[i] = lost;
    for (int c = 0; c <= D; ++c)
      for (int d = 0; d < D; ++d) {
        force[(a + c) * D + d] -= drag[d] * weight[a + c];
        force[(b + c) * D + d] += drag[d] * weight[b + c];
      }
  }
};

/// A rigid box that moves without turning.
template <int D, class Real>
struct RigidBox {
  static constexpr char const* contact_name = "contact plates";
  Vec<Real, D> low, high;     // where it stood at the start [m]
  Vec<Real, D> displacement;  // since then [m]
  Vec<Real, D> velocity;      // [m/s]
};

/// A rigid half-space: everything must stay on the side its unit normal points to.
template <int D, class Real>
struct HalfSpace {
  static constexpr char const* contact_name = "contact walls";
  Vec<Real, D> point, normal;
  Vec<Real, D> displacement = Vec<Real, D>::Zero();
  Vec<Real, D> velocity = Vec<Real, D>::Zero();
};

/// Pressure of a flat rigid patch on an element: the patch from `corner` along the D - 1 `edges`, pushing along
/// `normal`. Adds its part of the energy to `held` [J], if that is asked for.
template <int D, class Real>
FISSURE_HD void press(Simplex<D, Real> const& element, Vec<Real, D> const& corner, Vec<Real, D> const (&edges)[D - 1],
                      Vec<Real, D> const& normal, Real p, CornerSums<D, Real>& on, Real* held, Real& deepest) {
  constexpr int K = patch_values<D>;
  Vec<Real, K> points[D];
  spanning_points<D, Real, K>(points);
  Real size = p;
  for (int k = 0; k < D - 1; ++k) size *= edges[k].norm();
  for (int j = 0; j <= D; ++j) {
    points[0][D + j] = element.lambda(j, corner);
    for (int k = 0; k < D - 1; ++k) points[k + 1][D + j] = points[0][D + j] + element.gradient[j].dot(edges[k]);
  }
  auto const patch = Clip<D>::template box_patch<Real, K>(points);
  auto const sum = integrate_potential<D, Real>(patch, element);
  for (int j = 0; j <= D; ++j) on.add(j, normal * size, size, sum.moment[D + j], sum.slope[D + j]);
  if (held)
    *held += size * normal.dot(corner - element.center()) / (D + 1) *
             (sum.moment.template head<D>().sum() + area_above<D, Real, K>(patch, D, D + 1, -in_plane<Real>) / D);
  deepest = larger(deepest, sum.deepest);
}

/// Completes the energy [J] of an element in a rigid body by its own faces, where the potential is zero; `depth[k]` of
/// each corner behind each of the planes that bound the body [m].
template <int D, class Real, int planes>
FISSURE_HD void add_own_faces(Simplex<D, Real> const& element, Real const (&depth)[planes][D + 1], Real p, Real& held) {
  Real const margin = in_plane<Real> * (element.x[1] - element.x[0]).norm();
  for (int k = 0; k < planes; ++k) {
    Real most = depth[k][0];
    for (int a = 1; a <= D; ++a) most = larger(most, depth[k][a]);
    if (!(most > margin)) return void(held = 0);  // it lies on the other side
  }
  for (int i = 0; i <= D; ++i) {
    constexpr int K = D + planes;
    Vec<Real, K> points[D];
    spanning_points<D, Real, K>(points);
    for (int k = 0; k < planes; ++k)
      for (int a = 0; a < D; ++a) points[a][D + k] = depth[k][a < i ? a : a + 1];
    auto const patch = Clip<D>::template simplex_patch<Real, K>(points);
    held += p * element.det * area_above<D, Real, K>(patch, D, planes, margin) / ((D + 1) * (D + 1) * D);
  }
}

/// Faces of the box, each cut to the bounds of the element before it is cut to the element itself.
template <int D, class Real>
FISSURE_HD void press(Simplex<D, Real>& element, RigidBox<D, Real> const& box, Vec<Real, D> const& X0,
                      Vec<Real, D> const& u0, Real p, CornerSums<D, Real>& on, Real* held, Real& deepest) {
  Vec<Real, D> const box_low = (box.low - X0) + (box.displacement - u0),
                     box_high = (box.high - X0) + (box.displacement - u0);
  Vec<Real, D> low, high;
  element.bounds(low, high);
  low = low.cwiseMax(box_low);
  high = high.cwiseMin(box_high);
  for (int c = 0; c < D; ++c)
    if (!(low[c] < high[c])) return;
  if (!element.differentiate()) return;
  for (int c = 0; c < D; ++c)
    for (int side = 0; side < 2; ++side) {
      Real const at = side ? box_high[c] : box_low[c];
      if (at < low[c] || at > high[c]) continue;
      Vec<Real, D> corner = low, edges[D - 1], normal = Vec<Real, D>::Zero();
      corner[c] = at;
      normal[c] = side ? Real(1) : Real(-1);
      for (int k = 0; k < D - 1; ++k) {
        int const axis = k < c ? k : k + 1;
        edges[k].setZero();
        edges[k][axis] = high[axis] - low[axis];
      }
      press<D, Real>(element, corner, edges, normal, p, on, held, deepest);
    }
  if (held) {
    Real depth[2 * D][D + 1];
    for (int c = 0; c < D; ++c)
      for (int a = 0; a <= D; ++a)
        depth[2 * c][a] = element.x[a][c] - box_low[c], depth[2 * c + 1][a] = box_high[c] - element.x[a][c];
    add_own_faces<D, Real>(element, depth, p, *held);
  }
  Vec<Real, D> const center = element.center();
  if ((center.array() > box_low.array()).all() && (center.array() < box_high.array()).all()) deepest = 1;
}

/// The half-space's plane, as a square around the element.
template <int D, class Real>
FISSURE_HD void press(Simplex<D, Real>& element, HalfSpace<D, Real> const& wall, Vec<Real, D> const& X0,
                      Vec<Real, D> const& u0, Real p, CornerSums<D, Real>& on, Real* held, Real& deepest) {
  Vec<Real, D> const point = (wall.point - X0) + (wall.displacement - u0), center = element.center();
  Real depth[1][D + 1], most = 0, reach = 0;
  for (int a = 0; a <= D; ++a) {
    depth[0][a] = wall.normal.dot(point - element.x[a]);
    most = larger(most, depth[0][a]);
  }
  if (!(most > 0) || !element.differentiate()) return;
  for (int a = 0; a <= D; ++a) reach = larger(reach, (element.x[a] - center).norm());
  Real const height = wall.normal.dot(center - point);
  Vec<Real, D> corner = center - wall.normal * height, edges[D - 1];
  Clip<D>::tangents(wall.normal, edges);
  for (int k = 0; k < D - 1; ++k) {
    corner -= edges[k] * reach;
    edges[k] *= 2 * reach;
  }
  press<D, Real>(element, corner, edges, wall.normal, p, on, held, deepest);
  if (held) add_own_faces<D, Real>(element, depth, p, *held);
  if (height < 0) deepest = 1;
}

/// One candidate of an element and a rigid body. After the list is rebuilt `force`, `reaction`, `stiffness`, `work` and
/// `penetration` must be zero: a candidate that does not touch and did not touch before is left alone.
template <int D, class Real_, class Body>
struct RigidForces {
  static constexpr char const* name = Body::contact_name;
  static constexpr bool packed = false, costly = true;
  using Real = Real_;

  MeshView<D, Real> mesh;
  ContactTable table;  // between[body][law of the element]
  Body const* body = nullptr;
  Real dt = 0;                       // since the springs were last stretched [s]
  Index const* candidate = nullptr;  // [candidate][2]: element, body
  Real* spring = nullptr;            // [candidate][spring_size<D>], carried over rebuilds
  Real* force = nullptr;             // [candidate][D+1][D] on the element's corners [N]
  Real* reaction = nullptr;          // [candidate][D] on the body [N]
  Real* stiffness = nullptr;         // [candidate][D+1]: bound of the corner's row of the stiffness matrix [N/m]
  Real* work = nullptr;              // [candidate]: friction's, this step [J]
  // [candidate]: largest potential on the body's surface; 1 when the centroid is inside
  Real* penetration = nullptr;
  Real* held = nullptr;  // [candidate]: by the overlap, where it is asked for [J]
  int* fault = nullptr;  // set to 1 when an element that touches is inside out; null: nobody asks

  template <class S = Real>
  FISSURE_HD void operator()(Index i) const {
    Index const e = candidate[2 * i];
    Body const& rigid = body[candidate[2 * i + 1]];
    laws::ContactLaw const& law = table.of(candidate[2 * i + 1], table.law[e]);
    Vec<Real, D> const X0 = mesh.reference(e, 0), u0 = mesh.displacement(mesh.vertex(e, 0));
    Simplex<D, Real> element;
    element.place(mesh, e, X0, u0);
    CornerSums<D, Real> on;
    Real deepest = 0, stored = 0, friction_work = 0;
    press(element, rigid, X0, u0, Real(law.penalty) * mesh.out_of_plane(e), on, held ? &stored : nullptr, deepest);
    std::size_t const first = static_cast<std::size_t>(i);
    Real* const memory = spring + first * spring_size<D>;
    // parting, friction books once more
    if (!(deepest > 0) && !(penetration[i] > 0) && work[i] == 0 && !(memory[D] > 0)) return;
    if (fault && deepest > 0 && element.turned != (mesh.parity[e] < 0)) raise(fault);

    if (law.rubs()) {
      Real const k = on.total_stiffness();
      on.normalise();
      Vec<Real, D> slip = -rigid.velocity;
      for (int a = 0; a <= D; ++a)
        slip += mesh.velocity(mesh.vertex(e, a)) * (deepest > 0 ? on.weight[a] : Real(1) / (D + 1));
      Vec<Real, D> normal = on.total();
      Real const size = normal.norm();
      if (size > 0) normal /= size;
      Vec<Real, D> const drag = friction<D, Real>(normal, size, slip, dt, k, law.most(size), memory, friction_work);
      for (int a = 0; a <= D; ++a) on.force[a] += drag * on.weight[a];
    }
    Vec<Real, D> const total = on.total();
    penetration[i] = deepest;
    if (held) held[i] = stored;
    work[i] = friction_work;
    for (int c = 0; c < D; ++c) reaction[first * D + c] = -total[c];
    for (int a = 0; a <= D; ++a) {
      stiffness[first * (D + 1) + a] = on.stiffness[a];
      for (int c = 0; c < D; ++c) force[(first * (D + 1) + a) * D + c] = on.force[a][c];
    }
  }
};

template <int D, class Real>
using PlateForces = RigidForces<D, Real, RigidBox<D, Real>>;
template <int D, class Real>
using WallForces = RigidForces<D, Real, HalfSpace<D, Real>>;

/// Bounds of an element where it stands now, grown by `margin` on every side.
template <int D, class Real>
FISSURE_HD void element_bounds(MeshView<D, Real> const& mesh, Index e, Real margin, Vec<Real, D>& low,
                               Vec<Real, D>& high) {
  low = high = mesh.position(e, 0);
  for (int a = 1; a <= D; ++a) {
    Vec<Real, D> const x = mesh.position(e, a);
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  low.array() -= margin;
  high.array() += margin;
}

}  // namespace fissure::kernels
