// Contact of elements: forces against the gradient of an independently computed energy, momentum, closed paths.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "contact_rig.h"

namespace fissure {
namespace {

using namespace contact_test;

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

/// What is remembered of a pair (the axis along which it was apart, that it touched) saves work and changes no bit; and
/// the axis that is remembered shows the gap.
TYPED_TEST(Contact, RemembersWhatPartedAPairAndChangesNoBit) {
  constexpr int D = TypeParam::value;
  std::mt19937 rng(5);
  std::normal_distribution<double> step(0, 0.05);
  int touching = 0, apart = 0, by_edges = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Rig<D> remembers({random_simplex<D>(rng, 1), random_simplex<D>(rng, 1)}, {1e9, 0});
    for (int move = 0; move < 40; ++move) {
      Vec<double, D> by;
      for (int c = 0; c < D; ++c) by[c] = step(rng);
      remembers.move(1, by);
      Rig<D> fresh = remembers;
      fresh.axis = kernels::no_axis, fresh.penetration[0] = 0;
      std::fill(fresh.force.begin(), fresh.force.end(), 0);
      std::fill(fresh.stiffness.begin(), fresh.stiffness.end(), 0);
      remembers.touch();
      fresh.touch();
      ASSERT_EQ(remembers.force, fresh.force);
      ASSERT_EQ(remembers.stiffness, fresh.stiffness);
      touching += fresh.penetration[0] > 0;
      if (fresh.axis == kernels::no_axis) continue;
      kernels::Simplex<D, double> a, b;
      a.place(fresh.mesh(), 0, Vec<double, D>::Zero(), Vec<double, D>::Zero());
      b.place(fresh.mesh(), 1, Vec<double, D>::Zero(), Vec<double, D>::Zero());
      EXPECT_GT(gap_along(kernels::axis_between<D, double>(a.x, b.x, fresh.axis), a.x, b.x), 0) << int(fresh.axis);
      ++apart;
      by_edges += fresh.axis >= 3 * D + 2;
    }
  }
  EXPECT_GT(touching, 1000);
  EXPECT_GT(apart, 1000);
  EXPECT_EQ(by_edges > 20, D == 3) << by_edges;
}

/// A triangle and a tetrahedron are apart where a face's plane shows it, or the triangle's own, or an edge of each:
/// a face that passes an edge has nothing inside, and what passes no edge and no plane has. On a grid corners lie in
/// planes and on edges of the other.
TEST(PassEdges, TellsFacesThatMissASimplexFromThoseThatMeetIt) {
  std::mt19937 rng(7);
  auto const heights = [](Corners<3> const& of, Corners<3> const& in) {
    Mat<double, 3> edges;
    for (int a = 1; a < 4; ++a) edges.col(a - 1) = in[a] - in[0];
    Mat<double, 4> height;
    for (int v = 0; v < 4; ++v) {
      Vec<double, 3> const inner = edges.inverse() * (of[v] - in[0]);
      height.col(v) << 1 - inner.sum(), inner;
    }
    return height;
  };
  int passed = 0, met = 0;
  for (int trial = 0; trial < 10000; ++trial) {
    bool const on_grid = trial % 2 == 1;
    Corners<3> const one = random_simplex<3>(rng, 1, on_grid), other = random_simplex<3>(rng, 1, on_grid);
    Mat<double, 4> const height = heights(one, other), back = heights(other, one);
    bool reaches[4] = {true, true, true, true};
    Clip<3>::pass_edges(height, reaches);
    for (int i = 0; i < 4; ++i) {
      auto const at = [&](int j, int k) { return height(j, (i + 1 + k) % 4); };
      double const first[3] = {at(0, 0), at(0, 1), at(0, 2)};
      auto patch = Clip<3>::simplex_patch<double>(first);
      Clip<3>::keep_positive(patch);
      bool apart = back.row(i).minCoeff() > 0 || back.row(i).maxCoeff() < 0;
      for (int j = 0; j < 4; ++j) {
        double const above[3] = {at(j, 0), at(j, 1), at(j, 2)};
        apart = apart || std::max({above[0], above[1], above[2]}) < 0;
        if (j > 0) Clip<3>::cut(patch, above);
      }
      auto const part = Clip<3>::integrate(patch);
      double const area = part.share[0] + part.share[1] + part.share[2];  // of the face, 1/2 as a whole
      if (!reaches[i]) {
        ++passed;
        ASSERT_LT(std::abs(area), 1e-12) << trial;
      } else if (!apart && !on_grid) {
        ++met;
        ASSERT_GT(area, 0) << trial;
      }
    }
  }
  EXPECT_GT(passed, 2000);
  EXPECT_GT(met, 1000);
}

TEST(EdgeGap, HasItsDigitsInSinglePrecisionAtAnySize) {
  std::mt19937 rng(9);
  for (double size : {1.0, 1e-4, 1e-8})
    for (int trial = 0; trial < 200; ++trial) {
      Corners<3> const A = random_simplex<3>(rng, 1), B = random_simplex<3>(rng, 1);
      Vec<double, 3> a[4], b[4];
      Vec<float, 3> small_a[4], small_b[4];
      for (int k = 0; k < 4; ++k) {
        a[k] = A[k], b[k] = B[k];
        small_a[k] = (size * A[k]).cast<float>(), small_b[k] = (size * B[k]).cast<float>();
      }
      double pair = 0;
      float same = 0;
      double const gap = Clip<3>::edge_gap(a, b, pair);
      EXPECT_NEAR(Clip<3>::edge_gap(small_a, small_b, same) / size, gap, 1e-3) << size;
    }
}

/// Force and moment on B are minus the gradient of p * energy in B's rigid motions. Corners on a coarse grid make
/// coplanar faces, shared corners and faces in the planes of a fan the rule.
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
    EXPECT_NEAR(rig.held, p * overlap_energy<D>(A, B), 1e-11) << "trial " << trial;
    for (int c = 0; c < D; ++c) {
      Vec<double, D> const step = Vec<double, D>::Unit(c) * h;
      double const slope =
          p * (overlap_energy<D>(A, moved<D>(B, step)) - overlap_energy<D>(A, moved<D>(B, -step))) / (2 * h);
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
TYPED_TEST(Contact, ForceIsTheGradientWhereFacesAndFansCoincide) {
  compare_with_gradient<TypeParam::value>(true, 2e-4);
}

/// A pair that overlaps when it becomes a candidate begins without force, and from there on with the potential above
/// what it was largest then: that of simplices smaller by as much. Once apart it forgets.
TYPED_TEST(Contact, WhatOverlapsAlreadyBeginsWithoutForce) {
  constexpr int D = TypeParam::value;
  std::mt19937 rng(13);
  auto const shrunk = [](Corners<D> s, double o) {
    Vec<double, D> center = Vec<double, D>::Zero();
    for (auto const& x : s) center += x / (D + 1);
    for (auto& x : s) x = center + (x - center) * (1 - o);
    return s;
  };
  int pressing = 0;
  for (int trial = 0; trial < 6000; ++trial) {
    Corners<D> const A = random_simplex<D>(rng, 1), B = random_simplex<D>(rng, 1);
    if (std::min(volume<D>(A), volume<D>(B)) < 0.02) continue;  // the oracle cuts them into pieces that it can see
    Rig<D> rig({A, B}, {3, 0});
    double& begins = rig.spring.back();
    begins = -1;
    rig.touch();
    double const o = begins;
    EXPECT_EQ(rig.total(1).norm(), 0);
    EXPECT_EQ(rig.penetration[0], 0);
    EXPECT_GE(o, 0);
    if (!(o > 0) || o > 0.5) continue;
    Vec<double, D> direction = Vec<double, D>::Zero();  // the centroids approach
    for (int a = 0; a <= D; ++a) direction += (A[a] - B[a]) / (D + 1);
    rig.move(1, 0.2 * direction);
    rig.touch();
    auto const energy = [&](Corners<D> const& b) {
      return 3 * (1 - o) * (overlap_energy<D>(A, shrunk(b, o), 0, 1) + overlap_energy<D>(shrunk(A, o), b, 1, 0));
    };
    Corners<D> const near = moved<D>(B, 0.2 * direction);
    EXPECT_EQ(begins, o);
    // Of one that lies inside the other, shrunk, nothing pushes: its energy, whatever it is, is not asked for.
    if (rig.penetration[0] > 0) {
      EXPECT_NEAR(rig.held, energy(near), 1e-11);
    }
    double const h = 1e-5;
    for (int c = 0; c < D; ++c) {
      Vec<double, D> const step = Vec<double, D>::Unit(c) * h;
      double const slope = (energy(moved<D>(near, step)) - energy(moved<D>(near, -step))) / (2 * h);
      EXPECT_NEAR(rig.total(1)[c], -slope, 5e-7) << "trial " << trial;  // a slope may jump within the step: h of it
    }
    pressing += rig.penetration[0] > 0;
    rig.move(1, Vec<double, D>::Constant(10));
    rig.touch(), rig.touch();
    EXPECT_EQ(begins, 0);
  }
  EXPECT_GT(pressing, 100);
}

/// Pairs in the lanes of packs have the bits that each has alone, whichever others are in the pack.
TYPED_TEST(Contact, PacksOfPairsHaveTheBitsOfEachAlone) {
  constexpr int D = TypeParam::value, pairs = 150;
  std::mt19937 rng(17);
  std::vector<Corners<D>> elements;
  for (int i = 0; i < 2 * pairs; ++i) elements.push_back(random_simplex<D>(rng, 1, i % 5 == 0));
  Rig<D> one(elements, {1e9, 0.3}), packs = one;
  std::vector<Index> list(2 * pairs);
  std::iota(list.begin(), list.end(), 0);
  auto const press = [&](Rig<D>& rig, auto lane) {
    using S = decltype(lane);
    rig.spring.assign(pairs * kernels::spring_size<D>, 0);
    for (int i = 0; i < pairs; ++i)
      rig.spring[(i + 1) * kernels::spring_size<D> - 1] = i % 3 == 0 ? -1 : 0.01 * (i % 7);
    rig.force.assign(pairs * 2 * (D + 1) * D, 0);
    rig.stiffness.assign(pairs * 2 * (D + 1), 0);
    rig.weight = rig.stiffness;
    rig.work.assign(pairs, 0);
    rig.penetration = rig.work;
    std::vector<double> wake(pairs, 0), held(pairs, 0);
    std::vector<std::uint8_t> axis(pairs, kernels::no_axis);
    kernels::PairForces<D, double> const kernel{rig.mesh(),
                                                {rig.law.data(), &rig.contact, 1},
                                                pairs,
                                                list.data(),
                                                rig.spring.data(),
                                                rig.force.data(),
                                                rig.stiffness.data(),
                                                rig.weight.data(),
                                                rig.work.data(),
                                                rig.penetration.data(),
                                                0,
                                                wake.data(),
                                                axis.data(),
                                                held.data()};
    for (Index i = 0; i < pairs; i += decltype(kernel)::template block<S>) kernel.template operator()<S>(i);
    return std::pair(wake, held);
  };
  EXPECT_EQ(press(one, 0.0), press(packs, Pack<double>(0)));
  EXPECT_EQ(one.force, packs.force);
  EXPECT_EQ(one.stiffness, packs.stiffness);
  EXPECT_EQ(one.weight, packs.weight);
  EXPECT_EQ(one.penetration, packs.penetration);
  EXPECT_EQ(one.spring, packs.spring);
  EXPECT_GT(std::count_if(one.penetration.begin(), one.penetration.end(), [](double p) { return p > 0; }), pairs / 10);
}

/// Corners in each other's planes but for rounding: forces are continuous, so 1e-13 of an edge changes next to nothing.
/// Once a cut of such a polygon dropped a part of it, or counted one twice: up to 40 % of a force.
TYPED_TEST(Contact, RoundingOfPlacesIsNoForce) {
  constexpr int D = TypeParam::value;
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> noise(-1e-13, 1e-13);
  int touching = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    Corners<D> A = random_simplex<D>(rng, 1, true), B = random_simplex<D>(rng, 1, true);
    for (int shared = trial % (D + 1), k = 0; k < shared; ++k) B[k] = A[k];
    if (volume<D>(B) < 0.01) continue;
    Rig<D> exact({A, B}, {1, 0});
    exact.touch();
    for (auto* corners : {&A, &B})
      for (auto& x : *corners)
        for (int c = 0; c < D; ++c) x[c] += noise(rng);
    Rig<D> shaken({A, B}, {1, 0});
    shaken.touch();
    touching += exact.penetration[0] > 0;
    for (int side : {0, 1})
      for (int c = 0; c < D; ++c) ASSERT_NEAR(shaken.total(side)[c], exact.total(side)[c], 1e-9) << "trial " << trial;
  }
  EXPECT_GT(touching, 1000);
}

/// Relative work of A on B along a closed path that shifts and turns B through A and out of it, by the trapezoidal
/// rule.
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
  EXPECT_GT(std::log2(coarse / std::max(fine, 1e-16)) / 7,
            2.0);  // order of the quadrature: the error is the rule's, not the force's
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
    // A bed of springs below either face: 2 k on D corners, k = (D+1) p/H of each of both elements.
    EXPECT_LT(omega2, 4 * (D + 1) * (D + 1) * p / (rho * H * H)) << "depth " << depth;
    EXPECT_LT(omega2, 1.0001 * row / mass) << "depth " << depth;
    EXPECT_GT(omega2, depth < 0.1 ? 0.7 * row / mass : 0.0)
        << "depth " << depth;  // and are not idle where the contact is flat
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
      case 0:
        B = A;
        break;  // coincident
      case 1:
        B[1] = B[0];
        break;  // no volume
      case 2:
        B[D] = (B[0] + B[1]) / 2 + 1e-13 * (B[D] - B[0]);
        break;  // sliver
      case 3:
        B[1][0] = nan;
        break;  // no place
      case 4:
        for (auto& x : B) x = A[0];
        break;  // a point
      case 5:
        B[0] = A[0], B[1] = A[1];
        break;  // shared edge
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

TYPED_TEST(Contact, ForgetsItsSpringWhenItPartsAsItsSlotsAreMadeAgain) {
  constexpr int D = TypeParam::value;
  std::mt19937 rng(9);
  Corners<D> const A = random_simplex<D>(rng, 1);
  Rig<D> rig({A, moved<D>(A, Vec<double, D>::Constant(0.05))}, {1e9, 0.3});
  rig.speed(1, Vec<double, D>::Unit(0));
  rig.touch(1e-3);
  ASSERT_GT(rig.spring[D], 0);
  double held = 0;
  for (int c = 0; c < D; ++c) held += rig.spring[D] * rig.spring[c] * rig.spring[c] / 2;
  rig.penetration[0] = rig.work[0] = 0;
  rig.speed(1, Vec<double, D>::Zero());
  rig.move(1, Vec<double, D>::Constant(5.0));
  rig.touch(1e-3);
  EXPECT_NEAR(rig.work[0], held, 1e-12 * held);
  for (double s : rig.spring) EXPECT_EQ(s, 0);
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

TYPED_TEST(Contact, BouncesObliquelyWithoutLossD2) {
  constexpr int D = TypeParam::value;
  // Two elements that move without turning: what they have after the bounce is what they had, to the order of the step.
  std::mt19937 rng(31);
  double change[2];
  for (int refinement : {0, 1}) {
    rng.seed(31);
    change[refinement] = 0;
    for (int trial = 0; trial < 5; ++trial) {
      Corners<D> const A = random_simplex<D>(rng, 1),
                       B = moved<D>(random_simplex<D>(rng, 1), 2 * Vec<double, D>::Unit(0));
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
      change[refinement] =
          std::max(change[refinement], std::abs((v[0].squaredNorm() + v[1].squaredNorm()) / energy - 1));
    }
  }
  EXPECT_LT(change[0], 1e-3);
  EXPECT_LT(change[1], 0.3 * change[0]);
}

}  // namespace
}  // namespace fissure
