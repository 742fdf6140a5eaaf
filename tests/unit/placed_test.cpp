// Shapes that are moved, turned, mirrored, scaled or revolved, against closed forms in both dimensions.
#include <gtest/gtest.h>

#include <numbers>

#include "../../src2d/shapes.h"
#include "../../src3d/shapes.h"
#include "lua/reader.h"
#include "mesh_checks.h"

namespace fissure::mesh::testing {
namespace {

using scene::Placed;
constexpr double pi = std::numbers::pi;

scene::Shape placed(Placed::How how, scene::Shape const& part, Vec3 const& by, Vec3 const& about = {0, 0, 0},
                    double angle = 0) {
  Placed one;
  one.how = how, one.part = {part}, one.by = by, one.about = about, one.angle = angle;
  return shape(one);
}

struct Case {
  char const* name;
  scene::Shape shape;
  double area, volume;  // in 2D and 3D
  Vec3 middle;          // of area in 2D, of volume in 3D where it is the same
  double error;
};

Vec3 middle_of(Mesh const& mesh) {
  int const n = node_count(mesh.kind);
  Vec3 sum(0, 0, 0);
  double whole = 0;
  for (int cell = 0; cell < mesh.n_cells(); ++cell) {
    Vec3 middle(0, 0, 0);
    for (int a = 0; a < n; ++a) middle += mesh.nodes[mesh.cells[static_cast<std::size_t>(cell * n + a)]] / n;
    double const size = simplex(mesh, cell).measure();
    sum += size * middle, whole += size;
  }
  return sum / whole;
}

scene::Shape const brick = shape(scene::Box{{1, 0, 0}, {2, 1, 0.4}});
scene::Shape const wedge = shape(scene::Polygon{{{0, 0}, {1, 0}, {0, 1}}, 0.4});

TEST(Placed, AreasVolumesAndMiddles) {
  using How = Placed::How;
  double const angle = 0.7;
  Vec3 const turned(std::cos(angle), std::sin(angle), 0);
  for (auto const& c :
       {Case{"turned", placed(How::turned, brick, {0, 0, 1}, {0, 0, 0}, angle), 2, 0.8, turned, 1e-9},
        Case{
            "turned about its end", placed(How::turned, brick, {0, 0, 1}, {2, 0, 0}, pi / 2), 2, 0.8, {2, -1, 0}, 1e-9},
        Case{"moved", placed(How::moved, wedge, {3, 4, 0}), 0.5, 0.2, {3 + 1.0 / 3, 4 + 1.0 / 3, 0}, 1e-9},
        Case{"mirrored", placed(How::mirrored, wedge, {1, 0, 0}, {2, 0, 0}), 0.5, 0.2, {4 - 1.0 / 3, 1.0 / 3, 0}, 1e-9},
        Case{"scaled", placed(How::scaled, brick, {2, 2, 2}), 8, 6.4, {2, 0, 0}, 1e-9},
        Case{"ellipse",
             placed(How::scaled, shape(scene::Disc{{0, 0, 0}, 1, 0.4}), {2, 1, 1}),
             2 * pi,
             0.8 * pi,
             {0, 0, 0},
             0.01},
        Case{"of placed ones",
             placed(How::moved, placed(How::turned, placed(How::scaled, brick, {1, 2, 1}), {0, 0, 1}, {0, 0, 0}, pi),
                    {0, 5, 0}),
             4,
             1.6,
             {-1, 5, 0},
             1e-9},
        Case{"both halves",
             shape(scene::Union{{wedge, placed(How::mirrored, wedge, {1, 0, 0})}}),
             1,
             0.4,
             {0, 1.0 / 3, 0},
             1e-9},
        Case{"a cone", shape(scene::Revolved{{{0, 0}, {1, 0}, {0, 1}}}), 1, pi / 3, {0, 1.0 / 3, 0}, 0.02},
        Case{"a square ring", shape(scene::Revolved{{{1, 0}, {2, 0}, {2, 1}, {1, 1}}}), 2, 3 * pi, {0, 0.5, 0}, 0.02}})
    for (auto const* mesher : {&mesher_2d(), &mesher_3d()}) {
      bool const flat = mesher == &mesher_2d();
      SCOPED_TRACE(std::string(c.name) + (flat ? " 2D" : " 3D"));
      Mesh const mesh = mesh_of(*mesher, c.shape, 0.2);
      expect_sound(mesh);
      double const size = flat ? c.area : c.volume;
      EXPECT_NEAR(total_measure(mesh), size, c.error * size);
      bool const alike = c.name != std::string("a cone");  // else its middle in 3D is another one
      if (alike || flat) {
        EXPECT_LT((middle_of(mesh) - c.middle).norm(), 3 * c.error + 1e-9);
      }
    }
}

TEST(Placed, TurnedOutOfThePlane) {
  Mesh const rod = mesh_of(
      mesher_3d(), placed(Placed::How::turned, shape(scene::Rod{{0, 0, 0}, 0.3, 2, 0}), {0, 0, 1}, {0, 0, 0}, -pi / 2),
      0.15);
  auto const extent = [&](int axis) {
    double low = INFINITY, high = -INFINITY;
    for (auto const& x : rod.nodes) low = std::min(low, x[axis]), high = std::max(high, x[axis]);
    return std::array{low, high};
  };
  EXPECT_NEAR(extent(0)[1], 2, 1e-9);
  EXPECT_NEAR(extent(1)[1], 0.3, 1e-9);
}

TEST(Placed, ExtentsAreThoseOfTheirMeshes) {
  using How = Placed::How;
  for (scene::Shape const& part :
       {brick, wedge, shape(scene::Disc{{0.5, 0, 0}, 1, 0.4}), shape(scene::Rod{{0, 0, 0}, 0.5, 2, 0.2}),
        shape(scene::Ball{{0, 1, 0}, 0.5}), shape(scene::Ring{{0, 0, 0}, 0.5, 1, 0.4}),
        shape(scene::Revolved{{{0.5, 0}, {1, 0}, {1, 1}}})})
    for (scene::Shape const& one :
         {part, placed(How::turned, part, {0, 0, 1}, {1, 0, 0}, 0.6),
          placed(How::turned, part, {1, 0, 0}, {0, 0, 0}, 0.4), placed(How::scaled, part, {2, 1, 1}),
          placed(How::mirrored, part, Vec3(1, 1, 0).normalized())}) {
      Mesh const mesh = mesh_of(mesher_3d(), one, 0.15);
      auto const [low, high] = lua::extent_of(one);
      for (int axis = 0; axis < 3; ++axis) {
        double least = INFINITY, most = -INFINITY;
        for (auto const& x : mesh.nodes) least = std::min(least, x[axis]), most = std::max(most, x[axis]);
        // nodes of a round surface leave out its furthest point by at most h^2/(8 r)
        EXPECT_NEAR(low[axis], least, 0.015);
        EXPECT_NEAR(high[axis], most, 0.015);
        EXPECT_LE(low[axis], least + 1e-6);
        EXPECT_GE(high[axis], most - 1e-6);
      }
    }
}

}  // namespace
}  // namespace fissure::mesh::testing
