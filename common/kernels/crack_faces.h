// The two faces of a broken joint: they press with the joint's own stiffness and rub with Coulomb friction, so that a joint
// that breaks under pressure hands over the force it carried, and none of it twice.
//   opening o < 0: sigma = k o;  tau = k (s - s0) held within mu |sigma| by moving s0 (spring and slider).
#pragma once
#include "backend/for_each.h"
#include "kernels/views.h"

namespace fissure::kernels {

/// One broken joint: corner i of its face is corner i + (i >= face) of the element and i + (i >= other_face) of the other.
template <int D, class Real>
struct CrackFace {
  Index element = 0, face = 0, other = 0, other_face = 0;
  Real stiffness = 0;    // [Pa/m]
  Real weight = 0;       // area per corner [m^2]
  Real friction = 0;     // [-]
  Real size = 0;         // h of the joint [m]
  Real start[D][D] = {}; // s0 of each corner: slip at which its friction spring is relaxed [m]
  int apart = 0;         // 1: the faces have moved so far that general contact must take over
};

template <int D, class Real_>
struct CrackForces {
  static constexpr char const* name = "crack faces";
  static constexpr bool packed = false;
  using Real = Real_;
  /// Faces that have opened or slid by this share of the joint's size no longer face each other.
  static constexpr double reach = 0.3;

  MeshView<D, Real> mesh;
  CrackFace<D, Real>* faces = nullptr;
  Real* force = nullptr;      // [face][2][D][D]: on the element's corners, then on the other's [N]
  Real* stiffness = nullptr;  // [face][2][D]: bound of the corner's row of the stiffness matrix [N/m]
  Real* work = nullptr;       // [face] what friction took in this step [J]
  int* news = nullptr;        // set to 1 when faces have come apart

  template <class S>
  FISSURE_HD void operator()(Index f) const {
    CrackFace<D, Real>& crack = faces[f];
    Vec<Real, D> gap[D], middle[D];
    for (int i = 0; i < D; ++i) {
      int const a = i + (i >= crack.face), b = i + (i >= crack.other_face);
      Vec<Real, D> const mine = mesh.displacement(mesh.vertex(crack.element, a));
      Vec<Real, D> const theirs = mesh.displacement(mesh.vertex(crack.other, b));
      gap[i] = theirs - mine;
      middle[i] = mesh.reference(crack.element, a) + Real(0.5) * (mine + theirs);
    }
    Vec<Real, D> normal = Dim<D>::face_normal(middle);
    normal *= Real((crack.face % 2 == 0) == (mesh.parity[crack.element] > 0) ? 1 : -1) / normal.norm();

    Real least_opening = crack.size, most_slip = 0, taken = 0;
    for (int i = 0; i < D; ++i) {
      Real const opening = gap[i].dot(normal);
      Vec<Real, D> const slip = gap[i] - opening * normal;
      Vec<Real, D> start, traction = Vec<Real, D>::Zero();
      for (int c = 0; c < D; ++c) start[c] = crack.start[i][c];
      if (opening < 0) {
        Vec<Real, D> stretch = slip - start;
        stretch -= normal * normal.dot(stretch);
        Real const pressure = -crack.stiffness * opening, length = stretch.norm();
        Real const most = crack.friction * pressure / crack.stiffness;
        if (length > most) {
          taken += crack.weight * crack.stiffness * most * (length - most);
          stretch *= most / length;
        }
        start = slip - stretch;
        traction = crack.stiffness * stretch - pressure * normal;
      } else {
        start = slip;
      }
      least_opening = smaller(least_opening, opening);
      most_slip = larger(most_slip, slip.norm());
      Real const stiff = opening < 0 ? 2 * crack.stiffness * crack.weight : Real(0);
      std::size_t const mine = (static_cast<std::size_t>(f) * 2 + 0) * D + i, theirs = (static_cast<std::size_t>(f) * 2 + 1) * D + i;
      for (int c = 0; c < D; ++c) {
        crack.start[i][c] = start[c];
        force[mine * D + c] = crack.weight * traction[c];
        force[theirs * D + c] = -(crack.weight * traction[c]);
      }
      stiffness[mine] = stiffness[theirs] = stiff;
    }
    work[f] = taken;
    if (least_opening > Real(reach) * crack.size || most_slip > Real(reach) * crack.size) {
      crack.apart = 1;
      raise(news);
    }
  }
};

}  // namespace fissure::kernels
