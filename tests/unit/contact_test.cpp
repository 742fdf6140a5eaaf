// Contact: forces against the gradient of an independently computed energy, momentum, closed paths, friction, pair search.
#include "kernels/contact.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>
#include <set>

#include "../../src2d/clip.h"
#include "../../src3d/clip.h"
#include "base/error.h"
#include "solver/broad_phase.h"

namespace fissure {
namespace {

using kernels::layout_width;

template <int D>
using Corners = std::array<Vec<double, D>, D + 1>;

/// A few elements with corners of their own, one law, and the outputs of the contact kernels.
template <int D, class Real = double>
struct Rig {
  std::vector<Real> X, u, v, spring, force, stiffness, work, penetration, reaction;
  std::vector<std::uint8_t> law;
  laws::ContactLaw contact;
  std::vector<Index> pair{0, 1};
  Index n = 0;

  explicit Rig(std::vector<Corners<D>> const& elements, laws::ContactLaw contact = {1.0, 0.0})
      : contact(contact), n(static_cast<Index>(elements.size())) {
    std::size_t const padded = (elements.size() + layout_width - 1) / layout_width * layout_width, corners = padded * (D + 1);
    X.resize(corners * D);
    u.resize(corners * D);
    v.resize(corners * D);
    law.resize(padded);
    for (Index e = 0; e < n; ++e)
      for (int a = 0; a <= D; ++a)
        for (int c = 0; c < D; ++c) X[kernels::blocked(e, a * D + c, (D + 1) * D)] = Real(elements[e][a][c]);
    spring.resize(kernels::spring_size<D>);
    force.resize(2 * (D + 1) * D);
    stiffness.resize(2 * (D + 1));
    work.resize(1);
    penetration.resize(1);
    reaction.resize(D);
  }
  kernels::MeshView<D, Real> mesh() {
    return {n, n * (D + 1), X.data(), nullptr, nullptr, u.data(), v.data()};
  }
  void move(Index e, Vec<double, D> const& by) {
    for (int a = 0; a <= D; ++a)
      for (int c = 0; c < D; ++c) u[(e * (D + 1) + a) * D + c] += Real(by[c]);
  }
  void speed(Index e, Vec<double, D> const& to) {
    for (int a = 0; a <= D; ++a)
      for (int c = 0; c < D; ++c) v[(e * (D + 1) + a) * D + c] = Real(to[c]);
  }
  /// Runs the pair kernel; force(e, a) then holds the slots.
  void touch(double dt = 0) {
    kernels::PairForces<D, Real>{mesh(), {law.data(), &contact, 1, 1.0}, Real(dt), pair.data(), spring.data(), force.data(),
                                 stiffness.data(), work.data(), penetration.data()}(0);
  }
  template <class Body>
  void press(Body const& body, double dt = 0) {
    pair = {0, 0};
    kernels::RigidForces<D, Real, Body>{mesh(), {law.data(), &contact, 1, 1.0}, &body, Real(dt), pair.data(), spring.data(),
                                        force.data(), reaction.data(), stiffness.data(), work.data(), penetration.data()}(0);
  }
  Vec<double, D> at(Index slot) const {
    Vec<double, D> f;
    for (int c = 0; c < D; ++c) f[c] = double(force[slot * D + c]);
    return f;
  }
  Vec<double, D> total(Index side) const {
    Vec<double, D> sum = Vec<double, D>::Zero();
    for (int a = 0; a <= D; ++a) sum += at(side * (D + 1) + a);
    return sum;
  }
};

// ------------------------------------------------------------------------- an independent energy: simplices cut into simplices
template <int D>
double volume(Corners<D> const& s) {
  Mat<double, D> edges;
  for (int a = 1; a <= D; ++a) edges.col(a - 1) = s[a] - s[0];
  return std::abs(edges.determinant()) / (D == 2 ? 2 : 6);
}

template <int D>
double barycentric(Corners<D> const& s, int i, Vec<double, D> const& x) {
  Eigen::Matrix<double, D + 1, D + 1> m;
  Eigen::Matrix<double, D + 1, 1> rhs;
  for (int a = 0; a <= D; ++a) m.col(a) << s[a], 1.0;
  rhs << x, 1.0;
  return m.fullPivLu().solve(rhs)[i];
}

/// Keeps the part where f >= 0 by putting a corner wherever an edge changes sign.
template <int D, class F>
void keep_positive(Corners<D> const& s, F const& f, std::vector<Corners<D>>& kept) {
  double value[D + 1], largest = 0;
  for (int a = 0; a <= D; ++a) value[a] = f(s[a]), largest = std::max(largest, value[a]);
  for (int a = 0; a <= D; ++a)
    for (int b = 0; b <= D; ++b)
      if (value[a] > 1e-13 && value[b] < -1e-13) {
        Vec<double, D> const middle = s[a] + (s[b] - s[a]) * (value[a] / (value[a] - value[b]));
        Corners<D> one = s, two = s;
        one[a] = middle;
        two[b] = middle;
        keep_positive<D>(one, f, kept);
        keep_positive<D>(two, f, kept);
        return;
      }
  if (largest > 1e-13) kept.push_back(s);
}

/// Integral over the overlap of phi_A + phi_B, fan by fan.
template <int D>
double overlap_energy(Corners<D> const& A, Corners<D> const& B) {
  auto fan = [](Corners<D> s, int i) {
    Vec<double, D> center = Vec<double, D>::Zero();
    for (auto const& x : s) center += x / (D + 1);
    s[i] = center;
    return s;
  };
  double energy = 0;
  for (int i = 0; i <= D; ++i)
    for (int j = 0; j <= D; ++j) {
      Corners<D> const a = fan(A, i), b = fan(B, j);
      if (volume<D>(a) < 1e-14 || volume<D>(b) < 1e-14) continue;
      std::vector<Corners<D>> parts{a};
      for (int k = 0; k <= D; ++k) {
        std::vector<Corners<D>> next;
        Eigen::Matrix<double, D + 1, D + 1> m;
        for (int c = 0; c <= D; ++c) m.col(c) << b[c], 1.0;
        Eigen::Matrix<double, 1, D + 1> const row = m.inverse().row(k);
        for (auto const& part : parts)
          keep_positive<D>(part, [&](Vec<double, D> const& x) { return row.template head<D>().dot(x) + row[D]; }, next);
        parts = next;
      }
      for (auto const& part : parts) {
        double sum = 0;
        for (auto const& x : part) sum += (barycentric<D>(a, i, x) + barycentric<D>(b, j, x)) / (D + 1);
        energy += sum * volume<D>(part);
      }
    }
  return energy;
}

template <int D>
Corners<D> moved(Corners<D> s, Vec<double, D> const& by) {
  for (auto& x : s) x += by;
  return s;
}

/// Generators of rotation: one in the plane, three in space.
template <int D>
std::vector<Mat<double, D>> spins() {
  std::vector<Mat<double, D>> all;
  for (int i = 0; i < D; ++i)
    for (int j = i + 1; j < D; ++j) {
      Mat<double, D> W = Mat<double, D>::Zero();
      W(i, j) = -1;
      W(j, i) = 1;
      all.push_back(W);
    }
  return all;
}

template <int D>
Mat<double, D> rotation(Mat<double, D> const& W, double angle) {  // W generates a turn in one plane
  return Mat<double, D>::Identity() + std::sin(angle) * W + (1 - std::cos(angle)) * W * W;
}

template <int D>
Corners<D> random_simplex(std::mt19937& rng, double spread, bool on_grid = false) {
  std::uniform_real_distribution<double> real(0, 1);
  std::uniform_int_distribution<int> whole(0, 3);
  while (true) {
    Corners<D> s;
    for (auto& x : s)
      for (int c = 0; c < D; ++c) x[c] = (on_grid ? whole(rng) / 3.0 : real(rng)) * spread;
    if (volume<D>(s) > 0.01) return s;
  }
}

template <class T>
class Contact : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(Contact, Dimensions);

// --------------------------------------------------------------------------------------------------------------- pairs
TYPED_TEST(Contact, KeepsLinearAndAngularMomentumD2) {
  constexpr int D = TypeParam::value;
  std::mt19937 rng(7);
  int touching = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    Rig<D> rig({random_simplex<D>(rng, 1), random_simplex<D>(rng, 1)}, {1e9, trial % 2 ? 0.4 : 0.0});
    rig.speed(0, Vec<double, D>::Constant(1.0));
    rig.touch(0.1);
    double size = 0, moment_size = 0;
    Vec<double, D> sum = Vec<double, D>::Zero();
    Mat<double, D> moment = Mat<double, D>::Zero();
    for (Index s = 0; s < 2 * (D + 1); ++s) {
      Vec<double, D> const f = rig.at(s), x = rig.mesh().position(s / (D + 1), s % (D + 1));
      sum += f;
      moment += x * f.transpose() - f * x.transpose();
      size += f.norm();
      moment_size += f.norm() * x.norm();
    }
    ASSERT_TRUE(std::isfinite(size));
    touching += size > 0;
    EXPECT_LE(sum.norm(), 1e-12 * size);
    EXPECT_LE(moment.norm(), 1e-9 * moment_size);
  }
  EXPECT_GT(touching, 1000);
}

/// Force and moment on B are minus the gradient of p * energy in B's rigid motions. Corners on a coarse grid make coplanar
/// faces, shared corners and faces in the planes of a fan the rule.
template <int D>
void compare_with_gradient(bool on_grid, double tolerance) {
  std::mt19937 rng(11);
  int touching = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Corners<D> const A = random_simplex<D>(rng, 1, on_grid), B = random_simplex<D>(rng, 1, on_grid);
    double const p = 3.0, h = 1e-5;
    Rig<D> rig({A, B}, {p, 0});
    rig.touch();
    touching += rig.penetration[0] > 0;
    for (int c = 0; c < D; ++c) {
      Vec<double, D> const step = Vec<double, D>::Unit(c) * h;
      double const slope = p * (overlap_energy<D>(A, moved<D>(B, step)) - overlap_energy<D>(A, moved<D>(B, -step))) / (2 * h);
      EXPECT_NEAR(rig.total(1)[c], -slope, tolerance) << "trial " << trial;
    }
    for (auto const& W : spins<D>()) {
      Corners<D> plus = B, minus = B;
      double moment = 0;
      for (int a = 0; a <= D; ++a) {
        plus[a] = rotation<D>(W, h) * B[a];
        minus[a] = rotation<D>(W, -h) * B[a];
        moment += rig.at(D + 1 + a).dot(W * B[a]);
      }
      double const slope = p * (overlap_energy<D>(A, plus) - overlap_energy<D>(A, minus)) / (2 * h);
      EXPECT_NEAR(moment, -slope, tolerance) << "trial " << trial;
    }
  }
  EXPECT_GT(touching, 100);
}

