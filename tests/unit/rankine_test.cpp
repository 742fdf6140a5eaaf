// Rankine's criterion: principal directions, and which elements are near to it.
#include "kernels/rankine.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "../../src2d/dim.h"
#include "../../src3d/dim.h"

namespace fissure::kernels {
namespace {

template <class T>
struct Rankine : ::testing::Test {};
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(Rankine, Dimensions);

template <int D>
Mat<double, D> some_stress(std::mt19937& random) {
  std::uniform_real_distribution<double> any(-1, 1);
  Mat<double, D> s;
  for (int i = 0; i < D; ++i)
    for (int k = 0; k <= i; ++k) s(i, k) = s(k, i) = any(random);
  return s;
}

/// Of random stresses, and of those that are diagonal, isotropic, or nearly.
TYPED_TEST(Rankine, FindsPrincipalDirections) {
  constexpr int D = TypeParam::value;
  std::mt19937 random(7);
  for (int trial = 0; trial < 2000; ++trial) {
    Mat<double, D> s = some_stress<D>(random), ways;
    if (trial % 4 == 1) s = Mat<double, D>(s.diagonal().asDiagonal());
    if (trial % 4 == 2) s = Mat<double, D>(Mat<double, D>::Identity() + 1e-12 * s);
    Mat<double, D> d = s;
    diagonalize<D, double>(d, ways);
    EXPECT_LT((ways.transpose() * ways - Mat<double, D>::Identity()).norm(), 1e-14);
    EXPECT_LT((ways * d.diagonal().asDiagonal() * ways.transpose() - s).norm(), 1e-14);
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, D, D>> const exact(s);
    EXPECT_NEAR(d.diagonal().maxCoeff(), exact.eigenvalues()[D - 1], 1e-14);
  }
  Mat<double, D> nothing = Mat<double, D>::Zero(), ways;
  diagonalize<D, double>(nothing, ways);
  EXPECT_EQ(nothing.norm(), 0);
}

TYPED_TEST(Rankine, MarksWhatReachesALevel) {
  constexpr int D = TypeParam::value;
  std::mt19937 random(8);
  int marked = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    Mat<double, D> const s = some_stress<D>(random);
    double stress[6] = {};
    for (int n = 0; n < 6; ++n)
      if (tensor_row(n) < D && tensor_column(n) < D) stress[n] = s(tensor_row(n), tensor_column(n));
    double const largest = Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, D, D>>(s).eigenvalues()[D - 1];
    std::uint8_t reached = 2;
    Sums<1> count{0.0};
    StressedElements<D, double>{stress, &reached, 0.5}.template operator()<double>(0, count);
    if (std::abs(largest - 0.5) < 1e-12) continue;
    EXPECT_EQ(reached, largest > 0.5);
    EXPECT_EQ(count[0], reached);
    marked += reached;
  }
  EXPECT_GT(marked, 500);
}

}  // namespace
}  // namespace fissure::kernels
