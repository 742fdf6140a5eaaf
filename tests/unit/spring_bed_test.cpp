// Beds of springs that stand for contact in the time step: stiffness, bounds, checkpoint.
#include "contact/spring_bed.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

namespace fissure {
namespace {

/// Two triangles of a square in the plane z = 0, pressed along z.
SpringBeds<3> square() {
  SpringBeds<3> beds;
  for (auto const& vertex : {std::array<Index, 3>{0, 1, 2}, {0, 2, 3}}) {
    SpringBed<3> bed;
    bed.vertex = vertex, bed.normal = {0, 0, 1}, bed.stiffness = 6, bed.pressed = 5;
    beds.faces.push_back(bed);
  }
  return beds;
}

Eigen::MatrixXd matrix(SpringBeds<3> const& beds, int vertices) {
  Eigen::MatrixXd K(3 * vertices, 3 * vertices);
  for (int i = 0; i < 3 * vertices; ++i) {
    std::vector<double> x(3 * vertices, 0), y(3 * vertices, 0);
    x[i] = 1;
    beds.add(x, 1, y);
    K.col(i) = Eigen::Map<Eigen::VectorXd>(y.data(), 3 * vertices);
  }
  return K;
}

TEST(SpringBeds, HoldWhatIsPressedEvenlyAndNothingAlong) {
  auto beds = square();
  for (bool corners : {false, true}) {
    for (auto& bed : beds.faces) bed.at_corners = corners;
    Eigen::VectorXd even = Eigen::VectorXd::Zero(12), along = even;
    for (int i = 0; i < 4; ++i) even[3 * i + 2] = 1, along[3 * i] = 1;
    auto const K = matrix(beds, 4);
    EXPECT_TRUE(K.isApprox(K.transpose()));
    EXPECT_NEAR(even.dot(K * even), 12, 1e-12);
    EXPECT_EQ((K * along).norm(), 0);
    for (auto& bed : beds.faces) bed.rubs = true;
    EXPECT_NEAR(along.dot(matrix(beds, 4) * along), 12, 1e-12);
    for (auto& bed : beds.faces) bed.rubs = false;
  }
}

TEST(SpringBeds, RowsBoundTheirFrequencies) {
  auto const beds = square();
  std::vector<double> const mass{1, 2, 3, 4};
  auto const rows = beds.rows(mass);
  EXPECT_EQ(rows, (std::vector<double>{4, 1, 4 / 3.0, 0.5}));
  Eigen::MatrixXd K = matrix(beds, 4);
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) K(i, j) /= std::sqrt(mass[i / 3] * mass[j / 3]);
  double const top = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues().maxCoeff();
  EXPECT_LE(top, 4);
  EXPECT_GT(top, 2);  // the vertex that the stiffest row is of, alone: 2 k/(D(D+1)) of each face over its mass
}

TEST(SpringBeds, BounceByFacesThatLookOneWay) {
  auto beds = square();
  std::vector<Index> const node{0, 1, 2, 3};
  EXPECT_DOUBLE_EQ(beds.bounce(node, {1, 2, 3, 4}), 4);
  EXPECT_DOUBLE_EQ(beds.bounce(node, {1, 0.01, 3, 4}), 200);
  EXPECT_DOUBLE_EQ(beds.bounce(node, {1, 0.01, 3, 4}, 1), 4);  // by the nodes of the second face, and all on them
  EXPECT_DOUBLE_EQ(beds.bounce(node, {1, 0.01, 3, 4}, 2), 0);
  beds.faces[1].normal = {0, 0, -1};  // pressed from the other side
  EXPECT_DOUBLE_EQ(beds.bounce(node, {1, 2, 3, 4}), 2);
  EXPECT_DOUBLE_EQ(beds.bounce({0, 0, 0, 0}, {1}), 6);  // three corners of one face
}

TEST(SpringBeds, GoThroughACheckpoint) {
  auto beds = square();
  beds.faces[1].rubs = beds.faces[0].at_corners = true;
  SpringBeds<3> again;
  again.set_flat(beds.flat());
  EXPECT_EQ(beds.flat().size(), 2 * SpringBeds<3>::numbers_each);
  EXPECT_EQ(again.flat(), beds.flat());
  EXPECT_EQ(matrix(again, 4), matrix(beds, 4));
}

}  // namespace
}  // namespace fissure