TYPED_TEST(Contact, ForceIsTheGradientOfTheOverlapEnergy) { compare_with_gradient<TypeParam::value>(false, 2e-8); }
TYPED_TEST(Contact, ForceIsTheGradientWhereFacesAndFansCoincide) { compare_with_gradient<TypeParam::value>(true, 2e-4); }

/// Relative work of A on B along a closed path that shifts and turns B through A and out of it, by the trapezoidal rule.
template <int D>
double closed_path_work(int steps) {
  std::mt19937 rng(3);
  Corners<D> const A = random_simplex<D>(rng, 1);
  Corners<D> B = random_simplex<D>(rng, 1), turned = B;
  Vec<double, D> center = Vec<double, D>::Zero(), target = center;
  for (int a = 0; a <= D; ++a) center += B[a] / (D + 1), target += A[a] / (D + 1);
  for (auto& x : turned) x -= center;
  double work = 0, size = 0, two_pi = 2 * std::acos(-1.0);
  Rig<D> rig({A, B});
  auto const W = spins<D>();
  for (int i = 0; i < steps; ++i) {
    double const t = two_pi * i / steps;
    // x(t) = Rn(an) .. R1(a1) (B - its centroid) + centroid of A + shift(t); angles and shifts are harmonics of t
    Corners<D> x = turned, rate;
    for (auto& r : rate) r.setZero();
    for (std::size_t k = 0; k < W.size(); ++k) {
      double const angle = 0.7 * std::sin((k + 1) * t + k), speed = 0.7 * (k + 1) * std::cos((k + 1) * t + k);
      Mat<double, D> const R = rotation<D>(W[k], angle);
      for (int a = 0; a <= D; ++a) {
        x[a] = R * x[a];
        rate[a] = R * rate[a] + speed * (W[k] * x[a]);
      }
    }
    for (int a = 0; a <= D; ++a)
      for (int c = 0; c < D; ++c) {
        x[a][c] += target[c] + 0.5 * std::sin((c % 2 + 1) * t + c);
        rate[a][c] += 0.5 * (c % 2 + 1) * std::cos((c % 2 + 1) * t + c);
        rig.u[(D + 1 + a) * D + c] = x[a][c] - B[a][c];
      }
    rig.touch();
    double power = 0;
    for (int a = 0; a <= D; ++a) power += rig.at(D + 1 + a).dot(rate[a]);
    work += power * two_pi / steps;
    size += std::abs(power) * two_pi / steps;
  }
  EXPECT_GT(size, 1e-4);
  return std::abs(work) / size;
}

