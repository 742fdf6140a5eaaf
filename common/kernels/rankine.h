// Where joints begin by Rankine's criterion: where they carry, along a tension, what any face that lies as they do
// carries when the tension reaches the tensile strength (docs/theory/joints.md has why).
#pragma once
#include "kernels/block_joints.h"
#include "kernels/elements.h"
#include "kernels/flow.h"

namespace fissure::kernels {

/// Diagonalizes a symmetric matrix by Jacobi's rotations (Golub & Van Loan, Matrix Computations, 4th ed., 8.5);
/// `directions` has the principal directions as columns.
template <int D, class Real>
FISSURE_HD void diagonalize(Mat<Real, D>& s, Mat<Real, D>& directions) {
  directions = Mat<Real, D>::Identity();
  for (int sweep = 0; sweep < 6; ++sweep)  // converges by squares: three are enough for three dimensions
    for (int p = 0; p < D - 1; ++p)
      for (int q = p + 1; q < D; ++q) {
        Real const off = s(p, q);
        if (off == Real(0)) continue;
        Real const theta = (s(q, q) - s(p, p)) / (2 * off),
                   size = (theta < 0 ? -theta : theta) + root(theta * theta + Real(1));
        Real const t = (theta < 0 ? Real(-1) : Real(1)) / size, c = Real(1) / root(t * t + Real(1)), sine = t * c;
        for (int k = 0; k < D; ++k) {
          Real const kp = s(k, p), kq = s(k, q);
          s(k, p) = c * kp - sine * kq, s(k, q) = sine * kp + c * kq;
        }
        for (int k = 0; k < D; ++k) {
          Real const pk = s(p, k), qk = s(q, k);
          s(p, k) = c * pk - sine * qk, s(q, k) = sine * pk + c * qk;
          Real const kp = directions(k, p), kq = directions(k, q);
          directions(k, p) = c * kp - sine * kq, directions(k, q) = sine * kp + c * kq;
        }
        s(p, q) = s(q, p) = Real(0);
      }
}

/// Elements whose largest principal stress reaches a level: where level I - sigma is not positive definite. Counts
/// them.
template <int D, class Real_>
struct StressedElements {
  static constexpr char const* name = "stressed elements";
  static constexpr bool packed = false;
  using Real = Real_;

  double const* stress = nullptr;  // [element][6] [Pa]
  std::uint8_t* reached = nullptr;
  double level = 0;  // [Pa]

