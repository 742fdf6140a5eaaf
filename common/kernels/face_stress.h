// Stress across the faces of cells: the mean of both sides, its largest tension, and the passes that ask of every face
// whether a joint begins there (rankine.h, insertion.h).
#pragma once
#include "kernels/block_joints.h"
#include "kernels/elements.h"
#include "kernels/flow.h"

namespace fissure::kernels {

/// Mean stress of two elements [Pa]. `stress`: [element][6].
template <int D, class Real>
FISSURE_HD Mat<Real, D> mean_stress(double const* stress, Index one, Index other) {
  Mat<Real, D> sigma;
  double const *s = stress + static_cast<std::size_t>(one) * 6, *t = stress + static_cast<std::size_t>(other) * 6;
  for (int n = 0; n < 6; ++n)
    if (int const r = tensor_row(n), c = tensor_column(n); r < D && c < D)
      sigma(r, c) = sigma(c, r) = static_cast<Real>((s[n] + t[n]) / 2);
  return sigma;
}

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

/// Whether the largest principal value of a symmetric matrix reaches a level: where level I - s is not positive
/// definite.
template <int D, class Real>
FISSURE_HD bool reaches(Mat<Real, D> const& s, Real level) {
  Mat<Real, D> rest = level * Mat<Real, D>::Identity() - s;
  bool past = false;
  for (int p = 0; p < D; ++p) {
    past = past || !(rest(p, p) > 0);
    for (int r = p + 1; r < D; ++r)
      for (int c = p + 1; c < D; ++c) rest(r, c) -= rest(r, p) * rest(p, c) / rest(p, p);
  }
  return past;
}

/// The largest principal stress, as a face sees it.
template <int D, class Real>
struct LargestTension {
  Real stress;       // [Pa]
  Vec<Real, D> way;  // its direction, to the side that the normal points to
  Real cosine;       // of the angle to the normal [-]

  FISSURE_HD LargestTension(Mat<Real, D> sigma, Vec<Real, D> const& normal) {
    Mat<Real, D> directions;
    diagonalize<D, Real>(sigma, directions);
    int first = 0;
    for (int i = 1; i < D; ++i)
      if (sigma(i, i) > sigma(first, first)) first = i;
    stress = sigma(first, first);
    way = directions.col(first);
    if (way.dot(normal) < 0) way = -way;
    cosine = way.dot(normal);
  }
};

/// Asks a question of the faces of simplices: asks(cell, face, one, other), whether it is worth asking, and
/// look(cell, face, motion, one, other); `one` and `other`: an element on either side.
template <int D, class Real_, class Joint, template <int, int, int, class, class> class Question>
struct ElementFaces : ElementPass<D, Real_, JointsOnly, Joint> {
  using Pass = ElementPass<D, Real_, JointsOnly, Joint>;
  using Real = Real_;
  using Pass::C;

  Question<D, C, D, Real, Joint> question;
  static constexpr char const* name = decltype(question)::name;

  template <class S>
  FISSURE_HD void operator()(Index e) const {
    for (int l = 0; l < lane_width<S>; ++l) one(e + l);
  }
  FISSURE_HD void one(Index e) const {
    bool asked[C], any = false;
    for (int a = 0; a < C; ++a)
      any = (asked[a] = question.asks(e, a, e, this->joints.link[blocked(e, a, C)] >> 2)) || any;
    if (!any) return;
    Vec<Real, D> X[C], u[C], middle[D];
    this->template read<Real>(e, X, u);
    ElementMotion<D, Real> const cell(X, u, this->mesh.axisymmetric);
    for (int a = 0; a < C; ++a) {
      if (!asked[a]) continue;
      FaceMotion<D, D, Real> motion;
      this->read_face(e, a, X, u, motion.gap, middle);
      motion.resolve(middle, cell.outward(a));
      question.look(e, a, motion, e, this->joints.link[blocked(e, a, C)] >> 2);
    }
  }
};

/// The same of the faces of blocks.
template <int D, class Real_, class Joint, template <int, int, int, class, class> class Question>
struct BlockFaces : BlockJointPass<D, Real_, Joint> {
  using Pass = BlockJointPass<D, Real_, Joint>;
  using Real = Real_;
  using Pass::C, Pass::F, Pass::P;

  Question<D, F, P, Real, Joint> question;
  static constexpr char const* name = decltype(question)::name;

  template <class S>
  FISSURE_HD void operator()(Index b) const {
    for (int l = 0; l < lane_width<S>; ++l) one(b + l);
  }
  FISSURE_HD void one(Index b) const {
    Index const mine = this->blocks.first_part + b * this->blocks.parts;
    for (int a = 0; a < F; ++a) {
      Index const other = this->blocks.beyond[blocked(b, a, F)];
      if (other < 0 || !question.asks(b, a, mine, other)) continue;
      Vec<Real, D> X[C], u[C], middle[P];
      this->template read<Real>(b, X, u);
      FaceMotion<D, P, Real> motion;
      this->read_face(b, a, X, u, motion.gap, middle);
      motion.resolve(middle, Real(1));
      question.look(b, a, motion, mine, other);
    }
  }
};

}  // namespace fissure::kernels