TYPED_TEST(Contact, MakesNoWorkOnClosedPathsD2) {
  constexpr int D = TypeParam::value;
  double const coarse = closed_path_work<D>(1 << 9), fine = closed_path_work<D>(1 << 16);
  EXPECT_LT(fine, 1e-10);
  EXPECT_GT(std::log2(coarse / std::max(fine, 1e-16)) / 7, 2.0);  // order of the quadrature: the error is the rule's, not the force's
}

TYPED_TEST(Contact, FaceToFaceHasTheSlopeOfItsPotential) {
  constexpr int D = TypeParam::value;
  // Two mirror images over a face, pressed together by d: p (D+1) d/H from each side.
  Corners<D> A;
  for (auto& x : A) x.setZero();
  for (int a = 1; a < D; ++a) A[a][a - 1] = 1;
  A[D].setConstant(0.2);
  A[D][D - 1] = 0.8;
  Corners<D> B = A;
  for (auto& x : B) x[D - 1] *= -1;
  double const H = 0.8, d = 1e-6, area = D == 2 ? 1.0 : 0.5, p = 2.0, k = 2 * p * (D + 1) / H * area;
  Rig<D> rig({A, B}, {p, 0.0});
  rig.move(0, -d * Vec<double, D>::Unit(D - 1));
  rig.touch();
  EXPECT_NEAR(rig.total(0)[D - 1], k * d, 1e-4 * k * d);
  EXPECT_NEAR(rig.penetration[0], (D + 1) * d / H, 1e-12);
  double sum = 0;
  for (int a = 0; a <= D; ++a) sum += rig.stiffness[a] / 2;
  EXPECT_NEAR(sum, k, 1e-4 * k);
}

TYPED_TEST(Contact, StepBoundsHoldAgainstTheTrueFrequency) {
  constexpr int D = TypeParam::value;
  constexpr int n = 2 * (D + 1) * D;
  Corners<D> A;
  for (auto& x : A) x.setZero();
  for (int a = 1; a <= D; ++a) A[a][a - 1] = 1;
  Corners<D> B = A;  // mirror image over the face opposite to corner 0
  B[0].setConstant(2.0 / D);
  double const H = 1 / std::sqrt(double(D)), p = 5.0, rho = 2.0, mass = rho * volume<D>(A) / (D + 1);
  for (double depth : {1e-5, 0.02, 0.1}) {
    Rig<D> rig({A, B}, {p, 0.0});
    rig.move(1, -depth * Vec<double, D>::Constant(H));
    rig.touch();
    double row = *std::max_element(rig.stiffness.begin(), rig.stiffness.end());
    Eigen::Matrix<double, n, n> K;
    double const h = 1e-7;
    for (int i = 0; i < n; ++i) {
      double const at = rig.u[i];
      Eigen::Map<Eigen::Matrix<double, n, 1> const> f(rig.force.data());
      rig.u[i] = at + h;
      rig.touch();
      Eigen::Matrix<double, n, 1> const plus = f;
      rig.u[i] = at - h;
      rig.touch();
      K.col(i) = -(plus - f) / (2 * h);
      rig.u[i] = at;
    }
    double const omega2 = K.eigenvalues().real().maxCoeff() / mass;
    EXPECT_LT(omega2, kernels::contact_omega_squared<D>(p, rho, H)) << "depth " << depth;
    EXPECT_LT(omega2, 1.0001 * row / mass) << "depth " << depth;
    EXPECT_GT(omega2, depth < 0.1 ? 0.7 * row / mass : 0.0) << "depth " << depth;  // and are not idle where the contact is flat
    this->RecordProperty("ratio_to_row_at_" + std::to_string(depth), std::to_string(omega2 * mass / row));
  }
}

