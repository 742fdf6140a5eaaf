// Joints inserted where a whole body reaches its strength (Camacho & Ortiz 1996, doi 10.1016/0020-7683(95)00255-3):
// until then the cells about a node move as one, tied by the mean of their forces (docs/theory/joints.md, On demand).
#pragma once
#include "kernels/rankine.h"

namespace fissure::kernels {

/// Vertices at each node in groups that move as one: of a node those from first[node] on, a group from each start on.
struct TieView {
  Index const* first = nullptr;          // [node]
  Index const* vertex = nullptr;         // [tied]
  std::uint8_t const* starts = nullptr;  // [tied] 1 where a group begins

  /// f(begin, end) for every group of a node that ties two vertices or more.
  template <class F>
  FISSURE_HD void over_groups(Index node, F&& f) const {
    for (Index begin = first[node], end; begin < first[node + 1]; begin = end) {
      for (end = begin + 1; end < first[node + 1] && !starts[end];) ++end;
      if (end - begin > 1) f(begin, end);
    }
  }
};

/// Gives all vertices of a group the acceleration of their sum.
template <int D, class Real_>
struct TieForces {
  static constexpr char const* name = "tied forces";
  static constexpr bool packed = false;
  using Real = Real_;

  TieView ties;
  Real const* share = nullptr;  // [tied] of a vertex in the mass of its group [-]
  Real* force = nullptr;        // [vertex][D] [N]

  template <class S>
  FISSURE_HD void operator()(Index node) const {
    ties.over_groups(node, [this](Index begin, Index end) {
      Vec<Real, D> sum = Vec<Real, D>::Zero();
      for (Index k = begin; k < end; ++k)
        for (int c = 0; c < D; ++c) sum[c] += force[static_cast<std::size_t>(ties.vertex[k]) * D + c];
      for (Index k = begin; k < end; ++k)
        for (int c = 0; c < D; ++c) force[static_cast<std::size_t>(ties.vertex[k]) * D + c] = share[k] * sum[c];
    });
  }
};

/// Takes the last digits from between the vertices of a group: no gap grows by rounding.
template <int D, class Real_>
struct TieMotion {
  static constexpr char const* name = "tied motion";
  static constexpr bool packed = false;
  using Real = Real_;

  TieView ties;
  Real *u = nullptr, *v = nullptr;  // [vertex][D]

  template <class S>
  FISSURE_HD void operator()(Index node) const {
    ties.over_groups(node, [this](Index begin, Index end) {
      std::size_t const from = static_cast<std::size_t>(ties.vertex[begin]) * D;
      for (Index k = begin + 1; k < end; ++k) {
        std::size_t const to = static_cast<std::size_t>(ties.vertex[k]) * D;
        for (int c = 0; c < D; ++c) u[to + c] = u[from + c], v[to + c] = v[from + c];
      }
    });
  }
};

/// Share of its strength that a face must feel, on the mean over both cells, for a node to be split along it: at the
/// end of a crack cells feel less than what is tied at a node carries, which decides.
inline constexpr double felt = 0.5;

/// Which faces of a whole body feel enough: by the traction on them of the mean stress beside them, or where that
/// stress is tension across them, as RankineStart has it. The tension is told again until the joint carries something.
/// All that is found is the same from both sides.
template <int D, int F, int P, class Real, class Law>
struct Insertion {
  static constexpr char const* name = "insertion";
  JointMemory<F, P, Real> memory;
  Law law;
  double const* stress = nullptr;         // [element][6] [Pa]
  std::uint8_t const* reached = nullptr;  // as StressedElements
  std::uint8_t* whole = nullptr;          // 1 where no joint has been inserted                                [F]
  FaceEvents found;
  bool rankine = false;

  FISSURE_HD bool asks(Index cell, int a, Index one, Index other) const {
    if (one == other || !(reached[one] || reached[other])) return false;
    if (whole[blocked(cell, a, F)]) return true;
    bool begun = !rankine || memory.tension_number(cell, a, 0) < 0;
    for (int i = 0; i < P; ++i) begun = begun || memory.began_loaded(cell, a, i) || memory.damage(cell, a, i) > 0;
    return !begun;
  }

  FISSURE_HD void look(Index cell, int a, FaceMotion<D, P, Real> const& motion, Index one, Index other) const {
    Mat<Real, D> const sigma = mean_stress<D, Real>(stress, one, other);
    Vec<Real, D> const traction = sigma * motion.normal;
    Real const normal = traction.dot(motion.normal), shear = (traction - normal * motion.normal).norm();
    Real const k = memory.stiffness[blocked(cell, a, F)], weak = memory.template weakness_of<Real>(cell, a);
    bool enough = law.past_peak(k * weak / Real(felt), normal / k, shear / k);
    if (rankine && !(memory.tension_number(cell, a, 0) < 0))
      enough = tell_tension(cell, a, motion, weak, normal > Real(least_opening) * shear, sigma) || enough;
    if (!enough || !whole[blocked(cell, a, F)]) return;
    whole[blocked(cell, a, F)] = 0;
    found.tell(cell, F, a);
  }

 private:
  /// Whether a tension across the face is large enough; the joint is told which.
  FISSURE_HD bool tell_tension(Index cell, int a, FaceMotion<D, P, Real> const& motion, Real weak, bool opens,
                               Mat<Real, D> const& sigma) const {
    FaceAxes<D, Real> const axes(motion.span);
    if (opens && reaches<D, Real>(sigma, static_cast<Real>(felt * law.tension) / weak)) {
      LargestTension<D, Real> const tension(sigma, motion.normal);
      if (tension.cosine * tension.cosine >= Real(least_across)) {
        memory.tell_tension(cell, a, axes, tension.cosine, tension.way);
        return true;
      }
    }
    memory.tell_tension(cell, a, axes, Real(0), Vec<Real, D>(Vec<Real, D>::Zero()));
    return false;
  }
};

template <int D, class Real, class Joint>
using ElementInsertion = ElementFaces<D, Real, Joint, Insertion>;
template <int D, class Real, class Joint>
using BlockInsertion = BlockFaces<D, Real, Joint, Insertion>;

}  // namespace fissure::kernels
