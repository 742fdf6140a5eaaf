// Where joints begin by Rankine's criterion: the largest principal stress of the cells beside a face reaches the tensile strength,
// whichever way the face lies (docs/theory/joints.md has why).
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
        Real const theta = (s(q, q) - s(p, p)) / (2 * off), size = (theta < 0 ? -theta : theta) + root(theta * theta + Real(1));
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

/// Elements whose largest principal stress reaches a level, 1, or a strength, 2: where level I - sigma is not positive
/// definite. Counts them.
template <int D, class Real_>
struct StressedElements {
  static constexpr char const* name = "stressed elements";
  static constexpr bool packed = false;
  using Real = Real_;

  double const* stress = nullptr;  // [element][6] [Pa]
  std::uint8_t* reached = nullptr;
  double level = 0, strength = 0;  // [Pa]

  template <class S>
  FISSURE_HD void operator()(Index e, Sums<1>& sums) const {
    int const steps = !reaches(e, level) ? 0 : !reaches(e, strength) ? 1 : 2;
    reached[e] = static_cast<std::uint8_t>(steps);
    sums[0] += steps > 0 ? 1 : 0;
  }
  FISSURE_HD bool reaches(Index e, double limit) const {
    Mat<double, D> rest = limit * Mat<double, D>::Identity();
    double const* const sigma = stress + static_cast<std::size_t>(e) * 6;
    for (int k = 0; k < 6; ++k)
      if (int const r = tensor_row(k), c = tensor_column(k); r < D && c < D) rest(r, c) -= sigma[k], rest(c, r) = rest(r, c);
    bool past = false;
    for (int p = 0; p < D; ++p) {
      past = past || !(rest(p, p) > 0);
      for (int r = p + 1; r < D; ++r)
        for (int c = p + 1; c < D; ++c) rest(r, c) -= rest(r, p) * rest(p, c) / rest(p, p);
    }
    return past;
  }
};

/// Square of the cosine between a face's normal and the tension up to which the face is part of a crack across that: 60
/// degrees, as steep as the teeth of a crack in a mesh of good shape are.
inline constexpr double least_across = 0.25;

/// Share of the tensile strength that one of two cells must feel for their face to be looked at, so that a tension is
/// taken for the cause of what its own traction has opened: at the end of a crack cells feel less than a corner of
/// their face carries, and in a body that is pressed there is some tension everywhere.
inline constexpr double enough = 0.5;
/// Share that one of them must feel where nothing has begun yet: no more than their mean, but for an area that grows.
inline constexpr double nearly = 0.9;
/// Damage from which on it is too late for that: what slid and is pulled later stays what it is.
inline constexpr double fresh = 0.2;

/// How the joint on a face begins. All that it finds is the same from both sides.
template <int D, int F, int P, class Real, class Law>
struct RankineStart {
  JointMemory<F, P, Real> memory;
  Law law;
  double const* stress = nullptr;         // [element][6]
  std::uint8_t const* reached = nullptr;  // as StressedElements

  /// Whether anything may have happened to a face: what has begun near to a tension, or may begin where one of both
  /// cells reaches the strength.
  FISSURE_HD bool asks(Index cell, int a, Index one, Index other) const {
    int const most = reached[one] > reached[other] ? reached[one] : reached[other];
    return most > 1 || (most == 1 && memory.softening[(cell / layout_width) * F + a] != 0);
  }

