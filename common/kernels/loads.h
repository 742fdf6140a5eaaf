// Forces and prescribed motions on few vertices, each with the work it does.
// Work over a step is the trapezoid of the forces at its ends times the displacement between: half is booked with the
// velocity before the step, half with the one after it, which balances the leapfrog's kinetic energy exactly.
#pragma once
#include "backend/for_each.h"
#include "kernels/views.h"

namespace fissure::kernels {

/// A vertex that a load or a prescribed motion acts on.
template <int D, class Real>
struct LoadedVertex {
  Index vertex = 0;
  // what a load's value is times: reference area per direction [m^2] of a traction, ...; hold: 1 where prescribed, 0
  // where free
  Real share[D] = {};
};

/// A corner of a face that a pressure follows.
template <int D>
struct PressedCorner {
  Index element = 0;
  std::int8_t corner[D] = {};  // of the element: those of the face, ordered so that its normal points outward
  std::int8_t own = 0;         // which of them this is
  double share = 0;            // of the face's area, times D
};

/// A vertex of an absorbing boundary.
template <int D, class Real>
struct AbsorbingVertex {
  Index vertex = 0;
  double impedance[D * D] = {};  // force by velocity, symmetric [kg/s]
};

/// Adds value(t) * share to the force of each listed vertex.
template <int D, class Real_>
struct AddLoad {
  static constexpr char const* name = "loads";
  static constexpr bool packed = false;
  using Real = Real_;

  LoadedVertex<D, Real> const* list = nullptr;
  double value[D] = {};  // [Pa]
  Real* force = nullptr;

  template <class S>
  FISSURE_HD void operator()(Index k) const {
    for (int c = 0; c < D; ++c)
      force[static_cast<std::size_t>(list[k].vertex) * D + c] += static_cast<Real>(value[c]) * list[k].share[c];
  }
};

/// The area that a pressure acts on, inward, at each listed vertex, of the faces as they stand now. What a closed
/// surface feels is then -p dV/dx, V the volume in it: no force and no moment in all.
template <int D, class Real_>
struct FollowFaces {
  static constexpr char const* name = "loads";
  static constexpr bool packed = false;
  using Real = Real_;

  MeshView<D, Real> mesh;
  LoadedVertex<D, Real>* list = nullptr;
  Index const* first = nullptr;  // ranges of the vertices in `corner`
  PressedCorner<D> const* corner = nullptr;

  template <class S>
  FISSURE_HD void operator()(Index k) const {
    Vec<Real, D> area = Vec<Real, D>::Zero();
    for (Index i = first[k]; i < first[k + 1]; ++i) {
      Vec<Real, D> x[D];
      for (int j = 0; j < D; ++j) x[j] = mesh.position(corner[i].element, corner[i].corner[j]);
      area += Dim<D>::face_normal(x) * (reach(x, corner[i].own) * Real(corner[i].share / D));
    }
    for (int c = 0; c < D; ++c) list[k].share[c] = -area[c];
  }

 private:
  /// How far a corner's part of a face reaches out of the plane [m].
  FISSURE_HD Real reach(Vec<Real, D> const (&x)[D], int own) const {
    if constexpr (Dim<D>::can_revolve)
      if (mesh.axisymmetric) {
        Real mean = 0;
        for (int j = 0; j < D; ++j) mean += x[j][0] / D;
        return mean > 0 ? Real(2 * std::numbers::pi) * mean * ring_share<D>(x[own][0], mean) : Real(0);
      }
    return Real(mesh.thickness);
  }
};

/// Vertices on the axis of revolution stay there: by symmetry nothing pulls them off it, and this does no work.
template <int D, class Real_>
struct StayOnAxis {
  static constexpr char const* name = "axis";
  static constexpr bool packed = false;
  using Real = Real_;

  Index const* list = nullptr;
  Real* force = nullptr;

  template <class S>
  FISSURE_HD void operator()(Index k) const {
    force[static_cast<std::size_t>(list[k]) * D] = 0;
  }
};

/// Work of a load over half a step: dt/2 f.v [J].
template <int D, class Real_>
struct LoadWork {
  static constexpr char const* name = "load work";
  static constexpr bool packed = false;
  using Real = Real_;

  LoadedVertex<D, Real> const* list = nullptr;
  double value[D] = {};
  Real const* v = nullptr;
  double share_of_dt = 0;

