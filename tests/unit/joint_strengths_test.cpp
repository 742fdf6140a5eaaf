// Strengths that joints have of their own: which faces, how much, and what is refused.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "../../src2d/shapes.h"
#include "../../src3d/shapes.h"
#include "lua/script.h"
#include "mesh_checks.h"

using namespace fissure;
using namespace fissure::mesh;
using namespace fissure::mesh::testing;

namespace {

Mesher const& mesher_of(int dimension) { return dimension == 2 ? mesher_2d() : mesher_3d(); }

/// A box of two by one metres whose joints may be scattered, with bodies before it.
struct Block {
  scene::Scene scene;
  Mesh mesh;

  explicit Block(int dimension, std::string const& rest, std::string const& scatter = "",
                 std::string const& before = "", std::string const& cells = "simplex", double size = 0.1) {
    std::string const text =
        "local m = material{ \"m\", density = 2700, elastic = { young = 5e10, poisson = 0.2 }, fracture = { tension = "
        "5e6, shear = 2e7, G1 = 50, "
        "G2 = 100, penalty = 5e11" +
        scatter + " } }\n" + before +
        "local b = body{ \"b\", shape = box{ size = { 2, 1, 0.2 } }, mesh = { size = " + std::to_string(size) +
        ", structured = " + (cells == "simplex" ? "true" : "false") + ", cells = \"" + cells +
        "\" }, material = m }\n" + rest + "\nrun{ time = 1e-3 }\n";
    scene = lua::read_scene_text(text, "s.lua", dimension, {});
    mesh = make_mesh(scene, mesher_of(dimension));
  }
  JointStrengths strengths() const { return joint_strengths(scene, mesh); }
};

std::string refusal(int dimension, std::string const& rest) {
  try {
    Block(dimension, rest).strengths();
  } catch (Error const& error) {
    return error.what();
  }
  return "";
}

/// Strengths of the faces between cells, each once; that both sides agree is asserted.
std::vector<double> inner(Block const& block, JointStrengths const& strengths) {
  int const corners = node_count(block.mesh.kind);
  auto const across = neighbours(block.mesh);
  std::vector<double> all;
  for (std::size_t use = 0; use < across.size(); ++use) {
    int const cell = static_cast<int>(use) / corners;
    if (across[use] < cell) continue;
    std::size_t back = static_cast<std::size_t>(across[use]) * corners;
    while (across[back] != cell) ++back;
    EXPECT_EQ(strengths.of_face[use], strengths.of_face[back]);
    all.push_back(strengths.of_face[use]);
  }
  return all;
}

double mean(std::vector<double> const& x) {
  return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

}  // namespace

/// Grains of one mesh must not break in lockstep.
TEST(JointStrengths, DifferFromBodyToBodyOfTheSameMesh) {
  for (int dimension : {2, 3}) {
    std::string const twin =
        "body{ \"twin\", shape = box{ size = { 2, 1, 0.2 }, center = { 0, 3 } }, mesh = { size = 0.1, structured = "
        "true }, material = m }\n";
    Block const block(dimension, "", ", scatter = { modulus = 5 }", twin);
    auto const all = block.strengths().of_face;
    std::size_t const half = all.size() / 2;
    int alike = 0, drawn = 0;
    for (std::size_t use = 0; use < half; ++use)
      if (all[use] != 1) ++drawn, alike += all[use] == all[half + use];
    EXPECT_GT(drawn, 500);
    EXPECT_EQ(alike, 0);
    EXPECT_EQ(block.strengths().least.size(), 2u);
    EXPECT_LT(block.strengths().least[1], 0.6);
  }
}

TEST(JointStrengths, AreThoseOfTheFacesThatAreMeant) {
  for (int dimension : {2, 3}) {
    EXPECT_TRUE(Block(dimension, "").strengths().of_face.empty());
    auto const count = [&](std::string const& rest, double strength) {
      Block const block(dimension, rest);
      auto const all = inner(block, block.strengths());
      return std::count(all.begin(), all.end(), strength);
    };
    // Ten edges across the box; in 3D two layers of squares of two triangles.
    EXPECT_EQ(count("joints{ b, from = { 0.5, -0.5 }, to = { 0.5, 0.5 }, strength = 0.3 }", 0.3),
              dimension == 2 ? 10 : 40);
    EXPECT_EQ(count("joints{ b, from = { 0.5, 0 }, to = { 0.5, 0.5 }, strength = 0 }", 0), dimension == 2 ? 5 : 20);
    // Nineteen rows of faces across x, nine along it.
    EXPECT_EQ(count("joints{ b, facing = { 1, 0 }, within = 1*deg, strength = 0.3 }", 0.3), dimension == 2 ? 190 : 760);
    EXPECT_EQ(
        count("joints{ b, facing = { 0, -1 }, within = 1*deg, at = function(x, y, z) return x > 0 end, strength = 2 }",
              2),
        dimension == 2 ? 90 : 360);
  }
  auto const half = Block(2, "joints{ \"cut\", b, from = { 0.5, 0 }, to = { 0.5, 1 }, strength = 0 }").strengths();
  EXPECT_EQ(half.lines.at(0), "cut: 5 faces of b, 0.5 m, broken from the start");
  EXPECT_NE(half.doubts.at(0).find("faces lie on 0.5 of the line's 1 m"), std::string::npos);
}

TEST(JointStrengths, ScatterAsWeibullSays) {
  for (int dimension : {2, 3})
    for (double m : {3.0, 12.0}) {
      Block const block(dimension, "", ", scatter = { modulus = " + std::to_string(m) + " }", "", "simplex",
                        dimension == 2 ? 0.02 : 0.07);
      auto const all = inner(block, block.strengths());
      double const n = static_cast<double>(all.size()), gamma1 = std::tgamma(1 + 1 / m),
                   spread = std::sqrt(std::tgamma(1 + 2 / m) / (gamma1 * gamma1) - 1);
      ASSERT_GT(n, 5000);
      EXPECT_NEAR(mean(all), 1, 4 * spread / std::sqrt(n));
      // A share 1 - 1/e lies below the scale, which is 1/gamma1 of the mean; 4 standard errors.
      auto const below = std::count_if(all.begin(), all.end(), [&](double s) { return s < 1 / gamma1; });
      EXPECT_NEAR(static_cast<double>(below) / n, 1 - std::exp(-1), 4 * 0.482 / std::sqrt(n));
    }
}

TEST(JointStrengths, DependOnSeedAndFaceAlone) {
  std::string const other =
      "body{ \"other\", shape = box{ size = { 1, 1, 0.2 }, center = { 5, 0, 0 } }, mesh = { size = 0.3 }, material = m "
      "}\n";
  Block const alone(2, "", ", scatter = { modulus = 5, seed = 7 }"),
      second(2, "", ", scatter = { modulus = 5, seed = 7 }", other),
      differently(2, "", ", scatter = { modulus = 5, seed = 8 }");
  auto const a = alone.strengths().of_face, b = second.strengths().of_face, c = differently.strengths().of_face;
  ASSERT_LT(a.size(), b.size());
  EXPECT_TRUE(std::equal(a.begin(), a.end(), b.end() - static_cast<std::ptrdiff_t>(a.size())));
  EXPECT_NE(a, c);
}

/// The weakest link: four times the area, 4^(-1/m) times the strength; the two triangles of a block's face as one face.
TEST(JointStrengths, AreLessOnALargerFace) {
  std::string const scatter = ", scatter = { modulus = 4, area = 0.01 }";
  Block const fine(3, "", scatter, "", "simplex", 0.05), coarse(3, "", scatter, "", "simplex", 0.1);
  auto const few = inner(coarse, coarse.strengths()), many = inner(fine, fine.strengths());
  EXPECT_NEAR(mean(many) / mean(few), std::pow(4.0, 0.25),
              4 * 0.28 / std::sqrt(static_cast<double>(few.size())) * std::pow(4.0, 0.25));
  Block const blocks(3, "", ", scatter = { modulus = 4 }", "", "block", 0.07);
  auto const strengths = blocks.strengths();
  auto const across = neighbours(blocks.mesh);
  std::map<std::pair<int, int>, double> weaker;  // of what lies between two blocks
  for (std::size_t use = 0; use < across.size(); ++use) {
    int const one = blocks.mesh.block_of(0, static_cast<int>(use) / 4),
              other = across[use] < 0 ? one : blocks.mesh.block_of(0, across[use]);
    if (one >= other) continue;
    auto const known = weaker.emplace(std::pair{one, other}, strengths.of_face[use]).first;
    known->second = std::min(known->second, strengths.of_face[use]);
  }
  std::vector<double> least;
  for (auto const& [between, strength] : weaker) least.push_back(strength);
  EXPECT_NEAR(mean(least), 1, 4 * 0.28 / std::sqrt(static_cast<double>(least.size())));
}

TEST(JointStrengths, RefuseWhatNoFaceIs) {
  for (int dimension : {2, 3}) {
    EXPECT_EQ(refusal(dimension, "joints{ \"cut\", b, from = { 0.55, -0.5 }, to = { 0.55, 0.5 }, strength = 0 }"),
              "s.lua:3: joints \"cut\": no face of body \"b\" belongs to them; mesh.seam gives the mesh faces there");
    EXPECT_NE(refusal(dimension,
                      "joints{ \"one\", b, facing = { 1, 0 }, within = 0.1, strength = 0.5 }\njoints{ \"two\", b, "
                      "facing = { 1, 0 }, within = 0.2, strength = 0.5 }")
                  .find("s.lua:4: joints \"two\" and \"one\" have the face near"),
              std::string::npos);
    EXPECT_NE(refusal(dimension, "joints{ b, strength = 0.5 }").find("says of no joint where it is"),
              std::string::npos);
    EXPECT_NE(refusal(dimension, "joints{ b, within = 0.1, strength = 0.5, at = function() return true end }")
                  .find("within has no meaning without facing"),
              std::string::npos);
    EXPECT_NE(refusal(dimension, "joints{ b, facing = { 0, 0 }, strength = 0.5 }").find("facing has no direction"),
              std::string::npos);
    EXPECT_NE(refusal(dimension, "joints{ b, facing = { 0, 1 }, strength = 0.5 }").find("facing needs within"),
              std::string::npos);
    EXPECT_NE(refusal(dimension, "joints{ b, from = { 0, 0 }, to = { 0, 0 }, strength = 0.5 }").find("the same point"),
              std::string::npos);
    EXPECT_NE(refusal(dimension, "joints{ b, from = { 0, 0 }, strength = 0.5 }").find("to is missing"),
              std::string::npos);
    EXPECT_NE(refusal(dimension, "joints{ b, facing = { 0, 1 }, strength = -1 }").find("strength = -1"),
              std::string::npos);
    EXPECT_NE(refusal(dimension,
                      "joints{ body{ shape = box{ size = { 1, 1, 1 }, center = { 9, 0 } }, mesh = { size = 0.5 }, "
                      "material = material{ density = 2700, "
                      "elastic = { young = 5e10, poisson = 0.2 } } }, facing = { 0, 1 }, strength = 0.5 }")
                  .find("its material says nothing of fracture"),
              std::string::npos);
  }
  auto const scattered = [](std::string const& keys) -> std::string {
    try {
      Block(2, "", ", scatter = { " + keys + " }");
    } catch (Error const& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(scattered("modulus = 0.1").find("modulus = 0.1"), std::string::npos);
  EXPECT_NE(scattered("seed = 1").find("modulus is missing"), std::string::npos);
  EXPECT_NE(scattered("modulus = 5, seed = 0.5").find("must be a whole number"), std::string::npos);
  EXPECT_NE(scattered("modulus = 5, area = 0").find("area = 0"), std::string::npos);
}