TYPED_TEST(Contact, IsFiniteOnDegenerateElements) {
  constexpr int D = TypeParam::value;
  std::mt19937 rng(5);
  for (int trial = 0; trial < 500; ++trial) {
    Corners<D> A = random_simplex<D>(rng, 1), B = random_simplex<D>(rng, 1);
    double const nan = std::numeric_limits<double>::quiet_NaN();
    switch (trial % 6) {
      case 0: B = A; break;                                                  // coincident
      case 1: B[1] = B[0]; break;                                            // no volume
      case 2: B[D] = (B[0] + B[1]) / 2 + 1e-13 * (B[D] - B[0]); break;       // sliver
      case 3: B[1][0] = nan; break;                                          // no place
      case 4: for (auto& x : B) x = A[0]; break;                             // a point
      case 5: B[0] = A[0], B[1] = A[1]; break;                               // shared edge
    }
    Rig<D> rig({A, B}, {1e9, 0.3});
    rig.speed(1, Vec<double, D>::Constant(3.0));
    rig.touch(1e-3);
    for (double f : rig.force) ASSERT_TRUE(std::isfinite(f)) << "trial " << trial;
    for (double s : rig.spring) ASSERT_TRUE(std::isfinite(s)) << "trial " << trial;
    if (trial % 6 == 1 || trial % 6 == 3 || trial % 6 == 4) {
      EXPECT_EQ(rig.total(0).norm(), 0);
    }
  }
}

TYPED_TEST(Contact, ForcesFallToZeroWhenAPairParts) {
  constexpr int D = TypeParam::value;
  std::mt19937 rng(9);
  Corners<D> const A = random_simplex<D>(rng, 1);
  Rig<D> rig({A, moved<D>(A, Vec<double, D>::Constant(0.05))}, {1e9, 0.3});
  rig.speed(1, Vec<double, D>::Unit(0));
  rig.touch(1e-3);
  ASSERT_GT(rig.total(0).norm(), 0);
  rig.move(1, Vec<double, D>::Constant(5.0));
  rig.touch(1e-3);
  for (double f : rig.force) EXPECT_EQ(f, 0);
  for (double k : rig.stiffness) EXPECT_EQ(k, 0);
  for (double s : rig.spring) EXPECT_EQ(s, 0);
  EXPECT_EQ(rig.penetration[0], 0);
}

TYPED_TEST(Contact, SinglePrecisionAgreesWithDouble) {
  constexpr int D = TypeParam::value;
  std::mt19937 rng(21);
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<Corners<D>> const both{random_simplex<D>(rng, 1), random_simplex<D>(rng, 1)};
    Rig<D> fine(both);
    Rig<D, float> coarse(both);
    fine.touch();
    coarse.touch();
    EXPECT_NEAR((fine.total(0) - coarse.total(0)).norm(), 0, 1e-5);
  }
}

// ------------------------------------------------------------------------------------------------- plates, walls, friction
/// Lowest face flat at height 0, altitude H, area of that face; the apex points up.
template <int D>
Corners<D> standing(double H) {
  Corners<D> s;
  for (auto& x : s) x.setZero();
  for (int a = 1; a < D; ++a) s[a][a == 1 ? 0 : 2] = 1;
  s[D].setConstant(0.3);
  s[D][1] = H;
  return s;
}

/// (D+1) times the integral of min(d/H, other lambdas) over the cut at depth d: p (D+1) d/H of the face to first order.
template <int D>
double cut_potential(double depth, double H) {
  double const s = depth / H, area = D == 2 ? 1.0 : 0.5;
  return (D + 1) * area * (std::pow(1 - s, D) - std::pow(1 - s - D * s, D)) / (D * D);
}

TYPED_TEST(Contact, PlateAndWallPressWithTheSlopeOfThePotential) {
  constexpr int D = TypeParam::value;
  double const H = 0.7, p = 4e9;
  for (double depth : {1e-9, 1e-3, 0.05}) {
    kernels::RigidBox<D, double> plate;
    plate.low.setConstant(-1000);
    plate.high.setConstant(1000);
    plate.high[1] = 0;
    plate.displacement = depth * Vec<double, D>::Unit(1);
    plate.velocity.setZero();
    Rig<D> rig({standing<D>(H)}, {p, 0.0});
    rig.press(plate);
    double const exact = p * cut_potential<D>(depth, H);
    EXPECT_NEAR(rig.total(0)[1], exact, 2e-7 * exact);
    for (int c = 0; c < D; ++c) EXPECT_NEAR(rig.reaction[c], -rig.total(0)[c], 1e-14 * exact);
    EXPECT_NEAR(rig.total(0)[0], 0, 1e-12 * exact);
    EXPECT_NEAR(rig.penetration[0], (D + 1) * depth / H, 2e-7 * (D + 1) * depth / H);

    kernels::HalfSpace<D, double> wall{Vec<double, D>::Unit(1) * depth, Vec<double, D>::Unit(1)};
    wall.point[0] = 1000;
    Rig<D> other({standing<D>(H)}, {p, 0.0});
    other.press(wall);
    EXPECT_NEAR(other.total(0)[1], exact, 2e-7 * exact);
  }
  double const pressure = p * cut_potential<D>(1e-6, H) / (D == 2 ? 1.0 : 0.5);
  EXPECT_NEAR(pressure, p * (D + 1) * 1e-6 / H, 1e-5 * pressure);
}

