// Contact of simplices with rigid bodies: boxes (plates) and half-spaces (walls), by the potential of overlap.h.
#pragma once
#include "kernels/contact.h"

namespace fissure::kernels {

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
  Real lambda[D + 1][D], size = p;  // at the points that span the patch
  for (int k = 0; k < D - 1; ++k) size *= edges[k].norm();
  for (int j = 0; j <= D; ++j) {
    lambda[j][0] = element.lambda(j, corner);
    for (int k = 0; k < D - 1; ++k) lambda[j][k + 1] = lambda[j][0] + element.gradient[j].dot(edges[k]);
  }
  PotentialIntegral<D, Real> sum;
  for (int i = 0; i <= D; ++i) {
    Real height[D + 1][D];
    part_heights<D, Real>(lambda, i, height);
    auto const part = integrate_part<D, Real>(Clip<D>::box_patch(height[0]), height, element.gradient[i].norm());
    for (int k = 0; k < D; ++k) sum.moment[k] += part.moment[k], sum.slope[k] += part.slope[k];
    sum.deepest = larger(sum.deepest, part.deepest);
  }
  Real total = 0;
  for (int k = 0; k < D; ++k) total += sum.moment[k];
  for (int j = 0; j <= D; ++j) {
    Real share = 0, rate = 0;
    for (int k = 0; k < D; ++k) share += lambda[j][k] * sum.moment[k], rate += lambda[j][k] * sum.slope[k];
    on.add(j, normal * size, size, share, rate);
  }
  if (held)
    *held += size * normal.dot(corner - element.center()) / (D + 1) *
             (total + area_above<D, Real, D + 1>(Clip<D>::box_patch(lambda[0]), lambda, -in_plane<Real>) / D);
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
    Real height[planes][D];
    for (int k = 0; k < planes; ++k)
      for (int a = 0; a < D; ++a) height[k][a] = depth[k][a < i ? a : a + 1];
    held += p * element.det * area_above<D, Real, planes>(Clip<D>::simplex_patch(height[0]), height, margin) /
            ((D + 1) * (D + 1) * D);
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

}  // namespace fissure::kernels