  template <class S>
  FISSURE_HD void operator()(Index k, Sums<1>& work) const {
    for (int c = 0; c < D; ++c)
      work[0] += share_of_dt * value[c] * static_cast<double>(list[k].share[c]) *
                 v[static_cast<std::size_t>(list[k].vertex) * D + c];
  }
};

/// The velocity that vertices are asked for in a step: all the same, or about an axis by an angle and outward, so that
/// what turns stays at its distance whatever the step.
template <int D, class Real>
struct HoldTarget {
  double uniform[D] = {};         // [m/s]; where no place is given
  double const* place = nullptr;  // [listed][D] at rest, from a point of the axis [m]
  Real const* held = nullptr;     // [listed][D] displacement there [m]
  double axis[3] = {};            // [-]
  double less = 0, ahead = 0;     // (cos - 1)/dt and sin/dt of the angle of a step [1/s]
  double dt = 0;                  // [s]
  double outward = 0;             // [m/s]
  double nothing = 0;             // what is nearer to the axis lies on it [m]

  /// From the axis to a vertex, across it [m].
  FISSURE_HD Vec<double, 3> across_axis(Index k) const {
    Vec<double, 3> across = Vec<double, 3>::Zero(), a(axis[0], axis[1], axis[2]);
    for (int c = 0; c < D; ++c) across[c] = place[k * D + c] + static_cast<double>(held[k * D + c]);
    return across - across.dot(a) * a;
  }
  /// Of a force on a vertex about the axis [N m]; 0 where there is none.
  FISSURE_HD double torque(Index k, Vec<double, D> const& force) const {
    if (!place) return 0;
    Vec<double, 3> f = Vec<double, 3>::Zero(), a(axis[0], axis[1], axis[2]);
    for (int c = 0; c < D; ++c) f[c] = force[c];
    return a.dot(across_axis(k).cross(f));
  }
  FISSURE_HD Vec<double, D> operator()(Index k) const {
    Vec<double, D> velocity;
    for (int c = 0; c < D; ++c) velocity[c] = uniform[c];
    if (!place) return velocity;
    Vec<double, 3> const across = across_axis(k), a(axis[0], axis[1], axis[2]);
    double const r = across.norm(), grows = r > nothing ? outward / r : 0, grown = 1 + grows * dt;  // [1/s], [-]
    Vec<double, 3> const moves = (grown * less + grows) * across + grown * ahead * a.cross(across);
    for (int c = 0; c < D; ++c) velocity[c] = moves[c];
    return velocity;
  }
};

/// The force that keeps a vertex on its prescribed motion: r = m (a_target - a_free); added to the force. Sums: its
/// total by direction [N], then the half-step work with the velocity before [J] and the torque about the axis [N m].
/// The part of r that changes the velocity acts over the kick, which is half a step when the motion begins; the part
/// that holds against other forces works over the steps.
template <int D, class Real_>
struct HoldReaction {
  static constexpr char const* name = "hold reaction";
  static constexpr bool packed = false;
  using Real = Real_;

  LoadedVertex<D, Real> const* list = nullptr;
  Real* impulse = nullptr;     // [listed][D]: of r, for the half-step work with the velocity after [N s]
  HoldTarget<D, Real> target;  // after this step
  Real const* v = nullptr;
  Real* force = nullptr;
  Real const* inverse_mass = nullptr;
  double gravity[D] = {};
  double last_dt = 0, dt = 0;  // of the step that led here; of the one to come [s]
  double damping = 0;          // [1/s]

  template <class S>
  FISSURE_HD void operator()(Index k, Sums<D + 2>& sums) const {
    double const kick = 0.5 * (last_dt + dt), a = 0.5 * damping * kick;
    Vec<double, D> const asked = target(k);
    Vec<double, D> reaction = Vec<double, D>::Zero();
    for (int c = 0; c < D; ++c) {
      impulse[k * D + c] = 0;
      if (!(list[k].share[c] > 0)) continue;
      std::size_t const i = static_cast<std::size_t>(list[k].vertex) * D + c;
      double const m = 1 / static_cast<double>(inverse_mass[list[k].vertex]);
      double const turn = m * ((1 + a) * asked[c] - (1 - a) * v[i]) / kick, hold = -m * gravity[c] - force[i],
                   r = turn + hold;
      force[i] += static_cast<Real>(r);
      impulse[k * D + c] = static_cast<Real>(0.5 * (kick * turn + dt * hold));
      sums[c] += r;
      sums[D] += 0.5 * (kick * turn + last_dt * hold) * v[i];
      reaction[c] = r;
    }
    sums[D + 1] += target.torque(k, reaction);
  }
};

/// The force of dashpots (Lysmer & Kuhlemeyer 1969), -Z (v- + v+)/2, with the v+ that it leads to itself: so it takes
/// energy at any step and asks for none smaller. Added to the force; sums the half-step work with the velocity before
/// [J].
template <int D, class Real_>
struct AbsorbWaves {
  static constexpr char const* name = "absorbing boundary";
  static constexpr bool packed = false;
  using Real = Real_;