TYPED_TEST(Contact, PlateAndWallForcesAreGradientsOfThePotentialInside) {
  constexpr int D = TypeParam::value;
  std::mt19937 rng(17);
  std::uniform_real_distribution<double> place(-0.2, 0.6);
  for (int trial = 0; trial < 100; ++trial) {
    Corners<D> const E = random_simplex<D>(rng, 1);
    kernels::RigidBox<D, double> plate;
    plate.displacement.setZero();
    plate.velocity.setZero();
    for (int c = 0; c < D; ++c) plate.low[c] = place(rng), plate.high[c] = plate.low[c] + 0.5;
    double const h = 1e-5;
    auto energy = [&](Vec<double, D> const& by) {
      Corners<D> const s = moved<D>(E, by);
      double sum = 0;
      for (int i = 0; i <= D; ++i) {
        Corners<D> fan = s;
        fan[i].setZero();
        for (auto const& x : s) fan[i] += x / (D + 1);
        std::vector<Corners<D>> parts{fan};
        for (int c = 0; c < D; ++c)
          for (int side : {0, 1}) {
            std::vector<Corners<D>> next;
            for (auto const& part : parts)
              keep_positive<D>(part, [&](Vec<double, D> const& x) { return side ? plate.high[c] - x[c] : x[c] - plate.low[c]; }, next);
            parts = next;
          }
        for (auto const& part : parts)
          for (auto const& x : part) sum += barycentric<D>(fan, i, x) / (D + 1) * volume<D>(part);
      }
      return sum;
    };
    Rig<D> rig({E});
    rig.press(plate);
    for (int c = 0; c < D; ++c) {
      Vec<double, D> const step = Vec<double, D>::Unit(c) * h;
      EXPECT_NEAR(rig.total(0)[c], -(energy(step) - energy(-step)) / (2 * h), 1e-8) << "trial " << trial;
    }
  }
}

TYPED_TEST(Contact, FrictionSticksBelowAndSlidesAboveItsLimit) {
  constexpr int D = TypeParam::value;
  double const H = 0.7, p = 1e9, mu = 0.3, depth = 1e-4, dt = 1e-5, speed = 0.05;
  kernels::HalfSpace<D, double> wall{Vec<double, D>::Unit(1) * depth, Vec<double, D>::Unit(1)};
  Rig<D> rig({standing<D>(H)}, {p, mu});
  Vec<double, D> const along = Vec<double, D>::Unit(0);
  rig.speed(0, along * speed);
  double slid = 0, work = 0, k = 0, normal = 0;
  for (int step = 0; step < 400; ++step) {
    rig.move(0, along * (speed * dt));
    slid += speed * dt;
    rig.press(wall, dt);
    work += rig.work[0];
    normal = rig.total(0)[1];
    k = 0;
    for (double s : rig.stiffness) k += s;
    double const expected = std::min(k * slid, mu * normal);
    EXPECT_NEAR(rig.total(0)[0], -expected, 1e-9 * mu * normal) << "step " << step;
  }
  double const elastic = mu * normal / k;
  EXPECT_GT(slid, 3 * elastic);
  EXPECT_NEAR(work, mu * normal * (slid - elastic), 1e-9 * work);
  rig.speed(0, -along * speed);  // back: the spring unloads before it slides the other way
  rig.press(wall, dt);
  EXPECT_EQ(rig.work[0], 0);
  EXPECT_LT(std::abs(rig.total(0)[0]), mu * normal);
}

TYPED_TEST(Contact, FrictionTakesWhatAClosedPathLosesAndNeverGives) {
  constexpr int D = TypeParam::value;
  // Press and shift an element on a wall around a loop, both ways; the wall's friction may keep energy, never give any.
  double const H = 0.7, p = 1e9, two_pi = 2 * std::acos(-1.0), dt = 1e-6;
  for (double mu : {0.05, 1000.0})  // sliding most of the way, always sticking
    for (double direction : {-1.0, 1.0}) {
      kernels::HalfSpace<D, double> wall{Vec<double, D>::Zero(), Vec<double, D>::Unit(1)};
      Rig<D> rig({standing<D>(H)}, {p, mu});
      auto place = [&](double t) {
        Vec<double, D> x = Vec<double, D>::Zero();
        x[0] = 1e-3 * std::sin(direction * t);
        x[1] = -2e-3 - 3e-3 * std::cos(t);  // leaves the wall, and presses it to 7/10 % of the altitude
        return x;
      };
      int const steps = 20000;
      double lost = 0, booked = 0;
      rig.move(0, place(two_pi / 2));
      Vec<double, D> before = Vec<double, D>::Zero();
      for (int i = 1; i <= steps; ++i) {
        double const t = two_pi / 2 + two_pi * i / steps, t0 = two_pi / 2 + two_pi * (i - 1) / steps;
        Vec<double, D> const step = place(t) - place(t0);
        rig.move(0, step);
        rig.speed(0, step / dt);
        rig.press(wall, dt);
        lost -= (rig.total(0) + before).dot(step) / 2;
        before = rig.total(0);
        booked += rig.work[0];
      }
      EXPECT_GT(booked, 0);
      EXPECT_NEAR(lost, booked, 2e-3 * booked) << "mu " << mu << " direction " << direction;
    }
}

