// Seams and the joints on them: several of a body, polygons in space, faces of blocks, and what is refused.
#include <gtest/gtest.h>

#include "../../src2d/shapes.h"
#include "../../src3d/shapes.h"
#include "lua/script.h"
#include "mesh/mesher.h"
#include "mesh/plane.h"

namespace fissure::mesh {
namespace {

/// A cube of one metre with what `mesh` says of its mesh, and joint sets after it.
struct Cube {
  scene::Scene scene;
  Mesh mesh;

  Cube(int dimension, std::string const& keys, std::string const& sets) {
    scene = lua::read_scene_text(
        "local m = material{ \"m\", density = 2700, elastic = { young = 5e10, poisson = 0.2 }, fracture = { tension = "
        "5e6, shear = 2e7, G1 = 50, G2 = 100, "
        "penalty = 5e11 } }\nlocal b = body{ \"b\", shape = box{ size = { 1, 1, 1 } }, mesh = { size = 0.25, " +
            keys + " }, material = m }\n" + sets + "\nrun{ time = 1e-3 }\n",
        "s.lua", dimension, {});
    mesh = make_mesh(scene, dimension == 2 ? mesher_2d() : mesher_3d());
  }
  /// Area of the faces that have a strength, half from each side [m2].
  double area_of(double strength) const {
    auto const given = joint_strengths(scene, mesh);
    int const corners = node_count(mesh.kind);
    double twice = 0;
    for (std::size_t use = 0; use < given.of_face.size(); ++use) {
      if (given.of_face[use] != strength) continue;
      std::vector<Vec3> p;
      for (int i = 0; i < corners; ++i)
        if (i != static_cast<int>(use) % corners) p.push_back(mesh.nodes[mesh.cells[use / corners * corners + i]]);
      twice += corners == 3 ? (p[1] - p[0]).norm() : (p[1] - p[0]).cross(p[2] - p[0]).norm() / 2;
    }
    return twice / 2;
  }
};

std::string refusal(int dimension, std::string const& keys, std::string const& sets = "") {
  try {
    joint_strengths(Cube(dimension, keys, sets).scene, Cube(dimension, keys, sets).mesh);
  } catch (Error const& error) {
    return error.what();
  }
  return "";
}

std::string const square = "{ { -0.2, 0.1, -0.3 }, { 0.2, 0.1, -0.3 }, { 0.2, 0.1, 0.3 }, { -0.2, 0.1, 0.3 } }";

TEST(Seams, OfABodyMayCross) {
  for (int dimension : {2, 3}) {
    Cube const cube(
        dimension,
        "seam = { { from = { -0.5, -0.4 }, to = { 0.5, 0.3 } }, { from = { 0.1, -0.5 }, to = { 0.1, 0.5 } } }",
        "joints{ b, from = { -0.5, -0.4 }, to = { 0.5, 0.3 }, strength = 0.5 }\njoints{ b, from = { 0.1, -0.5 }, to = "
        "{ 0.1, 0.5 }, strength = 0 }");
    EXPECT_NEAR(cube.area_of(0.5), std::hypot(1, 0.7), 1e-9);
    EXPECT_NEAR(cube.area_of(0), 1, 1e-9);
  }
}

/// In two dimensions the same scene has the line.
TEST(Seams, InSpaceMayBeFlatPolygons) {
  std::string const crack = "corners = " + square + ", from = { -0.2, 0.1 }, to = { 0.2, 0.1 }";
  for (int dimension : {2, 3}) {
    Cube const cube(dimension, "seam = { " + crack + " }", "joints{ b, " + crack + ", strength = 0 }");
    EXPECT_NEAR(cube.area_of(0), dimension == 2 ? 0.4 : 0.24, 1e-9);
    EXPECT_TRUE(joint_strengths(cube.scene, cube.mesh).doubts.empty());
  }
  Cube const askew(
      3, "seam = { corners = { { -0.3, -0.2, -0.2 }, { 0.3, 0.1, -0.2 }, { 0.2, 0.25, 0.3 } } }",
      "joints{ b, corners = { { -0.3, -0.2, -0.2 }, { 0.3, 0.1, -0.2 }, { 0.2, 0.25, 0.3 } }, strength = 0 }");
  EXPECT_NEAR(askew.area_of(0), Vec3(0.6, 0.3, 0).cross(Vec3(0.5, 0.45, 0.5)).norm() / 2, 1e-9);
}

TEST(Seams, SayWhatOfAPolygonHasNoFaces) {
  Cube const cube(3, "structured = true",
                  "joints{ b, corners = { { -0.25, 0, -0.25 }, { 0.3, 0, -0.25 }, { 0.3, 0, 0.25 }, { -0.25, 0, 0.25 } "
                  "}, strength = 0 }");
  auto const given = joint_strengths(cube.scene, cube.mesh);
  ASSERT_EQ(given.doubts.size(), 1u);
  EXPECT_NE(given.doubts[0].find("faces lie on 0.25 of the polygon's 0.275 m2"), std::string::npos) << given.doubts[0];
}

TEST(Seams, AreRefusedInWords) {
  auto const polygon = [](std::string const& corners) { return refusal(3, "seam = { corners = " + corners + " }"); };
  EXPECT_EQ(polygon("{ { 0, 0, 0 }, { 0.1, 0, 0 } }"),
            "s.lua:2: seam: its corners enclose no area (at least three are needed, not in a row)");
  EXPECT_EQ(polygon("{ { 0, 0, 0 }, { 0.1, 0, 0 }, { 0.2, 0, 0 } }"),
            "s.lua:2: seam: its corners enclose no area (at least three are needed, not in a row)");
  EXPECT_NE(
      polygon("{ { 0, 0, 0 }, { 0.1, 0, 0 }, { 0.1, 0, 0.1 }, { 0, 0.05, 0.1 } }").find("its corners lie in no plane"),
      std::string::npos);
  EXPECT_NE(polygon("{ { 0, 0, 0 }, { 0.3, 0, 0.3 }, { 0.3, 0, 0 }, { 0, 0, 0.2 } }").find("cross or touch"),
            std::string::npos);
  EXPECT_EQ(polygon("{ { 2, 0, 0 }, { 3, 0, 0 }, { 3, 0, 1 } }"), "s.lua:2: seam: no part of it lies inside the body");
  EXPECT_NE(refusal(2, "seam = { corners = " + square + " }").find("in two dimensions from and to are needed, too"),
            std::string::npos);
  EXPECT_NE(refusal(2, "", "joints{ b, corners = " + square + ", strength = 0 }")
                .find("in two dimensions from and to are needed, too"),
            std::string::npos);
  EXPECT_NE(refusal(2, "seam = { { from = { -0.5, 0 }, to = { 0.5, 0 } }, { from = { 3, 0 }, to = { 4, 0 } } }")
                .find("seam 2: no part of it"),
            std::string::npos);
  EXPECT_NE(refusal(2, "seam = { { from = { -0.5, 0 }, to = { 0.5, 0 } }, radius = 3 }")
                .find("has something else beside them"),
            std::string::npos);
  EXPECT_NE(
      refusal(2, "seam = { { from = { -0.5, 0 }, to = { 0.5, 0 } }, nil, { from = { 0, -0.5 }, to = { 0, 0.5 } } }")
          .find("has something else beside them"),
      std::string::npos);
  EXPECT_NE(refusal(2, "", "joints{ b, b, strength = 0.5, facing = { 1, 0 }, within = 0.1 }")
                .find("are those inside one body"),
            std::string::npos);
}

/// Middles of a hexahedron's faces decide, not those of the triangles they are cut into.
TEST(Seams, FacesOfBlocksAreWhole) {
  Cube const cube(3, "cells = \"block\"",
                  "joints{ b, at = function(x, y, z) return math.abs(x) < 0.05 and y > 0 end, strength = 0 }");
  EXPECT_NEAR(cube.area_of(0), 0.5, 1e-9);
  EXPECT_NE(joint_strengths(cube.scene, cube.mesh).lines.at(0).find("8 faces"), std::string::npos)
      << joint_strengths(cube.scene, cube.mesh).lines[0];
}

}  // namespace
}  // namespace fissure::mesh
