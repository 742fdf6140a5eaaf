// Sums over contacts and their force slots: work, friction, reactions, drift, and the stiffness that limits the step.
#pragma once
#include "backend/for_each.h"
#include "kernels/rigid_contact.h"

namespace fissure::kernels {

/// Adds each touched vertex's slots to its force, in their fixed order, and finds how much its stiffness over mass
/// exceeds what the time step has room for [1/s^2].
template <int D, class Real_>
struct AddContact {
  static constexpr char const* name = "contact forces";
  static constexpr bool packed = false;
  using Real = Real_;

  Index const* vertex = nullptr;  // touched vertices
  Index const* first = nullptr;   // their ranges in `slot`
  Index const* slot = nullptr;
  Real const* slot_force = nullptr;      // [slot][D] [N]
  Real const* slot_stiffness = nullptr;  // [slot] [N/m]
  Real const* inverse_mass = nullptr;    // per vertex [1/kg]
  double const* room = nullptr;          // [touched] [1/s^2]
  Real* force = nullptr;                 // [vertex][D]
  Real* sum_force = nullptr;             // [touched][D]: the contacts' part of it, for its work [N]

  template <class S>
  FISSURE_HD void operator()(Index t, Sums<1>& largest) const {
    Vec<Real, D> sum = Vec<Real, D>::Zero();
    Real stiffness = 0;
    for (Index k = first[t]; k < first[t + 1]; ++k) {
      for (int c = 0; c < D; ++c) sum[c] += slot_force[static_cast<std::size_t>(slot[k]) * D + c];
      stiffness += slot_stiffness[slot[k]];
    }
    for (int c = 0; c < D; ++c) {
      force[static_cast<std::size_t>(vertex[t]) * D + c] += sum[c];
      sum_force[static_cast<std::size_t>(t) * D + c] = sum[c];
    }
    double const squared = static_cast<double>(stiffness) * inverse_mass[vertex[t]] - room[t];
    if (squared > largest[0]) largest[0] = squared;
  }
};

/// Sum of the slots of each group, in their fixed order.
template <int D, class Real_>
struct SumGroups {
  static constexpr char const* name = "contact normals";
  static constexpr bool packed = false;
  using Real = Real_;

  Index const* first = nullptr;  // ranges of the groups in `slot`
  Index const* slot = nullptr;
  Real const* slot_force = nullptr;  // [slot][D] [N]
  Real* sum = nullptr;               // [group][D] [N]

  template <class S = Real>
  FISSURE_HD void operator()(Index g) const {
    Vec<Real, D> total = Vec<Real, D>::Zero();
    for (Index k = first[g]; k < first[g + 1]; ++k)
      for (int c = 0; c < D; ++c) total[c] += slot_force[static_cast<std::size_t>(slot[k]) * D + c];
    for (int c = 0; c < D; ++c) sum[static_cast<std::size_t>(g) * D + c] = total[c];
  }
};

/// Work of contact forces on touched vertices over half a step: dt/2 f.v [J].
template <int D, class Real_>
struct ContactVertexWork {
  static constexpr char const* name = "contact work";
  static constexpr bool packed = false;
  using Real = Real_;

  Index const* vertex = nullptr;    // touched vertices
  Real const* sum_force = nullptr;  // [touched][D] [N]
  Real const* v = nullptr;
  double share_of_dt = 0;

  template <class S>
  FISSURE_HD void operator()(Index t, Sums<1>& work) const {
    for (int c = 0; c < D; ++c)
      work[0] += share_of_dt * static_cast<double>(sum_force[static_cast<std::size_t>(t) * D + c]) *
                 v[static_cast<std::size_t>(vertex[t]) * D + c];
  }
};

/// Work of a plate on one candidate over the half step that is to come [J]: half the force times the plate's way, the
/// impulse that the vertices feel. But a plate that draws back faster than the body follows takes out no more than the
/// contact holds, as a spring of its force and stiffness: of a way longer than the overlap the force acts along its
/// first part only.
template <int D, class Real_>
struct PlateWork {
  static constexpr char const* name = "plate work";
  static constexpr bool packed = false;
  using Real = Real_;

  MeshView<D, Real> mesh;
  RigidBox<D, Real> const* body = nullptr;  // its velocity in the step [m/s]
  double share_of_dt = 0;
  Index const* candidate = nullptr;  // these as RigidForces left them
  Real const* spring = nullptr;
  Real const* reaction = nullptr;
  Real const* stiffness = nullptr;