TYPED_TEST(Contact, BouncesObliquelyWithoutLossD2) {
  constexpr int D = TypeParam::value;
  // Two elements that move without turning: what they have after the bounce is what they had, to the order of the step.
  std::mt19937 rng(31);
  double change[2];
  for (int refinement : {0, 1}) {
    rng.seed(31);
    change[refinement] = 0;
    for (int trial = 0; trial < 5; ++trial) {
      Corners<D> const A = random_simplex<D>(rng, 1), B = moved<D>(random_simplex<D>(rng, 1), 2 * Vec<double, D>::Unit(0));
      double const mass = 1.0, dt = refinement ? 2e-4 : 1e-3;
      Rig<D> rig({A, B}, {2e2, 0.0});
      Vec<double, D> v[2] = {Vec<double, D>::Unit(0), Vec<double, D>::Zero()};
      v[1][1] = 0.02 * trial;
      double const energy = v[0].squaredNorm() + v[1].squaredNorm();
      Vec<double, D> const momentum = v[0] + v[1];
      bool touched = false;
      for (int step = 0; step < 5 / dt; ++step) {
        rig.touch();
        touched = touched || rig.penetration[0] > 0;
        for (int side : {0, 1}) {
          v[side] += dt * rig.total(side) / mass;
          rig.move(side, dt * v[side]);
        }
      }
      EXPECT_EQ(rig.penetration[0], 0);
      EXPECT_TRUE(touched);
      EXPECT_NEAR((v[0] + v[1] - momentum).norm(), 0, 1e-12);
      change[refinement] = std::max(change[refinement], std::abs((v[0].squaredNorm() + v[1].squaredNorm()) / energy - 1));
    }
  }
  EXPECT_LT(change[0], 1e-3);
  EXPECT_LT(change[1], 0.3 * change[0]);
}

TYPED_TEST(Contact, FrictionBetweenElementsIsEqualAndOpposite) {
  constexpr int D = TypeParam::value;
  Corners<D> const A = standing<D>(0.7);
  Corners<D> B = A;
  for (auto& x : B) x[1] *= -1;
  double const mu = 0.25, dt = 1e-4;
  Rig<D> rig({A, B}, {1e9, mu});
  rig.move(1, 1e-5 * Vec<double, D>::Unit(1));
  rig.speed(0, Vec<double, D>::Unit(0));
  rig.touch(dt);
  EXPECT_NEAR(rig.total(0)[0], -mu * rig.total(0)[1], 1e-3 * rig.total(0)[1]);
  EXPECT_NEAR((rig.total(0) + rig.total(1)).norm(), 0, 1e-12 * rig.total(0).norm());
  EXPECT_GT(rig.work[0], 0);
}

/// A rigid element on a wall that turns into an incline; returns how far it went after `steps` and in the last tenth.
template <int D>
std::pair<double, double> slide(double mu, double slope, double dt, int steps) {
  double const H = 0.7, p = 1e9, g = 9.81, mass = 100;
  kernels::HalfSpace<D, double> wall{Vec<double, D>::Zero(), Vec<double, D>::Unit(1)};
  double low = 0, high = 0.1;  // the depth at which the wall carries the weight
  for (int i = 0; i < 60; ++i) (p * cut_potential<D>((low + high) / 2, H) < mass * g * std::cos(slope) ? low : high) = (low + high) / 2;
  Rig<D> rig({standing<D>(H)}, {p, mu});
  rig.move(0, -low * Vec<double, D>::Unit(1));
  Vec<double, D> v = Vec<double, D>::Zero(), x = v;
  double last = 0;
  for (int step = 0; step < steps; ++step) {
    if (step == steps - steps / 10) last = x[0];
    rig.press(wall, dt);
    Vec<double, D> pull = Vec<double, D>::Zero();
    pull[0] = mass * g * std::sin(slope);
    pull[1] = -mass * g * std::cos(slope);
    v += dt * (rig.total(0) + pull) / mass;
    x += dt * v;
    rig.speed(0, v);
    rig.move(0, dt * v);
  }
  return {x[0], x[0] - last};
}

TYPED_TEST(Contact, RestsBelowTheFrictionAngleAndSlidesAboveD4) {
  constexpr int D = TypeParam::value;
  double const slope = std::acos(-1.0) / 6;
  auto const [moved, crept] = slide<D>(0.7, slope, 1e-5, 100000);
  EXPECT_LT(std::abs(moved), 1e-6);       // the spring's stretch
  EXPECT_LT(std::abs(crept), 1e-6);
  auto const [longer, still] = slide<D>(0.7, slope, 1e-5, 300000);
  EXPECT_LT(std::abs(longer), 1e-6);      // three times as long: no further
  EXPECT_LT(std::abs(still), 1e-6);
  EXPECT_NEAR(slide<D>(0.0, slope, 1e-5, 100000).first, 2.4525, 1e-3);
  EXPECT_NEAR(slide<D>(0.3, slope, 1e-5, 100000).first, 1.17814, 2e-3);
  EXPECT_NEAR(slide<D>(0.5, slope, 1e-5, 100000).first, 0.32857, 2e-3);
}