  /// The joint begins where the mean stress of the elements `one` and `other` beside it says so: its strengths become
  /// what it carries now, so that nothing jumps. Began it so, or by its own traction since the last look, while a
  /// tension pulls across it, it is part of a crack across that tension: its fracture energy is G1 for the share of its
  /// area that lies across. `grown`: its area now over that at rest, as strengths are per area at rest.
  FISSURE_HD void look(Index cell, int a, FaceMotion<D, P, Real> const& motion, Real grown, Index one, Index other) const {
    Real& weaker = memory.start[blocked(cell, a * 2, F * 2)];
    Real& energy = memory.start[blocked(cell, a * 2 + 1, F * 2)];
    Real const k = memory.stiffness[blocked(cell, a, F)], weak = memory.template weakness_of<Real>(cell, a);
    if (!(k > 0) || energy != Real(0)) return;
    Real damage = 0;
    for (int i = 0; i < P; ++i) damage = larger(damage, memory.number(cell, a, i, 0));
    Mat<Real, D> sigma, directions;
    double const *s = stress + static_cast<std::size_t>(one) * 6, *t = stress + static_cast<std::size_t>(other) * 6;
    for (int n = 0; n < 6; ++n)
      if (int const r = tensor_row(n), c = tensor_column(n); r < D && c < D)
        sigma(r, c) = sigma(c, r) = static_cast<Real>((s[n] + t[n]) / 2);
    diagonalize<D, Real>(sigma, directions);
    Real largest = sigma(0, 0), pulls = 0;
    for (int i = 0; i < D; ++i) {
      Real const along = directions.col(i).dot(motion.normal);
      largest = larger(largest, sigma(i, i)), pulls += along * along * positive(sigma(i, i));
    }
    Real const across = pulls / largest;
    bool const opens = largest > 0 && across >= Real(least_across);
    Real const whole = static_cast<Real>(law.G1) * root(across);
    Real const share = largest * grown * weak / static_cast<Real>(law.tension);
    if (damage > 0) {
      energy = opens && damage < Real(fresh) ? whole : Real(-1);
    } else if (opens && share >= Real(1)) {
      Real carries = 0;
      for (int i = 0; i < P; ++i) carries += law.reached(k, weak * motion.opening[i], weak * motion.slip[i]) / P;
      carries = smaller(Real(1), larger(Real(0.1), carries));
      weaker = 1 / carries;
      energy = whole / (carries * carries);
      memory.softening[(cell / layout_width) * F + a] = 1;
    }
  }
};

/// Area of a face now over that at rest, from corners of its surface times two [-]; once around an axis if it is
/// axisymmetric.
template <int D, int P, class Real>
FISSURE_HD Real area_growth(Vec<Real, D> const (&now)[P], Vec<Real, D> const (&rest)[P], [[maybe_unused]] bool axisymmetric) {
  Real const flat = Dim<D>::face_normal(now).norm() / Dim<D>::face_normal(rest).norm();
  if constexpr (Dim<D>::can_revolve)
    if (axisymmetric) {
      Real radii = 0, radii_now = 0;
      for (int i = 0; i < P; ++i) radii += rest[i][0], radii_now += now[i][0];
      return flat * radii_now / radii;
    }
  return flat;
}

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
    for (int a = 0; a < C; ++a) {
      Index const other = this->joints.link[blocked(e, a, C)] >> 2;
      if (!start.asks(e, a, e, other)) continue;
      Vec<Real, D> X[C], u[C], middle[D], rest[D];
      this->template read<Real>(e, X, u);
      FaceMotion<D, D, Real> motion;
      this->read_face(e, a, X, u, motion.gap, middle);
      motion.resolve(middle, ElementMotion<D, Real>(X, u, this->mesh.axisymmetric).outward(a));
      for (int i = 0; i < D; ++i) rest[i] = X[i + (i >= a)] + X[i + (i >= a)];
      start.look(e, a, motion, area_growth<D, D, Real>(middle, rest, this->mesh.axisymmetric), e, other);
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
      Vec<Real, D> X[C], u[C], middle[P], rest[P];
      this->template read<Real>(b, X, u);
      FaceMotion<D, P, Real> motion;
      this->read_face(b, a, X, u, motion.gap, middle);
      motion.resolve(middle, Real(1));
      for (int i = 0; i < P; ++i) rest[i] = X[Pass::Shape::face(a, i)] + X[Pass::Shape::face(a, i)];
      start.look(b, a, motion, area_growth<D, P, Real>(middle, rest, this->mesh.axisymmetric), mine, other);
    }
  }
};

}  // namespace fissure::kernels