  AbsorbingVertex<D, Real> const* list = nullptr;
  Real* impulse = nullptr;  // [listed][D]: half of it, for the half-step work with the velocity after [N s]
  Real const* v = nullptr;
  Real* force = nullptr;
  Real const* inverse_mass = nullptr;
  double gravity[D] = {};
  double kick = 0;     // from half step to half step [s]
  double damping = 0;  // [1/s]

  template <class S>
  FISSURE_HD void operator()(Index k, Sums<1>& work) const {
    Index const vertex = list[k].vertex;
    double const inverse = inverse_mass[vertex], m = inverse > 0 ? 1 / inverse : 0, a = 0.5 * damping * kick;
    Mat<double, D> Z;
    Vec<double, D> before, pushed;
    for (int i = 0; i < D; ++i) {
      std::size_t const at = static_cast<std::size_t>(vertex) * D + i;
      before[i] = v[at], pushed[i] = kick * (force[at] + m * gravity[i]);
      for (int j = 0; j < D; ++j) Z(i, j) = list[k].impedance[i * D + j];
    }
    Mat<double, D> left = 0.5 * kick * Z;
    for (int i = 0; i < D; ++i) left(i, i) += m * (1 + a);
    Vec<double, D> const right = m * (1 - a) * before - 0.5 * kick * (Z * before) + pushed;
    Vec<double, D> const dash = -0.5 * (Z * (before + solve(left, right)));
    for (int i = 0; i < D; ++i) {
      impulse[k * D + i] = static_cast<Real>(m > 0 ? 0.5 * kick * dash[i] : 0);
      force[static_cast<std::size_t>(vertex) * D + i] += static_cast<Real>(m > 0 ? dash[i] : 0);
      work[0] += m > 0 ? 0.5 * kick * dash[i] * before[i] : 0;
    }
  }

 private:
  /// Of a symmetric matrix with a large diagonal: elimination without pivots.
  FISSURE_HD static Vec<double, D> solve(Mat<double, D> A, Vec<double, D> x) {
    for (int i = 0; i < D; ++i)
      for (int j = i + 1; j < D; ++j) {
        double const share = A(j, i) / A(i, i);
        for (int c = i; c < D; ++c) A(j, c) -= share * A(i, c);
        x[j] -= share * x[i];
      }
    for (int i = D - 1; i >= 0; --i) {
      for (int c = i + 1; c < D; ++c) x[i] -= A(i, c) * x[c];
      x[i] /= A(i, i);
    }
    return x;
  }
};

/// Half-step work with the velocity after the step [J].
template <int D, class Real_>
struct AbsorbWork {
  static constexpr char const* name = "absorbing boundary, work";
  static constexpr bool packed = false;
  using Real = Real_;

  AbsorbingVertex<D, Real> const* list = nullptr;
  Real const *impulse = nullptr, *v = nullptr;

  template <class S>
  FISSURE_HD void operator()(Index k, Sums<1>& work) const {
    for (int c = 0; c < D; ++c)
      work[0] += static_cast<double>(impulse[k * D + c]) * v[static_cast<std::size_t>(list[k].vertex) * D + c];
  }
};

/// After the step: puts held vertices exactly where they must be; sums the half-step work with the velocity after [J].
template <int D, class Real_>
struct HoldMotion {
  static constexpr char const* name = "hold motion";
  static constexpr bool packed = false;
  using Real = Real_;

  LoadedVertex<D, Real> const* list = nullptr;
  Real const* impulse = nullptr;  // HoldReaction's
  HoldTarget<D, Real> target;
  Real* held = nullptr;  // [listed][D] displacement that prescribed directions have reached [m]
  Real* u = nullptr;
  Real* v = nullptr;
  double dt = 0;

  template <class S>
  FISSURE_HD void operator()(Index k, Sums<1>& work) const {
    Vec<double, D> const asked = target(k);
    for (int c = 0; c < D; ++c) {
      if (!(list[k].share[c] > 0)) continue;
      std::size_t const i = static_cast<std::size_t>(list[k].vertex) * D + c;
      held[k * D + c] += static_cast<Real>(dt * asked[c]);
      u[i] = held[k * D + c];
      v[i] = static_cast<Real>(asked[c]);
      work[0] += impulse[k * D + c] * asked[c];
    }
  }
};

}  // namespace fissure::kernels