// --------------------------------------------------------------------------------------------------------------- gathering
TYPED_TEST(Contact, VerticesSumTheirSlotsInOrder) {
  constexpr int D = TypeParam::value;
  std::vector<Index> const vertex_of_slot{4, 1, 4, 4, 1, 0};
  auto const lists = solver::slot_lists(vertex_of_slot, 6);
  EXPECT_EQ(lists.vertex, (std::vector<Index>{0, 1, 4}));
  EXPECT_EQ(lists.first, (std::vector<Index>{0, 1, 3, 6}));
  EXPECT_EQ(lists.slot, (std::vector<Index>{5, 1, 4, 0, 2, 3}));
  std::vector<double> force(6 * D), stiffness(6), f(8 * D, 1.0), k(6);
  for (int s = 0; s < 6; ++s) {
    stiffness[s] = s + 1;
    for (int c = 0; c < D; ++c) force[s * D + c] = std::pow(10, s) * (c + 1);
  }
  std::vector<Index> const first_corner{7, 6, 5, 4, 3, 2};
  for (Index t = 0; t < 3; ++t)
    kernels::GatherContact<D, double>{lists.vertex.data(), lists.first.data(), lists.slot.data(), first_corner.data(),
                                      force.data(), stiffness.data(), f.data(), k.data()}(t);
  for (int c = 0; c < D; ++c) {
    EXPECT_EQ(f[7 * D + c], 1 + 100000 * (c + 1));
    EXPECT_EQ(f[6 * D + c], 1 + 10010 * (c + 1));
    EXPECT_EQ(f[3 * D + c], 1 + 1101 * (c + 1));
    EXPECT_EQ(f[4 * D + c], 1);
  }
  EXPECT_EQ(k, (std::vector<double>{6, 7, 0, 0, 8, 0}));
}

TYPED_TEST(Contact, SpringsFollowTheirPairs) {
  constexpr int D = TypeParam::value;
  std::vector<solver::ElementPair> const before{{0, 3}, {1, 2}, {5, 9}}, after{{0, 2}, {0, 3}, {4, 5}, {5, 9}};
  std::vector<double> springs;
  for (int i = 0; i < 3 * D; ++i) springs.push_back(i + 1);
  auto const carried = solver::carry_springs(D, before, springs, after);
  for (int c = 0; c < D; ++c) {
    EXPECT_EQ(carried[c], 0);
    EXPECT_EQ(carried[D + c], springs[c]);
    EXPECT_EQ(carried[2 * D + c], 0);
    EXPECT_EQ(carried[3 * D + c], springs[2 * D + c]);
  }
}

TYPED_TEST(Contact, ACommonTranslationIsNoDrift) {
  constexpr int D = TypeParam::value;
  std::vector<double> before(4 * D, 0.0), now(4 * D, 7.0);
  EXPECT_EQ(solver::drift<D>(now.data(), before.data(), 4).spread(), 0);
  now[D] += 0.25;
  now[2 * D] -= 0.5;
  EXPECT_EQ(solver::drift<D>(now.data(), before.data(), 4).spread(), 0.75);
  EXPECT_EQ(solver::Drift<D>().spread(), 0);
}

// ------------------------------------------------------------------------------------------------------------- pair search
template <int D>
using Boxes = std::vector<solver::Bounds<D>>;

template <int D>
solver::Bounds<D> box(std::array<double, D> const& center, double half) {
  solver::Bounds<D> b;
  for (int c = 0; c < D; ++c) b.low[c] = center[c] - half, b.high[c] = center[c] + half;
  return b;
}

template <int D>
std::vector<solver::ElementPair> brute_force(Boxes<D> const& boxes) {
  std::vector<solver::ElementPair> pairs;
  for (Index p = 0; p < static_cast<Index>(boxes.size()); ++p)
    for (Index q = p + 1; q < static_cast<Index>(boxes.size()); ++q) {
      bool meet = true;
      for (int c = 0; c < D; ++c) meet = meet && boxes[p].low[c] <= boxes[q].high[c] && boxes[q].low[c] <= boxes[p].high[c];
      if (meet) pairs.push_back({p, q});
    }
  return pairs;
}

/// n boxes at random in a cube of side `space`; half sizes from `least` to `most`, evenly over orders of magnitude.
template <int D>
Boxes<D> cloud(int n, double space, double least, double most, unsigned seed = 1) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  Boxes<D> boxes;
  for (int i = 0; i < n; ++i) {
    std::array<double, D> center;
    for (double& x : center) x = space * unit(rng);
    boxes.push_back(box<D>(center, least * std::pow(most / least, unit(rng))));
  }
  return boxes;
}

