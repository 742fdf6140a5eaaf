// Bonds between bodies: that their meshes fit, which faces they join, and what is refused.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "../../src2d/shapes.h"
#include "../../src3d/shapes.h"
#include "lua/script.h"
#include "mesh/mesher.h"
#include "mesh_checks.h"

namespace fissure::mesh {
namespace {

std::string const fracture = "fracture = { tension = 5e6, shear = 2e7, G1 = 50, G2 = 100, penalty = 5e11 }";
std::string const box_below =
    "local a = body{ \"a\", shape = box{ center = { 0, -0.5, 0 }, size = { 1, 1, 1 } }, mesh = { size = 0.25 }, "
    "material = m }\n";
std::string const box_above =
    "local b = body{ \"b\", shape = box{ center = { 0.25, 0.5, 0 }, size = { 0.5, 1, 1 } }, mesh = { size = 0.4, seed "
    "= 3 }, material = m }\n";

struct Glued {
  scene::Scene scene;
  Mesh mesh;

  Glued(int dimension, std::string const& bodies) {
    scene =
        lua::read_scene_text("local m = material{ \"m\", density = 2700, elastic = { young = 5e10, poisson = 0.2 }, " +
                                 fracture + " }\n" + bodies + "\nrun{ time = 1e-3 }\n",
                             "s.lua", dimension, {});
    mesh = make_mesh(scene, dimension == 2 ? mesher_2d() : mesher_3d());
  }
  double area() const {
    int const corners = node_count(mesh.kind);
    double sum = 0;
    for (auto const& face : mesh.bonded) {
      std::vector<Vec3> p;
      for (int i = 0; i < corners; ++i)
        if (i != face.use[0] % corners) p.push_back(mesh.nodes[mesh.cells[face.use[0] / corners * corners + i]]);
      sum += corners == 3 ? (p[1] - p[0]).norm() : (p[1] - p[0]).cross(p[2] - p[0]).norm() / 2;
    }
    return sum;
  }
};

std::string refusal(int dimension, std::string const& bodies) {
  try {
    Glued const glued(dimension, bodies);
    joint_strengths(glued.scene, glued.mesh);
  } catch (Error const& error) {
    return error.what();
  }
  return "";
}

/// Boxes of other widths and sizes of elements: their faces match where they meet, and only there.
TEST(Bonds, FitMeshes) {
  for (int dimension : {2, 3}) {
    Glued const glued(dimension, box_below + box_above + "bond{ a, b, " + fracture + " }");
    EXPECT_NEAR(glued.area(), 0.5, 1e-9);
    auto const across = neighbours(glued.mesh);
    int const corners = node_count(glued.mesh.kind);
    for (auto const& [use, bond, joined] : glued.mesh.bonded) {
      EXPECT_EQ(bond, 0);
      EXPECT_TRUE(joined);
      EXPECT_EQ(across[use[0]], use[1] / corners);
      EXPECT_EQ(across[use[1]], use[0] / corners);
      for (int side : {0, 1})
        for (int i = 0; i < corners; ++i) {
          if (i == use[side] % corners) continue;
          EXPECT_NEAR(glued.mesh.nodes[glued.mesh.cells[use[side] / corners * corners + i]].y(), 0, 1e-12);
        }
    }
    double outside = 0;  // what is left of both surfaces
    for (Face const& face : glued.mesh.boundary) {
      std::vector<Vec3> p;
      for (int i = 0; i + 1 < corners; ++i) p.push_back(glued.mesh.nodes[face.node[i]]);
      outside += corners == 3 ? (p[1] - p[0]).norm() : (p[1] - p[0]).cross(p[2] - p[0]).norm() / 2;
    }
    EXPECT_NEAR(outside, dimension == 2 ? 4 + 3 - 1 : 6 + 4 - 1, 1e-9);
    for (int b : {0, 1})
      for (auto const& [name, faces] : glued.mesh.named_faces[b])
        for (int face : faces) EXPECT_EQ(glued.mesh.body_of_cell(glued.mesh.boundary.at(face).cell), b) << name;
    EXPECT_TRUE(starting_contact(glued.scene, glued.mesh).overlaps.empty());
  }
}

TEST(Bonds, HoldInclusions) {
  std::string const bodies =
      "local hole = disc{ radius = 0.3, thickness = 1 }\n"
      "local a = body{ \"a\", shape = difference{ box{ size = { 1, 1, 1 } }, hole }, mesh = { size = 0.2 }, material = "
      "m }\n"
      "local b = body{ \"b\", shape = hole, mesh = { size = 0.1 }, material = m }\n";
  for (int dimension : {2, 3}) {
    Glued const glued(dimension, bodies + "bond{ a, b, " + fracture + " }");
    EXPECT_NEAR(glued.area(), 2 * 3.14159265 * 0.3, 0.02);  // chords of a tenth of a metre are 0.5 % short
    EXPECT_LT(glued.area(), 2 * 3.14159265 * 0.3);
    EXPECT_EQ(glued.mesh.n_bodies(), 2);
    auto const strengths = joint_strengths(glued.scene, glued.mesh);
    EXPECT_NE(strengths.lines.at(0).find("faces between a, b"), std::string::npos) << strengths.lines[0];
  }
}

/// A body may consist of several pieces: islands, or what seams part. None is lost.
TEST(Bonds, KeepAllPiecesOfABody) {
  auto const measure = [](Mesh const& mesh, int body) { return quality(mesh)[body].measure; };
  std::string const base =
      "local a = body{ \"a\", shape = box{ center = { 0, -0.1, 0 }, size = { 1, 0.2, 1 } }, mesh = { size = 0.1 }, "
      "material = m }\n";
  std::string const islands =
      "local b = body{ \"b\", shape = union{ box{ center = { -0.3, 0.25, 0 }, size = { 0.3, 0.5, 1 } }, box{ center = "
      "{ 0.35, 0.25, 0 }, size = { 0.2, 0.5, 1 } } }, "
      "mesh = { size = 0.1 }, material = m }\n";
  for (int dimension : {2, 3}) {
    Glued const apart(dimension, base + islands + "bond{ a, b, " + fracture + " }");
    EXPECT_NEAR(measure(apart.mesh, 1), 0.25, 1e-9);
    EXPECT_NEAR(apart.area(), 0.5, 1e-9);
    for (char const* y : {"0.1", "0.25", "0.45"}) {
      Glued const parted(dimension, base +
                                        "local b = body{ \"b\", shape = box{ center = { 0, 0.25, 0 }, size = { 1, 0.5, "
                                        "1 } }, mesh = { size = 0.1, seam = { from = { -0.5, " +
                                        y + " }, to = { 0.5, " + y + " } } }, material = m }\nbond{ a, b, " + fracture +
                                        " }");
      EXPECT_NEAR(measure(parted.mesh, 1), 0.5, 1e-9) << y;
      EXPECT_NEAR(parted.area(), 1, 1e-9) << y;
    }
  }
}

/// What a bond leaves out, and where bonded bodies meet without a bond, is a crack from the start: its corners may be
/// joined.
TEST(Bonds, LeaveCracks) {
  for (int dimension : {2, 3}) {
    Glued const some(dimension, box_below + box_above + "bond{ a, b, " + fracture +
                                    ", at = function(x, y, z) return x < 0.25 end }");
    EXPECT_NEAR(some.area(), 0.5, 1e-9);
    double joined = 0;
    auto const given = joint_strengths(some.scene, some.mesh);
    for (auto const& face : some.mesh.bonded) {
      joined += face.joined;
      EXPECT_EQ(given.of_face[face.use[0]], face.joined ? 1 : 0);
    }
    EXPECT_GT(joined, 0);
    EXPECT_LT(joined, some.mesh.bonded.size());
    EXPECT_NE(given.lines.at(0).find("more are left out: cracks from the start"), std::string::npos) << given.lines[0];
  }
  // Two towers on a base, side by side: the joint between them has no bond.
  std::string const towers =
      "local p = {}\nfor i = 1, 2 do p[i] = body{ \"p\" .. i, shape = box{ center = { -0.45 + 0.3*i, 0.5, 0 }, size = "
      "{ 0.3, 1, 1 } }, mesh = { size = 0.25 }, material = m } end\n";
  Glued const wall(2, box_below + towers + "bond{ a, p[1], " + fracture + " }\nbond{ a, p[2], " + fracture + " }");
  EXPECT_NEAR(wall.area(), 0.6 + 1, 1e-9);
  EXPECT_NEAR(static_cast<double>(std::count_if(wall.mesh.bonded.begin(), wall.mesh.bonded.end(),
                                                [](BondedFace const& face) { return !face.joined; })),
              4, 1);
}

/// Grids of one spacing fit as they are.
TEST(Bonds, HoldRegularGrids) {
  auto const box = [](char const* name, double x, double size) {
    return fmt::format(
        "local {0} = body{{ \"{0}\", shape = box{{ center = {{ {1}, 0, 0 }}, size = {{ 1, 1, 1 }} }}, mesh = {{ size = "
        "{2}, structured = true }}, material = m }}\n",
        name, x, size);
  };
  for (int dimension : {2, 3}) {
    EXPECT_NEAR(Glued(dimension, box("a", -0.5, 0.25) + box("b", 0.5, 0.25) + "bond{ a, b, " + fracture + " }").area(),
                1, 1e-9);
    EXPECT_NE(refusal(dimension, box("a", -0.5, 0.25) + box("b", 0.5, 0.2) + "bond{ a, b, " + fracture + " }")
                  .find("their nodes do not match"),
              std::string::npos);
  }
}

TEST(Bonds, JoinManyBodies) {
  std::string const pillars =
      "local all = { a }\nfor i = 1, 3 do all[i + 1] = body{ \"p\" .. i, shape = box{ center = { -0.6 + 0.3*i, 0.5, 0 "
      "}, size = { 0.3, 1, 1 } }, mesh = { size = 0.25 }, "
      "material = m } end\n";
  Glued const glued(2, box_below + pillars + "bond{ all[1], all[2], all[3], all[4], " + fracture + " }");
  EXPECT_NEAR(glued.area(), 0.9 + 2 * 1, 1e-9);  // feet, and both sides between pillars
}

/// Scatter is the bond's own: it does not depend on what else the scene has.
TEST(Bonds, Scatter) {
  auto const strengths = [](std::string const& before) {
    Glued const glued(
        2, before + box_below + box_above +
               "bond{ \"glue\", a, b, fracture = { tension = 5e6, shear = 2e7, G1 = 50, G2 = 100, penalty = 5e11, "
               "scatter = { modulus = 5 } } }");
    auto const given = joint_strengths(glued.scene, glued.mesh);
    std::vector<double> all;
    for (auto const& face : glued.mesh.bonded) {
      EXPECT_EQ(given.of_face[face.use[0]], given.of_face[face.use[1]]);
      EXPECT_EQ(given.any_plane[face.use[0]], 0);
      all.push_back(given.of_face[face.use[0]]);
    }
    return all;
  };
  auto const plain = strengths("");
  EXPECT_NE(plain.at(0), plain.at(1));
  EXPECT_EQ(plain, strengths("body{ shape = disc{ center = { 5, 5 }, radius = 1, thickness = 1 }, mesh = { size = 0.3 "
                             "}, material = m }\n"));
}

TEST(Bonds, AreRefusedInWords) {
  std::string const both = box_below + box_above, bond = "bond{ a, b, " + fracture + " }\n";
  auto const says = [](std::string const& text, std::string const& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  says(refusal(2, both + "bond{ a, " + fracture + " }"), "s.lua:4: bond: joins bodies, two at least");
  says(refusal(2, both + "bond{ a, b, a, " + fracture + " }"), "s.lua:4: bond: body \"a\" is said twice");
  says(refusal(2, both + "bond{ a, b }"), "fracture");
  says(refusal(2, both + bond + bond), "too; a face has one bond");
  says(refusal(2, both + "bond{ a, b, " + fracture + ", at = function() return false end }"),
       "said true for none of the 2 faces");
  says(refusal(2, "local s = material{ \"s\", density = 1, elastic = { young = 1e9, poisson = 0 } }\n" + box_below +
                      "local b = body{ \"b\", shape = disc{ radius = 1, thickness = 1 }, mesh = { size = 1 }, material "
                      "= s }\n" +
                      bond),
       "body \"b\" has no joints");
  std::string const far =
      "local b = body{ \"b\", shape = box{ center = { 0, 5, 0 }, size = { 1, 1, 1 } }, mesh = { size = 0.25 }, "
      "material = m }\n";
  std::string const inside =
      "local b = body{ \"b\", shape = box{ center = { 0, -0.2, 0 }, size = { 0.5, 1, 1 } }, mesh = { size = 0.25 }, "
      "material = m }\n";
  std::string const blocks =
      "local b = body{ \"b\", shape = box{ center = { 0, 0.5, 0 }, size = { 1, 1, 1 } }, mesh = { size = 0.25, cells = "
      "\"block\" }, material = m }\n";
  for (int dimension : {2, 3}) {
    says(refusal(dimension, box_below + far + bond), "meets none of the others");
    says(refusal(dimension, box_below + inside + bond), "are bonded and overlap");
    says(refusal(dimension, box_below + blocks + bond), "bonds are for bodies of simplices");
  }
  says(refusal(2, both + "joints{ a, b, strength = 0.5, facing = { 1, 0 }, within = 0.1 }"),
       "unless bond{ a, b, fracture = ... } makes them");
}

}  // namespace
}  // namespace fissure::mesh
