// Ties at work on meshes: which nodes hang on which cells, by which shares, and what is refused.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>

#include "../../src2d/shapes.h"
#include "../../src3d/shapes.h"
#include "lua/script.h"
#include "mesh/mesher.h"

namespace fissure::mesh {
namespace {

std::string box(std::string const& name, double y, double size, std::string const& more = "") {
  return fmt::format(
      "local {0} = body{{ \"{0}\", shape = box{{ center = {{ 0, {1}, 0 }}, size = {{ 1, 1, 1 }} }}, mesh "
      "= {{ size = {2} }}, material = {3} }}\n",
      name, y, size, more.empty() ? "m" : more);
}

struct Tied {
  scene::Scene scene;
  Mesh mesh;

  Tied(int dimension, std::string const& bodies) {
    scene = lua::read_scene_text(
        "local m = material{ \"m\", density = 2700, elastic = { young = 5e10, poisson = 0.2 } }\n"
        "local brittle = material{ \"brittle\", density = 2700, elastic = { young = 5e10, poisson = 0.2 }, fracture = "
        "{ "
        "tension = 5e6, shear = 2e7, G1 = 50, G2 = 100, penalty = 5e11, insertion = \"adaptive\" } }\n" +
            bodies + "\nrun{ time = 1e-3 }\n",
        "s.lua", dimension, {});
    mesh = make_mesh(scene, dimension == 2 ? mesher_2d() : mesher_3d());
  }
};

std::string refusal(int dimension, std::string const& bodies) {
  try {
    Tied const tied(dimension, bodies);
  } catch (Error const& error) {
    return error.what();
  }
  return "";
}

/// The finer body hangs, whichever is said first, with every node where they meet and no other, and shares give back
/// the node's place.
TEST(Ties, HangTheFinerBody) {
  for (int const dimension : {2, 3})
    for (std::string const order : {"a, b", "b, a"}) {
      Tied const tied(dimension, box("a", -0.5, 0.4) + box("b", 0.5, 0.23) + "tie{ " + order + " }");
      auto const& mesh = tied.mesh;
      std::set<int> hung;
      for (auto const& one : mesh.hung) {
        EXPECT_EQ(mesh.body_of_node(one.node), 1);
        EXPECT_EQ(mesh.body_of_cell(one.cell), 0);
        Vec3 place = Vec3::Zero();
        int const corners = node_count(mesh.kind);
        for (int a = 0; a < corners; ++a) {
          place += one.share[a] * mesh.nodes[mesh.cells[static_cast<std::size_t>(one.cell) * corners + a]];
          EXPECT_GT(one.share[a], -1e-12);
        }
        EXPECT_LT((place - mesh.nodes[one.node]).norm(), 1e-14);
        EXPECT_TRUE(hung.insert(one.node).second);
      }
      for (int n = mesh.body_first_node[1]; n < mesh.body_first_node[2]; ++n)
        EXPECT_EQ(hung.contains(n), std::abs(mesh.nodes[n][1]) < 1e-12) << n;
      EXPECT_TRUE(starting_contact(tied.scene, mesh).overlaps.empty());
    }
}

/// A ball in a hole: facets of both leave gaps and overlaps, and all of its surface hangs.
TEST(Ties, FitRoundSurfaces) {
  std::string const round =
      "local plug = body{ \"plug\", shape = disc{ radius = 0.3, thickness = 1 }, mesh = { size = 0.05 }, material = m "
      "}\n"
      "local plate = body{ \"plate\", shape = difference{ box{ size = { 1, 1, 1 } }, disc{ radius = 0.3, thickness = 2 "
      "} "
      "}, mesh = { size = 0.12 }, material = m }\ntie{ plug, plate }";
  for (int const dimension : {2, 3}) {
    Tied const tied(dimension, round);
    std::set<int> hung;
    for (auto const& one : tied.mesh.hung) hung.insert(one.node);
    for (int n = tied.mesh.body_first_node[0]; n < tied.mesh.body_first_node[1]; ++n) {
      double const r = tied.mesh.nodes[n].head<2>().norm();
      EXPECT_EQ(hung.contains(n), r > 0.3 - 1e-9) << r;
    }
    EXPECT_TRUE(starting_contact(tied.scene, tied.mesh).overlaps.empty());
  }
}

/// A ball in a hole of cells that leave a ninth of an edge of it: nothing is left to overlap.
TEST(Ties, FitABall) {
  Tied const tied(3,
                  "local plug = body{ \"plug\", shape = ball{ radius = 0.3 }, mesh = { size = 0.08 }, material = m }\n"
                  "local rock = body{ \"rock\", shape = difference{ box{ size = { 1, 1, 1 } }, ball{ radius = 0.3 } }, "
                  "mesh = { size = 0.2 }, material = m }\ntie{ rock, plug }");
  std::set<int> hung;
  for (auto const& one : tied.mesh.hung) hung.insert(one.node);
  for (int n = tied.mesh.body_first_node[0]; n < tied.mesh.body_first_node[1]; ++n)
    EXPECT_EQ(hung.contains(n), tied.mesh.nodes[n].norm() > 0.3 - 1e-9);
  EXPECT_TRUE(starting_contact(tied.scene, tied.mesh).overlaps.empty());
}

/// What counts is how large cells are where bodies meet; of like ones the second hangs; no node hangs in a circle.
TEST(Ties, AskForTheCellsThatMeet) {
  auto const hanging = [](Tied const& tied) {
    std::set<int> bodies;
    for (auto const& one : tied.mesh.hung) bodies.insert(tied.mesh.body_of_node(one.node));
    return bodies;
  };
  std::string const far_fine =
      "local b = body{ \"b\", shape = box{ center = { 0, 0.5 }, size = { 1, 1, 1 } }, mesh = { size = 0.4, near = { "
      "from = "
      "{ 0, 1 }, radius = 0.2, size = 0.02 } }, material = m }\n";
  EXPECT_EQ(hanging(Tied(2, box("a", -0.5, 0.2) + far_fine + "tie{ b, a }")), std::set<int>{0});
  EXPECT_EQ(hanging(Tied(2, box("a", -0.5, 0.25) + box("b", 0.5, 0.25) + "tie{ a, b }")), std::set<int>{1});
  std::string const three =
      "local c = body{ \"c\", shape = box{ center = { 1, 0 }, size = { 1, 2, 1 } }, mesh = { size = 0.25 }, material = "
      "m }\n"
      "tie{ a, b } tie{ b, c } tie{ c, a }";
  Tied const ring(2, box("a", -0.5, 0.25) + box("b", 0.5, 0.25) + three);
  for (auto const& one : ring.mesh.hung)
    if (ring.mesh.nodes[one.node].head<2>().isApprox(Vec3(0.5, 0, 0).head<2>())) {
      EXPECT_NE(ring.mesh.body_of_node(one.node), 0);  // the first carries the two others
    }
}

/// Beside a tie bodies may overlap by what cells leave of round surfaces; elsewhere overlaps are told as ever.
TEST(Ties, LeaveOtherOverlapsInSight) {
  std::string const beside =
      "local b = body{ \"b\", shape = box{ center = { 0.995, 0 }, size = { 1, 1, 1 } }, mesh = { size = 0.1 }, "
      "material = m }\n";
  Tied const tied(2, box("a", 0, 0.25) + beside + "tie{ a, b, within = 0.1, at = function(x, y) return y < -0.3 end }");
  EXPECT_EQ(starting_contact(tied.scene, tied.mesh).overlaps.size(), 1);
}

TEST(Ties, AreRefusedInWords) {
  auto const says = [](std::string const& message, std::string const& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  says(refusal(2, box("a", -0.5, 0.4) + box("b", 0.7, 0.2) + "tie{ \"glue\", a, b }"),
       "s.lua:5: tie \"glue\": 0 of the nodes of body \"b\" lie against body \"a\"");
  says(refusal(2, box("a", -0.5, 0.4) + box("b", 0.7, 0.2) + "tie{ a, b }"), "the nearest is 0.2 m away");
  EXPECT_EQ(refusal(2, box("a", -0.5, 0.4) + box("b", 0.7, 0.2) + "tie{ a, b, within = 0.21 }"), "");
  says(refusal(2, box("a", -0.5, 0.4) + box("b", 0.5, 0.2) + "tie{ a, b, at = function() return false end }"),
       "its function said true for none of the nodes");
  says(refusal(2, box("a", -0.5, 0.4) + box("b", 0.5, 0.2) + "tie{ a, b } tie{ b, a }"),
       "hangs already, by a tie before it");
  says(refusal(3, box("a", -0.5, 0.5, "brittle") + box("b", 0.5, 0.2) + "tie{ a, b }"), "has the larger cells there");
  EXPECT_EQ(refusal(3, box("a", -0.5, 0.5) + box("b", 0.5, 0.2, "brittle") + "tie{ a, b }"), "");
}

}  // namespace
}  // namespace fissure::mesh