TYPED_TEST(Contact, SearchAgreesWithBruteForceD6) {
  constexpr int D = TypeParam::value;
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<std::pair<std::string, Boxes<D>>> cases;
  cases.emplace_back("even sizes", cloud<D>(2000, 10, 0.2, 0.3));
  cases.emplace_back("size ratio 1000", cloud<D>(2000, 10, 0.002, 2));
  cases.emplace_back("all in one cell", cloud<D>(400, 1e-6, 1, 1.001));
  cases.emplace_back("far flung", cloud<D>(1000, 1e15, 0.2, 0.3));
  cases.emplace_back("coincident", Boxes<D>(200, box<D>({}, 1)));
  cases.emplace_back("touching on a grid", Boxes<D>{});
  for (int i = 0; i < 1000; ++i) {
    std::array<double, D> center{};
    for (int c = 0, k = i; c < D; ++c, k /= 10) center[c] = k % 10;
    cases.back().second.push_back(box<D>(center, 0.5));
  }
  cases.emplace_back("nested", Boxes<D>{});
  for (int i = 0; i < 60; ++i) cases.back().second.push_back(box<D>({}, std::pow(2.0, -i)));
  cases.emplace_back("slivers", cloud<D>(1000, 10, 0.001, 0.002));
  for (auto& b : cases.back().second) b.high[std::abs(static_cast<int>(100 * b.low[0])) % D] += 3 * std::abs(unit(rng));
  cases.emplace_back("flat and points", cloud<D>(500, 3, 0.1, 0.2));
  for (std::size_t i = 0; i < 500; ++i) {
    auto& b = cases.back().second[i];
    if (i % 2) b.high[0] = b.low[0];
    if (i % 4 == 3) b.high = b.low;
  }
  cases.emplace_back("fragments around a far origin", cloud<D>(1000, 10, 0.1, 1));
  for (auto& b : cases.back().second)
    for (int c = 0; c < D; ++c) b.low[c] += 1e6, b.high[c] += 1e6;
  cases.emplace_back("beyond any cell number", cloud<D>(50, 1e300, 1e-3, 1e-3));
  cases.emplace_back("one giant among crumbs", cloud<D>(2000, 10, 0.01, 0.02));
  cases.back().second.push_back(box<D>({}, 1e4));
  cases.emplace_back("none", Boxes<D>{});
  cases.emplace_back("one", Boxes<D>{box<D>({}, 1)});
  for (auto const& [name, boxes] : cases) EXPECT_EQ(solver::overlapping_pairs<D>(boxes), brute_force<D>(boxes)) << name;
}

/// n boxes of which each octave of sizes fills the space about as much as any other.
template <int D>
Boxes<D> graded_cloud(int n, double ratio) {
  std::mt19937 rng(4);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<double> half;
  double filled = 0;
  for (int i = 0; i < n; ++i) {
    half.push_back(std::pow(1 + unit(rng) * (std::pow(ratio, -D) - 1), -1.0 / D));
    filled += std::pow(2 * half.back(), D);
  }
  Boxes<D> boxes;
  for (double h : half) {
    std::array<double, D> center;
    for (double& x : center) x = std::pow(filled, 1.0 / D) * unit(rng);
    boxes.push_back(box<D>(center, h));
  }
  return boxes;
}

TYPED_TEST(Contact, SearchIsLinearAtAnyRatioOfSizes) {
  constexpr int D = TypeParam::value;
  for (double ratio : {1.0, 10.0, 1000.0}) {
    double each[2], found[2];
    int const n[2] = {4000, 64000};
    for (int i : {0, 1}) {
      solver::SearchCost cost;
      auto const pairs = solver::overlapping_pairs<D>(graded_cloud<D>(n[i], ratio), 1.5, &cost);
      EXPECT_LE(cost.entries, (1LL << D) * n[i]);
      each[i] = double(cost.comparisons) / n[i];
      found[i] = double(pairs.size()) / n[i];
    }
    EXPECT_LT(each[1], 1.2 * each[0] + (D == 2 ? 10 : 50)) << "ratio " << ratio;  // more boxes bring the rare large ones
    EXPECT_LT(each[1], 12 * found[1]) << "ratio " << ratio;
    this->RecordProperty("comparisons_and_pairs_per_box_ratio_" + std::to_string(static_cast<int>(ratio)),
                         std::to_string(each[0]) + " " + std::to_string(found[0]) + ", " + std::to_string(each[1]) + " " +
                             std::to_string(found[1]));
  }
}

TYPED_TEST(Contact, SearchRefusesBoxesWithoutAPlace) {
  constexpr int D = TypeParam::value;
  auto boxes = cloud<D>(5, 10, 1, 1);
  boxes[3].low[0] = std::numeric_limits<double>::quiet_NaN();
  try {
    solver::overlapping_pairs<D>(boxes);
    FAIL() << "a box that is not a number was accepted";
  } catch (Error const& error) {
    EXPECT_STREQ(error.what(),
                 "contact search: box 3 of 5 is not finite (its nodes have no place any more: the run has become unstable); "
                 "use a smaller time step or a smaller contact penalty");
  }
}

TYPED_TEST(Contact, RigidBodiesFindTheirElements) {
  constexpr int D = TypeParam::value;
  Boxes<D> const boxes{box<D>({0, 0}, 1), box<D>({0, 5}, 1), box<D>({9, 0}, 1)};
  using Pairs = std::vector<solver::ElementPair>;
  EXPECT_EQ((solver::pairs_with_boxes<D>(boxes, {box<D>({0, 3}, 1), box<D>({10, 0}, 1)})), (Pairs{{1, 0}, {2, 1}}));
  Vec<double, D> const up = Vec<double, D>::Unit(1);
  EXPECT_EQ((solver::pairs_with_planes<D>(boxes, {up * -1.5, up * -1.5}, {up, -up}, 0.0)), (Pairs{{0, 1}, {1, 1}, {2, 1}}));
  EXPECT_EQ((solver::pairs_with_planes<D>(boxes, {up * -1.5}, {up}, 0.6)), (Pairs{{0, 0}, {2, 0}}));
}

}  // namespace
}  // namespace fissure