  template <class S>
  FISSURE_HD void operator()(Index e, Sums<1>& sums) const {
    Mat<double, D> rest = level * Mat<double, D>::Identity();
    double const* const sigma = stress + static_cast<std::size_t>(e) * 6;
    for (int k = 0; k < 6; ++k)
      if (int const r = tensor_row(k), c = tensor_column(k); r < D && c < D)
        rest(r, c) -= sigma[k], rest(c, r) = rest(r, c);
    bool past = false;
    for (int p = 0; p < D; ++p) {
      past = past || !(rest(p, p) > 0);
      for (int r = p + 1; r < D; ++r)
        for (int c = p + 1; c < D; ++c) rest(r, c) -= rest(r, p) * rest(p, c) / rest(p, p);
    }
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
  JointMemory<F, P, Real> memory;
  Law law;
  double const* stress = nullptr;         // [element][6]
  std::uint8_t const* reached = nullptr;  // as StressedElements

  /// Whether a tension may open a face between two elements: where one of them feels enough, and nothing has begun yet.
  FISSURE_HD bool asks(Index cell, int a, Index one, Index other) const {
    bool whole = (reached[one] || reached[other]) && memory.stiffness[blocked(cell, a, F)] > 0 &&
                 !(memory.tension_number(cell, a, 0) < 0);
    for (int i = 0; i < P; ++i) whole = whole && !(memory.number(cell, a, i, 0) > 0);
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
    Mat<Real, D> sigma, directions;
    double const *s = stress + static_cast<std::size_t>(one) * 6, *t = stress + static_cast<std::size_t>(other) * 6;
    for (int n = 0; n < 6; ++n)
      if (int const r = tensor_row(n), c = tensor_column(n); r < D && c < D)
        sigma(r, c) = sigma(c, r) = static_cast<Real>((s[n] + t[n]) / 2);
    diagonalize<D, Real>(sigma, directions);
    int first = 0;
    for (int i = 1; i < D; ++i)
      if (sigma(i, i) > sigma(first, first)) first = i;
    Vec<Real, D> way = directions.col(first);
    if (way.dot(motion.normal) < 0) way = -way;
    Real const cosine = way.dot(motion.normal);
    if (!(sigma(first, first) > 0 && cosine * cosine >= Real(least_across))) return;
    Real carries = 0;
    for (int i = 0; i < P; ++i) carries = larger(carries, k * motion.gap[i].dot(way));
    if (carries < Real(nearly) * ft * cosine) return;
    FaceAxes<D, Real> const axes(motion.span);
    memory.tension_number(cell, a, 0) = cosine;
    for (int c = 0; c < D - 1; ++c) memory.tension_number(cell, a, 1 + c) = axes.in_face[c].dot(way);
    memory.softening[(cell / layout_width) * F + a] = 1;
  }
};

/// The faces of simplices.
template <int D, class Real_, class Joint>
struct ElementRankine : ElementPass<D, Real_, JointsOnly, Joint> {
  static constexpr char const* name = "Rankine's criterion";
  using Pass = ElementPass<D, Real_, JointsOnly, Joint>;
  using Real = Real_;
  using Pass::C;

  RankineStart<D, C, D, Real, Joint> start;

  template <class S>
  FISSURE_HD void operator()(Index e) const {
    for (int l = 0; l < lane_width<S>; ++l) one(e + l);
  }
  FISSURE_HD void one(Index e) const {
    bool asked[C], any = false;
    for (int a = 0; a < C; ++a) any = (asked[a] = start.asks(e, a, e, this->joints.link[blocked(e, a, C)] >> 2)) || any;
    if (!any) return;
    Vec<Real, D> X[C], u[C], middle[D];
    this->template read<Real>(e, X, u);
    ElementMotion<D, Real> const cell(X, u, this->mesh.axisymmetric);
    for (int a = 0; a < C; ++a) {
      if (!asked[a]) continue;
      Index const other = this->joints.link[blocked(e, a, C)] >> 2;
      FaceMotion<D, D, Real> motion;
      this->read_face(e, a, X, u, motion.gap, middle);
      motion.resolve(middle, cell.outward(a));
      start.look(e, a, motion, e, other);
    }
  }
};

/// The faces of blocks.
template <int D, class Real_, class Joint>
struct BlockRankine : BlockJointPass<D, Real_, Joint> {
  static constexpr char const* name = "Rankine's criterion";
  using Pass = BlockJointPass<D, Real_, Joint>;
  using Real = Real_;
  using Pass::C, Pass::F, Pass::P;

  RankineStart<D, F, P, Real, Joint> start;

  template <class S>
  FISSURE_HD void operator()(Index b) const {
    for (int l = 0; l < lane_width<S>; ++l) one(b + l);
  }
  FISSURE_HD void one(Index b) const {
    Index const mine = this->blocks.first_part + b * this->blocks.parts;
    for (int a = 0; a < F; ++a) {
      Index const other = this->blocks.beyond[blocked(b, a, F)];
      if (other < 0 || !start.asks(b, a, mine, other)) continue;
      Vec<Real, D> X[C], u[C], middle[P];
      this->template read<Real>(b, X, u);
      FaceMotion<D, P, Real> motion;
      this->read_face(b, a, X, u, motion.gap, middle);
      motion.resolve(middle, Real(1));
      start.look(b, a, motion, mine, other);
    }
  }
};

}  // namespace fissure::kernels
