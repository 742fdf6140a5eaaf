// The contract of base/dim.h: whatever Dim<2> does equals Dim<3> on the plane put into space.
#include "../../src2d/dim.h"

#include <gtest/gtest.h>

#include <random>

#include "../../src3d/dim.h"

namespace fissure {
namespace {

Mat<double, 2> some(int seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> x(-1, 1);
  Mat<double, 2> H;
  for (int i = 0; i < 4; ++i) H(i / 2, i % 2) = x(random);
  return H;
}

TEST(Dimensions, EmbedAddsNothingOutOfThePlane) {
  Mat<double, 2> const H = some(1);
  Mat<double, 3> const space = Dim<2>::embed(H);
  EXPECT_EQ((space.topLeftCorner<2, 2>() - H).norm(), 0);
  EXPECT_EQ(space.col(2).norm() + space.row(2).norm(), 0);
  EXPECT_EQ((Dim<3>::embed(space) - space).norm(), 0);
  EXPECT_EQ(Dim<2>::embed(H, 0.5)(2, 2), 0.5);
}

TEST(Dimensions, CofactorsAreThoseOfTheEmbeddedMatrix) {
  for (int seed = 0; seed < 10; ++seed) {
    Mat<double, 2> const M = some(seed);
    Mat<double, 3> space = Mat<double, 3>::Identity();
    space.topLeftCorner<2, 2>() = M;
    Mat<double, 2> const flat = Dim<2>::cofactor(M);
    Mat<double, 3> const solid = Dim<3>::cofactor(space);
    EXPECT_LT((solid.topLeftCorner<2, 2>() - flat).norm(), 1e-15);
    EXPECT_LT((M * flat.transpose() - M.determinant() * Mat<double, 2>::Identity()).norm(), 1e-14);
    EXPECT_LT((space * solid.transpose() - space.determinant() * Mat<double, 3>::Identity()).norm(), 1e-14);
  }
}

TEST(Dimensions, VolumeChangesAgree) {
  for (double size : {1e-12, 1e-6, 0.5}) {
    Mat<double, 2> const H = size * some(4);
    double const flat = Dim<2>::volume_change(H), solid = Dim<3>::volume_change(Dim<2>::embed(H));
    EXPECT_NEAR(flat, solid, 1e-15 * size);
    EXPECT_NEAR(flat, (Mat<double, 2>::Identity() + H).determinant() - 1, 1e-15 + 1e-9 * size);
  }
}

TEST(Dimensions, AnEdgesNormalIsThatOfItsStrip) {
  // The edge swept by a unit along z: a rectangle of two triangles with the edge's length as area.
  Vec<double, 2> const edge[2] = {{0.3, -0.2}, {1.1, 0.7}};
  Vec<double, 3> const a(0.3, -0.2, 0), b(1.1, 0.7, 0), up(0, 0, 1);
  Vec<double, 3> const lower[3] = {a, b, b + up}, upper[3] = {a, b + up, a + up};
  Vec<double, 3> const strip = Dim<3>::face_normal(lower) + Dim<3>::face_normal(upper);
  Vec<double, 2> const normal = Dim<2>::face_normal(edge);
  EXPECT_NEAR(strip[0], normal[0], 1e-15);
  EXPECT_NEAR(strip[1], normal[1], 1e-15);
  EXPECT_NEAR(strip[2], 0, 1e-15);
  EXPECT_NEAR(normal.norm(), (b - a).norm(), 1e-15);
}

/// Face a of a positive simplex, with the sign that the kernels give it, points outward.
template <int D>
void expect_outward_faces() {
  Vec<double, D> corner[D + 1];
  corner[0].setZero();
  for (int a = 1; a <= D; ++a) corner[a] = Vec<double, D>::Unit(a - 1);
  Vec<double, D> sum = Vec<double, D>::Zero();
  for (int a = 0; a <= D; ++a) {
    Vec<double, D> face[D];
    Vec<double, D> middle = Vec<double, D>::Zero();
    for (int i = 0; i < D; ++i) face[i] = corner[i + (i >= a)], middle += face[i] / D;
    Vec<double, D> const outward = (a % 2 == 0 ? 1 : -1) * Dim<D>::face_normal(face);
    EXPECT_GT(outward.dot(middle - corner[a]), 0) << D << " " << a;
    sum += outward;
  }
  EXPECT_LT(sum.norm(), 1e-15) << D;
}

TEST(Dimensions, FacesPointOutwardAndClose) {
  expect_outward_faces<2>();
  expect_outward_faces<3>();
}

TEST(Dimensions, SimplicesShareTheirBoxes) {
  EXPECT_EQ(Dim<2>::simplex_share * 2, 1);
  EXPECT_EQ(Dim<3>::simplex_share * 6, 1);
  EXPECT_EQ(Dim<2>::corners, 3);
  EXPECT_EQ(Dim<3>::corners, 4);
}

}  // namespace
}  // namespace fissure