  template <class S>
  FISSURE_HD void operator()(Index i, Sums<1>& work) const {
    Index const e = candidate[2 * i];
    Real const* const memory = spring + static_cast<std::size_t>(i) * spring_size<D>;
    double pressing = 0, pressing_body = 0, rubbing = 0, rubbing_body = 0, stretched = 0, squared = 0, k = 0;
    for (int c = 0; c < D; ++c) {
      double const drag = -static_cast<double>(memory[c]) * memory[D],
                   normal = -static_cast<double>(reaction[static_cast<std::size_t>(i) * D + c]) - drag;
      double mean = 0;
      for (int a = 0; a <= D; ++a) mean += static_cast<double>(mesh.velocity(mesh.vertex(e, a))[c]) / (D + 1);
      double const plate = body[candidate[2 * i + 1]].velocity[c];
      pressing += normal * plate, pressing_body += normal * mean;
      rubbing += drag * plate, rubbing_body += drag * mean;
      stretched -= drag * static_cast<double>(memory[c]) / 2;
      squared += normal * normal;
    }
    for (int a = 0; a <= D; ++a) k += static_cast<double>(stiffness[static_cast<std::size_t>(i) * (D + 1) + a]);
    if (!(k > 0)) return;
    work[0] += bounded(share_of_dt * pressing, share_of_dt * pressing_body, squared / (2 * k)) +
               bounded(share_of_dt * rubbing, share_of_dt * rubbing_body, stretched);
  }

 private:
  /// The plate's work where the body's own motion does that of `along`.
  FISSURE_HD static double bounded(double plate, double along, double most) {
    return plate < 0 ? larger(plate, larger(plate, smaller(along, 0.0)) - most) : plate;
  }
};

/// Plain sum and largest value of an array.
template <class Real_>
struct SumOf {
  static constexpr char const* name = "contact sums";
  static constexpr bool packed = false;
  using Real = Real_;
  Real const* values = nullptr;

  template <class S>
  FISSURE_HD void operator()(Index k, Sums<1>& sum) const {
    sum[0] += static_cast<double>(values[k]);
  }
};

/// How many pairs of a list are looked at in a step, and how many of them touch.
template <class Real_>
struct CountPairs {
  static constexpr char const* name = "contact sums";
  static constexpr bool packed = false;
  using Real = Real_;
  double const* wake = nullptr;  // path at which each is looked at again [m]
  Real const* penetration = nullptr;
  double path = 0;  // [m]

  template <class S>
  FISSURE_HD void operator()(Index k, Sums<2>& sum) const {
    sum[0] += !(path < wake[k]), sum[1] += penetration[k] > 0;
  }
};

template <class Real_>
struct LargestOf {
  static constexpr char const* name = "contact sums";
  static constexpr bool packed = false;
  using Real = Real_;
  Real const* values = nullptr;

  template <class S>
  FISSURE_HD void operator()(Index k, Sums<1>& largest) const {
    if (static_cast<double>(values[k]) > largest[0]) largest[0] = static_cast<double>(values[k]);
  }
};

/// Reaction on one rigid body [N].
template <int D, class Real_>
struct Reaction {
  static constexpr char const* name = "reactions";
  static constexpr bool packed = false;
  using Real = Real_;
  Index const* candidate = nullptr;  // [candidate][2]: element, body
  Real const* reaction = nullptr;    // [candidate][D]
  Index body = 0;

  template <class S>
  FISSURE_HD void operator()(Index k, Sums<D>& sum) const {
    if (candidate[2 * k + 1] != body) return;
    for (int c = 0; c < D; ++c) sum[c] += static_cast<double>(reaction[static_cast<std::size_t>(k) * D + c]);
  }
};

/// How far vertices have moved since the list was built and how fast they are: by axis, largest of -move, of move [m],
/// of -v and of v [m/s].
template <int D, class Real_>
struct DriftSince {
  static constexpr char const* name = "contact drift";
  static constexpr bool packed = false;
  using Real = Real_;
  Index const* vertex = nullptr;
  Real const* start = nullptr;  // [listed][D]
  Real const* u = nullptr;
  Real const* v = nullptr;

  template <class S>
  FISSURE_HD void operator()(Index k, Sums<4 * D>& largest) const {
    for (int c = 0; c < D; ++c) {
      std::size_t const i = static_cast<std::size_t>(vertex[k]) * D + c;
      double const moved = static_cast<double>(u[i]) - static_cast<double>(start[static_cast<std::size_t>(k) * D + c]);
      double const values[4] = {-moved, moved, -static_cast<double>(v[i]), static_cast<double>(v[i])};
      for (int n = 0; n < 4; ++n)
        if (values[n] > largest[n * D + c]) largest[n * D + c] = values[n];
    }
  }
};

}  // namespace fissure::kernels
