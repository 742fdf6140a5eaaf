// Where joints begin by Rankine's criterion: where they carry, along a tension, what any face that lies as they do
// carries when the tension reaches the tensile strength (docs/theory/joints.md has why).
#pragma once
#include <limits>

#include "kernels/face_stress.h"

namespace fissure::kernels {

/// Elements in which some face could feel a tension and a shear stress whose squares, over those of two levels, add up
/// to 1. Both are convex in stress, so that the mean of two elements feels no more than one of them. Counts them.
template <int D, class Real_>
struct StressedElements {
  static constexpr char const* name = "stressed elements";
  static constexpr bool packed = false;
  using Real = Real_;

  double const* stress = nullptr;  // [element][6] [Pa]
  std::uint8_t* reached = nullptr;
  double tension = 0, shear = std::numeric_limits<double>::infinity();  // [Pa]

  template <class S>
  FISSURE_HD void operator()(Index e, Sums<1>& sums) const {
    Mat<double, D> const sigma = mean_stress<D, double>(stress, e, e),
                         deviator = sigma - sigma.trace() / D * Mat<double, D>::Identity();
    // No shear stress is above the root of J2.
    double const left = 1 - deviator.squaredNorm() / 2 / (shear * shear);
    bool const past = !(left > 0) || reaches<D, double>(sigma, tension * root(left));
    reached[e] = past;
    sums[0] += past;
  }
};

/// Square of the cosine between a face's normal and the tension up to which the face is part of a crack across that: 60
/// degrees, as steep as the teeth of a crack in a mesh of good shape are.
inline constexpr double least_across = 0.25;

/// Share of the tensile strength that one of the two cells beside a face must feel for a tension to open it: at the end
/// of a crack cells feel less than a corner of their face carries, and in a body that is pressed there is some tension
/// everywhere.
inline constexpr double enough = 0.5;
/// Opening over slip from which on a joint opens: whatever is pressed slides, and so does what is sheared in its own
/// plane, a crack of mode II.
inline constexpr double least_opening = 0.1;
/// Share of what a joint may carry along a tension at which it is told the tension: early enough before the next look.
inline constexpr double nearly = 0.9;

/// Which joints a tension opens, and which tension. All that it finds is the same from both sides.
template <int D, int F, int P, class Real, class Law>
struct RankineStart {
  static constexpr char const* name = "Rankine's criterion";
  JointMemory<F, P, Real> memory;
  Law law;
  double const* stress = nullptr;         // [element][6]
  std::uint8_t const* reached = nullptr;  // as StressedElements

  /// Whether a tension may open a face between two elements: where one of them feels enough, and nothing has begun yet.
  FISSURE_HD bool asks(Index cell, int a, Index one, Index other) const {
    bool whole = (reached[one] || reached[other]) && memory.stiffness[blocked(cell, a, F)] > 0 &&
                 !(memory.tension_number(cell, a, 0) < 0);
    for (int i = 0; i < P; ++i) whole = whole && !(memory.damage(cell, a, i) > 0);
    return whole;
  }

  /// Tells a joint which tension pulls it, from the mean stress of the elements beside it, once it carries nearly what
  /// it would if the tension were ft. From then on its traction along the tension is limited, in no other direction.
  FISSURE_HD void look(Index cell, int a, FaceMotion<D, P, Real> const& motion, Index one, Index other) const {
    Real const k = memory.stiffness[blocked(cell, a, F)] * memory.template weakness_of<Real>(cell, a);
    Real const ft = static_cast<Real>(law.tension);
    Real opened = 0, slid = 0, gap = 0;
    for (int i = 0; i < P; ++i) {
      opened += motion.opening[i], slid += motion.slip[i];
      gap = larger(gap, motion.gap[i].squaredNorm());
    }
    Real const least = Real(nearly) * root(Real(least_across)) * ft;
    if (!(opened > Real(least_opening) * slid && k * k * gap >= least * least)) return;
    LargestTension<D, Real> const tension(mean_stress<D, Real>(stress, one, other), motion.normal);
    if (!(tension.stress > 0 && tension.cosine * tension.cosine >= Real(least_across))) return;
    Real carries = 0;
    for (int i = 0; i < P; ++i) carries = larger(carries, k * motion.gap[i].dot(tension.way));
    if (carries < Real(nearly) * ft * tension.cosine) return;
    memory.tell_tension(cell, a, FaceAxes<D, Real>(motion.span), tension.cosine, tension.way);
    memory.softening[(cell / layout_width) * F + a] = 1;
  }
};

template <int D, class Real, class Joint>
using ElementRankine = ElementFaces<D, Real, Joint, RankineStart>;
template <int D, class Real, class Joint>
using BlockRankine = BlockFaces<D, Real, Joint, RankineStart>;

}  // namespace fissure::kernels
