// Meshes of shapes: measures against closed form, topology, order, names, and what is refused in which words.
#include <complex>
#include <numbers>
#include <regex>

#include "../../src2d/shapes.h"
#include "../../src3d/shapes.h"
#include "mesh_checks.h"

using namespace fissure;
using namespace fissure::mesh;
using namespace fissure::mesh::testing;

namespace {

scene::Box const brick{{0.5, 1, 0.2}, {1, 2, 0.4}};
scene::Disc const coin{{0, 0, 0}, 1, 0.4};

}  // namespace

// ------------------------------------------------------------------------------------------------------- one simplex
TEST(Simplex, KnowsMeasureShapeAndFacesOfTheUnitSimplices) {
  std::vector<Vec3> const p{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  std::vector<int> const corner{0, 1, 2, 3};
  Simplex const triangle(std::vector{0, 1, 2}, p), tet(corner, p);
  EXPECT_DOUBLE_EQ(triangle.measure(), 0.5);
  EXPECT_DOUBLE_EQ(tet.measure(), 1.0 / 6);
  EXPECT_NEAR(triangle.shape(), 2 * (1 - std::sqrt(0.5)) / std::sqrt(0.5), 1e-14);  // r = 1 - 1/sqrt2, R = 1/sqrt2
  EXPECT_NEAR(tet.shape(), 3 / (3 + std::sqrt(3)) / (std::sqrt(3) / 2), 1e-14);     // r = 1/(3 + sqrt3), R = sqrt3/2
  EXPECT_EQ(triangle.face_vector(0), Vec3(1, 1, 0));
  EXPECT_EQ(triangle.face_vector(2), Vec3(0, -1, 0));
  EXPECT_EQ(tet.face_vector(0), Vec3(0.5, 0.5, 0.5));
  EXPECT_EQ(tet.face_vector(3), Vec3(0, 0, -0.5));
}

TEST(Simplex, HasShapeOneWhenRegular) {
  std::vector<Vec3> const p{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  EXPECT_NEAR(Simplex(std::vector{0, 1, 2, 3}, p).shape(), 1, 1e-14);
  std::vector<Vec3> const q{{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(0.75), 0}};
  EXPECT_NEAR(Simplex(std::vector{0, 1, 2}, q).shape(), 1, 1e-14);
}

// -------------------------------------------------------------------------------------------------- structured boxes
TEST(StructuredBox, HasTheCountsOfAGrid) {
  Mesh const flat = structured_box(CellKind::triangle, {0, 0, 0}, {2, 3, 0}, 0.5);
  EXPECT_EQ(flat.n_cells(), 2 * 4 * 6);
  EXPECT_EQ(flat.nodes.size(), 5u * 7u);
  EXPECT_DOUBLE_EQ(quality(flat)[0].measure, 6);
  Mesh const solid = structured_box(CellKind::tetrahedron, {0, 0, 0}, {1, 1, 1}, 1.0 / 16);
  EXPECT_EQ(solid.n_cells(), 24576);
  EXPECT_EQ((solid.cells.size() - solid.boundary.size()) / 2, 47616u);  // inner faces
  EXPECT_NEAR(quality(solid)[0].measure, 1, 1e-11);
}

TEST(StructuredBox, IsSoundForOddAndEvenCounts) {
  for (double spacing : {1.0, 0.5, 0.34, 0.25}) {
    Mesh const flat = structured_box(CellKind::triangle, {1, 2, 0}, {1, 1.5, 0}, spacing);
    expect_sound(flat);
    EXPECT_EQ(euler_characteristic(flat), 1);
    Mesh const solid = structured_box(CellKind::tetrahedron, {1, 2, 3}, {1, 1.5, 0.7}, spacing);
    expect_sound(solid);
    EXPECT_EQ(euler_characteristic(solid), 1);
  }
}

TEST(StructuredBox, IsItsOwnMirrorImageWhenCountsAreEven) {
  for (CellKind kind : {CellKind::triangle, CellKind::tetrahedron}) {
    Mesh const mesh = structured_box(kind, {0, 0, 0}, {1, 1, 1}, 0.25);
    auto const cells = [&](double mirror) {
      std::multiset<std::vector<double>> all;
      for (int c = 0; c < mesh.n_cells(); ++c) {
        Vec3 p = simplex(mesh, c).centroid();
        p.x() *= mirror;
        all.insert({std::round(p.x() * 1e9) + 0.0, std::round(p.y() * 1e9) + 0.0, std::round(p.z() * 1e9) + 0.0});
      }
      return all;
    };
    EXPECT_EQ(cells(1), cells(-1));
  }
}

TEST(StructuredBox, KeepsNeighboursNearInMemory) {
  Mesh const mesh = structured_box(CellKind::tetrahedron, {0, 0, 0}, {1, 1, 1}, 1.0 / 16);
  std::vector<int> const across = neighbours(mesh);
  int inner = 0, near = 0;
  for (int use = 0; use < static_cast<int>(across.size()); ++use) {
    if (across[use] < 0) continue;
    ++inner;
    near +=
        std::abs(across[use] - use / 4) <= 64;  // a few cache lines; in rows of the grid a third are 96 or more away
  }
  EXPECT_GT(near, 0.75 * inner);
}

// ------------------------------------------------------------------------------------------------- unstructured shapes
struct Case {
  char const* name;
  scene::Shape shape;
  double area, volume, error;
  int euler_2d, euler_3d;
};

void PrintTo(Case const& one, std::ostream* to) { *to << one.name; }  // else a test's name has bytes of memory in it

class Shapes : public ::testing::TestWithParam<Case> {};

TEST_P(Shapes, HaveTheirAreaAndVolumeAndAClosedBoundary) {
  Case const& c = GetParam();
  double const h = 0.1;
  Mesh const flat = mesh_of(mesher_2d(), c.shape, h), solid = mesh_of(mesher_3d(), c.shape, h);
  EXPECT_EQ(flat.kind, CellKind::triangle);
  EXPECT_EQ(solid.kind, CellKind::tetrahedron);
  EXPECT_NEAR(total_measure(flat), c.area, c.error * c.area + 1e-12);
  EXPECT_NEAR(total_measure(solid), c.volume, 2.5 * c.error * c.volume + 1e-12);
  expect_sound(flat);
  expect_sound(solid);
  EXPECT_EQ(euler_characteristic(flat), c.euler_2d);
  EXPECT_EQ(euler_characteristic(solid), c.euler_3d);
  EXPECT_GT(quality(flat)[0].least_shape, 0.3);
  EXPECT_GT(quality(solid)[0].least_shape, 0.1);
  EXPECT_NEAR(quality(flat)[0].mean_edge, h, 0.2 * h);
  EXPECT_NEAR(quality(solid)[0].mean_edge, h, 0.35 * h);  // tetrahedra do not fill space: inner edges are longer
}

// A chord of length h cuts h^2/6r^2 of a circle's area in leading order; a surface of triangles cuts more of a ball.
INSTANTIATE_TEST_SUITE_P(
    All, Shapes,
    ::testing::Values(
        Case{"box", shape(brick), 2, 0.8, 0, 1, 1}, Case{"disc", shape(coin), pi, 0.4 * pi, 0.01 / 6, 1, 1},
        Case{"rod", shape(scene::Rod{{0, 0, 0}, 0.5, 1}), 1, pi / 4, 0.01 / 1.5, 1, 1},
        Case{"ball", shape(scene::Ball{{0, 0, 0}, 0.5}), pi / 4, pi / 6, 0.01 / 1.5, 1, 1},
        Case{"ring", shape(scene::Ring{{0, 0, 0}, 0.5, 1, 0.4}), 0.75 * pi, 0.3 * pi, 0.01 / 6, 0, 0},
        Case{"polygon", shape(scene::Polygon{{{0, 0}, {1, 0}, {1, 1}, {0.5, 0.5}, {0, 1}}, 0.4}), 0.75, 0.3, 0, 1, 1},
        Case{"notched", shape(scene::Difference{{shape(brick), shape(scene::Notch{{0, 1}, {0.5, 1}, 0.05})}}),
             2 - 0.025, 0.4 * (2 - 0.025), 0, 1, 1},
        Case{"slotted", shape(scene::Difference{{shape(brick), shape(scene::Notch{{0.3, 0.8}, {0.7, 1.2}, 0.1})}}),
             2 - 0.04 * std::sqrt(2), 0.4 * (2 - 0.04 * std::sqrt(2)), 0, 0, 0},
        Case{"nested",
             shape(scene::Difference{{shape(scene::Union{{shape(brick), shape(scene::Box{{1, 1, 0.2}, {1, 1, 0.4}})}}),
                                      shape(scene::Disc{{1, 1, 0.2}, 0.25, 2})}}),
             2.5 - pi / 16, 0.4 * (2.5 - pi / 16), 0.01 / 4, 0, 0}),
    [](auto const& test) { return test.param.name; });

TEST(Booleans, FillEveryPlaceOnce) {
  auto const box = [](double x, double y, double width, double height) {
    return shape(scene::Box{{x, y, 0}, {width, height, 1}});
  };
  auto const disc = [](double x, double y, double radius) { return shape(scene::Disc{{x, y, 0}, radius, 1}); };
  auto const together = [](std::vector<scene::Shape> parts) { return shape(scene::Union{std::move(parts)}); };
  auto const without = [](std::vector<scene::Shape> parts) { return shape(scene::Difference{std::move(parts)}); };
  scene::Shape const square = box(0, 0, 2, 2), ring = shape(scene::Ring{{0, 0, 0}, 0.5, 1, 1});
  struct {
    char const* name;
    scene::Shape shape;
    double area;       // and volume: all are 1 thick
    double round = 0;  // of it: within arcs of radius 0.5, whose chords of length 0.25 leave out h^2/6r^2 = 4.2 %
  } const cases[] = {
      {"side by side", together({square, box(2, 0, 2, 2)}), 8},
      {"sides of other lengths", together({square, box(2, 0, 2, 1)}), 6},
      {"the smaller first", together({box(2, 0, 2, 1), square}), 6},
      {"one inside another", together({square, box(0, 0, 1, 1)}), 4},
      {"inside, at a side", together({square, box(0.5, 0, 1, 1)}), 4},
      {"twice the same", together({square, square}), 4},
      {"apart", together({square, box(4, 0, 2, 2)}), 8},
      {"two that touch and one apart", together({box(5, 0, 2, 2), square, box(2, 0, 2, 2), box(5, 0, 1, 1)}), 12},
      {"a row of four", together({square, box(2, 0, 2, 2), box(4, 0, 2, 2), box(6, 0, 2, 2)}), 16},
      {"one in the notch of two", together({square, box(2, 2, 2, 2), box(2, -0.25, 2, 2.5), box(0, 2, 0.5, 0.5)}),
       13.25},
      {"a disc in a box", together({square, disc(0, 0, 0.5)}), 4},
      {"a disc that fills a ring", together({ring, disc(0, 0, 0.5)}), pi, pi},
      {"a disc within a ring's hole", together({ring, disc(0, 0, 0.25)}), pi * (1 - 0.25 + 0.0625), pi},
      {"two discs apart", together({disc(0, 0, 0.5), disc(2, 0, 0.5)}), pi / 2, pi / 2},
      {"a hole that is filled", together({without({square, disc(0, 0, 0.5)}), disc(0, 0, 0.5)}), 4},
      {"two triangles",
       together(
           {shape(scene::Polygon{{{0, 0}, {2, 0}, {0, 2}}, 1}), shape(scene::Polygon{{{2, 0}, {2, 2}, {0, 2}}, 1})}),
       4},
      {"a union of unions", together({together({square, box(2, 0, 2, 2)}), box(1, 2, 4, 2)}), 16},
      {"a union with a hole", without({together({square, box(2, 0, 2, 2)}), disc(1, 0, 0.5)}), 8 - pi / 4, pi / 4},
      {"without a union", without({square, together({box(-0.25, 0, 0.5, 0.5), box(0.25, 0, 0.5, 0.5)})}), 3.5},
  };
  for (auto const& one : cases)
    for (Mesher const* mesher : {&mesher_2d(), &mesher_3d()}) {
      Mesh const mesh = mesh_of(*mesher, one.shape, 0.25);
      EXPECT_NEAR(total_measure(mesh), one.area, 1e-9 + 0.042 * one.round)
          << one.name << " in " << node_count(mesh.kind) - 1 << "D";
      expect_sound(mesh);
    }
}

// --------------------------------------------------------------------------------------------------------------- start
namespace {

/// A cube of edge 1 about the origin and another of the same size at `place`, cut like it.
scene::Scene two_cubes(Vec3 const& place, double size = 0.5) {
  scene::Scene scene = scene_of(shape(scene::Box{{0, 0, 0}, {1, 1, 1}}), size);
  scene.bodies.push_back(scene.bodies[0]);
  scene.bodies[1].name = "other";
  scene.bodies[1].shape = shape(scene::Box{place, {1, 1, 1}});
  for (auto& body : scene.bodies) body.mesh.structured = true;
  return scene;
}

}  // namespace

TEST(Start, NamesBodiesThatOverlapWithTheirDepth) {
  for (Mesher const* mesher : {&mesher_2d(), &mesher_3d()}) {
    auto const said = [&](scene::Scene const& scene) {
      auto const lines = starting_contact(scene, make_mesh(scene, *mesher)).overlaps;
      return lines.empty() ? "" : lines[0].substr(0, lines[0].find(" at the start"));
    };
    EXPECT_EQ(said(two_cubes({0.1, 0.9, 0.1})), "scene.lua:7: body \"part\" and body \"other\" overlap by 0.1 m");
    EXPECT_EQ(said(two_cubes({1 - 1e-4, 0, 0})), "scene.lua:7: body \"part\" and body \"other\" overlap by 0.0001 m");
    EXPECT_EQ(said(two_cubes({1, 0, 0})), "");  // they touch
    EXPECT_EQ(said(two_cubes({1.0 / 3 + 2.0 / 3, 0.3, 0})), "");
    EXPECT_EQ(said(two_cubes({1.1, 0, 0})), "");
    EXPECT_NE(said(two_cubes({0, 0, 0})), "");         // one is exactly where the other is
    scene::Scene inside = two_cubes({0, 0, 0}, 0.25);  // one inside the other
    inside.bodies[1].shape = shape(scene::Box{{0, 0, 0}, {0.2, 0.2, 0.2}});
    EXPECT_NE(said(inside), "");
    // a cross of two bars of one element each: no node lies in the other
    scene::Scene crossing = two_cubes({0, 0, 0}, 10);
    crossing.bodies[0].shape = shape(scene::Box{{0, 0, 0}, {3, 1, 1}});
    crossing.bodies[1].shape = shape(scene::Box{{0, 0, 0}, {1, 3, 1}});
    EXPECT_NE(said(crossing), "");
    scene::Scene untouchable = two_cubes({0.5, 0, 0});
    untouchable.contact = false;
    EXPECT_EQ(said(untouchable), "");
  }
}

TEST(Start, NamesPlatesAndWallsThatOverlapOrTouchNothing) {
  for (Mesher const* mesher : {&mesher_2d(), &mesher_3d()}) {
    auto const judged = [&](scene::Box const& box, double wall) {
      scene::Scene scene = scene_of(shape(scene::Box{{0, 0, 0}, {1, 1, 1}}), 0.5);
      scene.plates.push_back({"punch", at, box, {}, {}});
      scene.walls.push_back({"floor", at, {0, wall, 0}, {0, 1, 0}, {}});
      return starting_contact(scene, make_mesh(scene, *mesher));
    };
    auto const touching = judged({{0, 0.75, 0}, {2, 0.5, 2}}, -0.5);
    EXPECT_TRUE(touching.overlaps.empty() && touching.gaps.empty());
    auto const apart = judged({{0, 1.75, 0}, {2, 0.5, 2}}, -0.75);
    EXPECT_TRUE(apart.overlaps.empty());
    EXPECT_EQ(apart.gaps,
              (std::vector<std::string>{"plate \"punch\" touches nothing: body \"part\" is nearest, 1 m away",
                                        "wall \"floor\" touches nothing: body \"part\" is nearest, 0.25 m away"}));
    auto const deep = judged({{0, 0.7, 0}, {2, 0.5, 2}}, -0.4);
    ASSERT_EQ(deep.overlaps.size(), 2u);
    EXPECT_EQ(deep.overlaps[0].substr(0, 60), "scene.lua:7: plate \"punch\" and body \"part\" overlap by 0.05 m");
    EXPECT_EQ(deep.overlaps[1].substr(0, 58), "scene.lua:7: wall \"floor\" and body \"part\" overlap by 0.1 m");
    // thinner than an edge, so that no node lies in it
    auto const thin = judged({{0.13, 0.7, 0.11}, {0.01, 0.5, 0.01}}, -0.5);
    ASSERT_EQ(thin.overlaps.size(), 1u);
    EXPECT_NE(thin.overlaps[0].find("overlap by 0.05 m"), std::string::npos);
    // nearest to a face, far from its nodes
    auto const slender = judged({{0.13, 0.85, 0.11}, {0.01, 0.5, 0.01}}, -0.5);
    ASSERT_EQ(slender.gaps.size(), 1u);
    EXPECT_NE(slender.gaps[0].find("0.1 m away"), std::string::npos);
  }
}

TEST(Convex, TellsHollowBodiesFromRoundOnes) {
  scene::Shape const open =
      shape(scene::Difference{{shape(scene::Ring{{0, 0, 0}, 0.5, 1, 0.4}), shape(scene::Box{{1, 0, 0}, {1, 0.4, 1}})}});
  scene::Shape const stair = shape(scene::Polygon{{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 0.4});
  scene::Shape const slit = shape(scene::Difference{{shape(brick), shape(scene::Notch{{0.5, 2.1}, {0.5, 1}, 0.004})}});
  scene::Shape const hollow =
      shape(scene::Difference{{shape(scene::Ball{{0, 0, 0}, 1}), shape(scene::Ball{{0, 0, 0}, 0.5})}});
  for (Mesher const* mesher : {&mesher_2d(), &mesher_3d()}) {
    for (double h : {0.3, 0.1})
      for (auto const& s :
           {shape(brick), shape(coin), shape(scene::Ball{{0, 0, 0}, 0.5}), shape(scene::Rod{{0, 0, 0}, 0.5, 1})})
        EXPECT_TRUE(convex(mesh_of(*mesher, s, h), 0)) << s.is.index() << " " << h;
    for (auto const& s : {open, stair, slit, hollow, shape(scene::Ring{{0, 0, 0}, 0.5, 1, 0.4})})
      EXPECT_FALSE(convex(mesh_of(*mesher, s, 0.2), 0)) << s.is.index();
  }
}

TEST(Mesh, ReachesTheExtremesOfRoundBodiesExactly) {
  for (Mesher const* mesher : {&mesher_2d(), &mesher_3d()})
    for (scene::Shape const& s : {shape(scene::Ball{{0, 0, 0}, 1}), shape(coin)}) {
      Mesh const mesh = mesh_of(*mesher, s, 0.2);
      double least = 0, most = 0;
      for (Vec3 const& p : mesh.nodes) least = std::min(least, p.y()), most = std::max(most, p.y());
      EXPECT_NEAR(most, 1, 1e-9);
      EXPECT_NEAR(least, -1, 1e-9);
    }
}

TEST(Mesh, IsTheSameEveryTimeAndAnotherForAnotherSeed) {
  for (Mesher const* mesher : {&mesher_2d(), &mesher_3d()}) {
    Mesh const first = mesh_of(*mesher, shape(coin), 0.15);
    Mesh const seeded = mesh_of(*mesher, shape(coin), 0.15, 1);
    EXPECT_TRUE(same(first, mesh_of(*mesher, shape(coin), 0.15)));
    EXPECT_TRUE(same(seeded, mesh_of(*mesher, shape(coin), 0.15, 1)));
    EXPECT_FALSE(same(first, seeded));
    EXPECT_FALSE(same(seeded, mesh_of(*mesher, shape(coin), 0.15, 2)));
    EXPECT_NEAR(quality(seeded)[0].mean_edge, quality(first)[0].mean_edge, 0.05 * quality(first)[0].mean_edge);
    expect_sound(seeded);
  }
}

TEST(Mesh, OfAThinDiscHasNoSlivers) {
  // One element thick: Gmsh's first answer to some of these has tetrahedra that are flat to three digits.
  for (double radius : {10e-3, 12e-3, 14e-3, 16e-3, 18e-3, 20e-3})
    EXPECT_GT(quality(mesh_of(mesher_3d(), shape(scene::Disc{{0, 0, 0}, radius, 1e-3}), 1e-3))[0].least_shape, 0.1)
        << radius;
}

// A box with a slit so narrow that every mesher has to make slivers at its ends.
scene::Scene slit(double size) {
  return scene_of(shape(scene::Difference{{shape(scene::Box{{0, 0, 0}, {40e-3, 40e-3, 2e-3}}),
                                           shape(scene::Notch{{-10e-3, 0}, {10e-3, 0}, 0.02e-3})}}),
                  size);
}

TEST(Mesh, IsNoLatticeWhereSliversCannotBeAvoided) {
  // 1 when every edge has one of three directions, as those of the frontal method's equilateral triangles.
  auto const order = [](Mesh const& mesh) {
    std::complex<double> sum = 0;
    for (std::size_t c = 0; c < mesh.cells.size(); c += 3)
      for (int a = 0; a < 3; ++a) {
        Vec3 const edge = mesh.nodes[mesh.cells[c + (a + 1) % 3]] - mesh.nodes[mesh.cells[c + a]];
        sum += std::polar(1.0, 6 * std::atan2(edge.y(), edge.x()));
      }
    return std::abs(sum) / static_cast<double>(mesh.cells.size());
  };
  Mesh const mesh = make_mesh(slit(1e-3), mesher_2d());
  expect_sound(mesh);
  EXPECT_LT(quality(mesh)[0].least_shape, good_shape);
  EXPECT_LT(order(mesh), 0.3);
}

TEST(Mesh, WarnsOfSliversAndSaysWhatTheyCost) {
  scene::Scene const scene = slit(1e-3);
  Mesh const mesh = make_mesh(scene, mesher_2d());
  auto const said = warnings(scene, mesh);
  ASSERT_EQ(said.size(), 1u);
  Quality const q = quality(mesh)[0];
  EXPECT_NEAR(q.worst_altitude, 0.02e-3, 0.01e-3);
  EXPECT_NEAR(q.mean_altitude, 0.65e-3, 0.1e-3);
  EXPECT_EQ(said[0].rfind("scene.lua:7: body \"part\": cell " + std::to_string(q.worst_cell) + " near (", 0), 0u)
      << said[0];
  std::smatch times;
  ASSERT_TRUE(std::regex_search(said[0], times, std::regex("the time step is about ([0-9.]+) times shorter")))
      << said[0];
  EXPECT_NEAR(std::stod(times[1]), q.mean_altitude / q.worst_altitude, 1);
  EXPECT_TRUE(warnings(scene_of(shape(coin), 0.2), mesh_of(mesher_2d(), shape(coin), 0.2)).empty());
}

TEST(Mesh, HasFacesAlongAllOfASeam) {
  struct Case {
    scene::Seam seam;
    double length;  // of what lies inside the disc of radius 1
  };
  for (Case const& c : {Case{{{0, -1}, {0, 1}, {}}, 2}, Case{{{0, -2}, {0, 0.3}, {}}, 1.3},
                        Case{{{-0.5, 0.1}, {0.4, 0.35}, {}}, std::hypot(0.9, 0.25)}})
    for (Mesher const* mesher : {&mesher_2d(), &mesher_3d()}) {
      scene::Scene scene = scene_of(shape(coin), 0.15);
      scene.bodies[0].mesh.seams = {c.seam};
      Mesh const mesh = make_mesh(scene, *mesher);
      expect_sound(mesh);
      auto const& [from, to] = std::pair(Vec3(c.seam.from[0], c.seam.from[1], 0), Vec3(c.seam.to[0], c.seam.to[1], 0));
      double const whole = (to - from).norm();
      auto const on_seam = [&, from = from, to = to](Vec3 const& node) {
        Vec3 const p = Vec3(node.x(), node.y(), 0) - from;
        double const along = p.dot(to - from) / whole;
        return along > -1e-9 && along < whole + 1e-9 && p.cross(to - from).norm() < 1e-9 * whole;
      };
      EXPECT_NEAR(measure_of_inner_faces(mesh, on_seam),
                  c.length * (mesh.kind == CellKind::triangle ? 1 : coin.thickness), 1e-6);
    }
}

scene::Polygon round(int corners) {
  scene::Polygon polygon;
  for (int i = 0; i < corners; ++i)
    polygon.points.push_back({std::cos(2 * pi * i / corners), std::sin(2 * pi * i / corners)});
  polygon.thickness = 0.2;
  return polygon;
}

TEST(Mesh, GrowsInwardsFromAFineOutline) {
  int const n = 400;
  Mesh const flat = mesh_of(mesher_2d(), shape(round(n)), 0.5);
  EXPECT_NEAR(total_measure(flat), n / 2.0 * std::sin(2 * pi / n), 1e-9);
  EXPECT_LT(flat.n_cells(), 12 * n);  // edges of the outline everywhere would take 2.3*pi/(2*pi/n)^2, which is 29 000
  Quality const q = quality(flat)[0];
  EXPECT_NEAR(q.least_edge, 2 * pi / n, 0.5 * 2 * pi / n);
  EXPECT_GT(q.largest_edge, 0.2);
  EXPECT_GT(q.least_shape, 0.3);
}

/// However deep a prism is: were its edges along z counted, it had slivers as long as it is deep (mean shape 0.09).
TEST(Mesh, GrowsInwardsFromTheOutlineOfADeepPrism) {
  int const n = 200;
  auto deep = round(n);
  deep.thickness = 1;
  Mesh const mesh = mesh_of(mesher_3d(), shape(deep), 1);
  EXPECT_NEAR(total_measure(mesh), n / 2.0 * std::sin(2 * pi / n), 1e-9);
  Quality const q = quality(mesh)[0];
  EXPECT_GT(q.mean_shape, 0.4);
  EXPECT_GT(q.largest_edge, 0.3);
}

TEST(Mesh, OfASolidWithTooManyShortLinesIsRefusedBeforeMeshing) {
  auto deep = round(2001);
  deep.thickness = 1;
  EXPECT_NO_THROW(mesh_of(mesher_2d(), shape(deep), 1));
  try {
    mesh_of(mesher_3d(), shape(deep), 1);
    FAIL() << "meshed";
  } catch (Error const& error) {
    EXPECT_NE(std::string(error.what()).find("4002 of its lines"), std::string::npos) << error.what();
  }
}

TEST(Mesh, OfABodyOfNanometresIsThatOfMetresMadeSmall) {
  double const f = std::exp2(-30);
  for (Mesher const* mesher : {&mesher_2d(), &mesher_3d()})
    for (double const scale : {1.0, f, f * f}) {
      Mesh const mesh = mesh_of(*mesher,
                                shape(scene::Union{{shape(scene::Box{{0, 0, 0}, {2 * scale, scale, scale}}),
                                                    shape(scene::Disc{{scale, 0, 0}, 0.3 * scale, scale})}}),
                                0.25 * scale);
      int const d = node_count(mesh.kind) - 1;
      // chords on half a disc: 0.1 of its area
      EXPECT_NEAR(total_measure(mesh) / std::pow(scale, d), 2 + pi / 2 * 0.09, 0.02) << scale;
      expect_sound(mesh);
    }
}

TEST(Refusal, OfShapesOfManyParts) {
  std::vector<scene::Shape> parts, unions;
  for (int i = 0; i < 20; ++i) parts.push_back(shape(scene::Box{{0.5 * i, 0, 0}, {1, 1, 1}}));
  for (int i = 0; i < 30; ++i) unions.push_back(shape(scene::Union{parts}));
  parts.resize(600, parts[0]);
  for (auto const& many : {parts, unions})
    EXPECT_EQ(error_of([&] { mesh_of(mesher_2d(), shape(scene::Union{many}), 1); }),
              "scene.lua:7: the shape has more than 500 parts (OpenCASCADE would take too long); draw its outline as a "
              "polygon or read it with mesh_file");
}

TEST(Mesh, IsStillMadeAfterOneThatCouldNotBe) {
  EXPECT_EQ(
      error_of([] {
        mesh_of(mesher_3d(), shape(scene::Ball{{0, 0, 0}, 0.05}), 1);
      }),
      "scene.lua:7: body \"part\": Gmsh could not mesh the shape (No elements in volume 1); try another mesh size "
      "or a simpler shape");
  expect_sound(mesh_of(mesher_3d(), shape(scene::Ball{{0, 0, 0}, 0.05}), 0.02));
}

TEST(Mesh, KeepsBodiesApart) {
  scene::Scene two = scene_of(shape(brick), 0.3);
  two.bodies.push_back(two.bodies[0]);
  two.bodies[1].mesh.structured = true;
  Mesh const mesh = make_mesh(two, mesher_3d());
  ASSERT_EQ(mesh.n_bodies(), 2);
  expect_sound(mesh);
  EXPECT_EQ(quality(mesh).size(), 2u);
  EXPECT_NEAR(quality(mesh)[1].measure, 0.8, 1e-12);
  for (int c = 0; c < mesh.n_cells(); ++c)
    for (int a = 0; a < 4; ++a)
      EXPECT_EQ(mesh.cells[4 * c + a] >= mesh.body_first_node[1], c >= mesh.body_first_cell[1]);
  EXPECT_EQ(mesh.named_nodes[1].at("all").front(), mesh.body_first_node[1]);
}

TEST(Mesh, DescribesItselfInOneLine) {
  Mesh const mesh = structured_box(CellKind::triangle, {0, 0, 0}, {0.1, 0.1, 0}, 0.001);
  EXPECT_EQ(describe("plate", mesh.kind, quality(mesh)[0]),
            "plate: 20 000 triangles, 10 201 nodes, edges 1-1.41 mm (mean 1.14), worst shape 0.83 (cell " +
                std::to_string(quality(mesh)[0].worst_cell) + "), mean 0.83");
}

// -------------------------------------------------------------------------------------------------------- named places
TEST(Places, AreTheSidesOfABox) {
  for (bool structured : {false, true}) {
    scene::Scene scene = scene_of(shape(brick), 0.2);
    scene.bodies[0].mesh.structured = structured;
    Mesh const flat = make_mesh(scene, mesher_2d()), solid = make_mesh(scene, mesher_3d());
    for (char const* name : {"left", "right"}) {
      EXPECT_NEAR(measure_of(flat, name), 2, 1e-12);
      EXPECT_NEAR(measure_of(solid, name), 0.8, 1e-12);
    }
    for (char const* name : {"bottom", "top"}) {
      EXPECT_NEAR(measure_of(flat, name), 1, 1e-12);
      EXPECT_NEAR(measure_of(solid, name), 0.4, 1e-12);
    }
    for (char const* name : {"back", "front"}) {
      EXPECT_EQ(flat.named_nodes[0].count(name), 0u);
      EXPECT_NEAR(measure_of(solid, name), 2, 1e-12);
    }
    EXPECT_NEAR(measure_of(solid, "surface"), 2 * (2 + 0.8 + 0.4), 1e-12);
    for (int n : solid.named_nodes[0].at("top")) EXPECT_NEAR(solid.nodes[n].y(), 2, 1e-12);
    for (int n : solid.named_nodes[0].at("front")) EXPECT_NEAR(solid.nodes[n].z(), 0.4, 1e-12);
    EXPECT_EQ(solid.named_nodes[0].at("all").size(), solid.nodes.size());
    EXPECT_EQ(solid.named_faces[0].count("all"), 0u);
    for (auto const& [name, nodes] : solid.named_nodes[0])
      EXPECT_TRUE(std::is_sorted(nodes.begin(), nodes.end())) << name;
  }
}

TEST(Places, AreAStripAboutTheTopOfADisc) {
  Mesh const flat = mesh_of(mesher_2d(), shape(coin), 0.1);
  EXPECT_EQ(flat.named_nodes[0].at("top").size(), 3u);
  EXPECT_EQ(flat.named_faces[0].at("top").size(), 2u);
  Mesh const solid = mesh_of(mesher_3d(), shape(coin), 0.1);
  EXPECT_NEAR(measure_of(solid, "top"), 0.4 * 0.2, 0.4 * 0.1);
  EXPECT_NEAR(measure_of(solid, "front"), pi, 0.01);
}

TEST(Places, AreTheNodesOfATip) {
  Mesh const mesh = mesh_of(mesher_2d(), shape(scene::Polygon{{{0, 0}, {1, 0}, {0.3, 1}}, 0}), 0.1);
  ASSERT_EQ(mesh.named_nodes[0].at("top").size(), 1u);
  EXPECT_NEAR((mesh.nodes[mesh.named_nodes[0].at("top")[0]] - Vec3(0.3, 1, 0)).norm(), 0, 1e-12);
  EXPECT_EQ(mesh.named_faces[0].count("top"), 0u);
}

TEST(Places, LeaveOutTheLowerStepOfAStair) {
  scene::Shape const stair = shape(scene::Polygon{{{0, 0}, {1, 0}, {1, 0.99}, {0.5, 0.99}, {0.5, 1}, {0, 1}}, 0});
  EXPECT_NEAR(measure_of(mesh_of(mesher_2d(), stair, 0.2), "top"), 0.5, 1e-12);
}

// ----------------------------------------------------------------------------------------------------------- thickness
TEST(Thickness, IsTheScenesInThePlaneAndOneInSpace) {
  scene::Scene scene = scene_of(shape(coin), 0.5);
  scene.out_of_plane = 0.3;
  EXPECT_EQ(make_mesh(scene, mesher_2d()).thickness, 0.3);
  EXPECT_EQ(make_mesh(scene, mesher_3d()).thickness, 1);
}

// -------------------------------------------------------------------------------------------------------- axisymmetry
scene::Scene revolved(scene::Shape const& one, double size) {
  scene::Scene scene = scene_of(one, size);
  scene.two_d = "axisymmetric";
  return scene;
}

TEST(Axisymmetry, TakesTheRightHalfOfARodAndABall) {
  Mesh const rod = make_mesh(revolved(shape(scene::Rod{{0, 1, 0}, 2, 5, 3}), 0.5), mesher_2d());
  Mesh const ball = make_mesh(revolved(shape(scene::Ball{{0, 4, 0}, 2}), 0.2), mesher_2d());
  EXPECT_NEAR(total_measure(rod), 12.5, 1e-12);
  EXPECT_NEAR(total_measure(ball), std::numbers::pi * 2, 0.02);
  for (Mesh const* mesh : {&rod, &ball})
    for (auto const& x : mesh->nodes) EXPECT_GE(x[0], -1e-12);
  EXPECT_NEAR(total_measure(make_mesh(scene_of(shape(scene::Rod{{0, 1, 0}, 2, 5, 3}), 0.5), mesher_2d())), 25, 1e-12);
  EXPECT_EQ(make_mesh(revolved(shape(scene::Rod{{0, 1, 0}, 2, 5, 3}), 1), mesher_3d()).n_cells(),
            make_mesh(scene_of(shape(scene::Rod{{0, 1, 0}, 2, 5, 3}), 1), mesher_3d()).n_cells());
}

TEST(Axisymmetry, RefusesWhatHasAnotherAxis) {
  auto const refused = [](scene::Shape const& s) {
    return error_of([&] { make_mesh(revolved(s, 0.5), mesher_2d()); });
  };
  EXPECT_EQ(refused(shape(scene::Disc{{0, 0, 0}, 1, 1})),
            "scene.lua:7: disc: with two_d = \"axisymmetric\" everything turns about y, and a disc's axis is z; write "
            "rod{ radius, length }");
  EXPECT_EQ(refused(shape(scene::Ring{{0, 0, 0}, 1, 2, 1})),
            "scene.lua:7: ring: with two_d = \"axisymmetric\" everything turns about y, and a ring's axis is z; write "
            "difference{ rod{...}, rod{...} }, "
            "or a box at x > 0");
  EXPECT_EQ(refused(shape(scene::Ball{{1, 0, 0}, 2})),
            "scene.lua:7: ball: with two_d = \"axisymmetric\" it stands on the axis (its center is at x = 1 m); leave "
            "x at 0");
}

// ------------------------------------------------------------------------------------------------------------ refusals
TEST(Refusal, NamesTheShapeAndWhatIsWrongWithIt) {
  auto const two = [](scene::Shape const& s) { return error_of([&] { mesh_of(mesher_2d(), s, 0.1); }); };
  auto const three = [](scene::Shape const& s) { return error_of([&] { mesh_of(mesher_3d(), s, 0.1); }); };
  EXPECT_EQ(two(shape(scene::Disc{{0, 0, 0}, -1, 0})), "scene.lua:7: disc: radius must be a number above 0 (it is -1)");
  EXPECT_EQ(three(shape(scene::Disc{{0, 0, 0}, 1, 0})),
            "scene.lua:7: disc: thickness must be a number above 0 (it is 0)");
  EXPECT_EQ(three(scene::Shape{scene::Box{{0, 0, 0}, {1, 1, 0}}, {"shapes.lua", 3}}),
            "shapes.lua:3: box: size must be a number above 0 (it is 0)");
  EXPECT_EQ(two(shape(scene::Box{{NAN, 0, 0}, {1, 1, 1}})), "scene.lua:7: box: a coordinate is not a finite number");
  EXPECT_EQ(two(shape(scene::Ring{{0, 0, 0}, 2, 1, 0})),
            "scene.lua:7: ring: inner must be below outer (inner is 2, outer 1)");
  EXPECT_EQ(two(shape(scene::Polygon{{{0, 0}, {1, 0}}, 0})),
            "scene.lua:7: polygon: needs at least three corners (it has 2)");
  EXPECT_EQ(two(shape(scene::Polygon{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}, 0})),
            "scene.lua:7: polygon: sides 1 and 3 cross or touch");
  EXPECT_EQ(two(shape(scene::Polygon{{{0, 0}, {1, 0}, {0.5, 0}, {0, 1}}, 0})),
            "scene.lua:7: polygon: sides 1 and 2 lie on each other");
  EXPECT_EQ(two(shape(scene::Polygon{{{0, 0}, {0, 1}, {1, 0}}, 0})),
            "scene.lua:7: polygon: corners must go counter-clockwise (they go clockwise); reverse their order");
  EXPECT_EQ(
      two(shape(scene::Notch{{0, 0}, {1, 0}, 0.1})),
      "scene.lua:7: a notch is no body of its own (it is a slot to be taken away); write difference{ shape, notch }");
  EXPECT_EQ(two(shape(scene::Difference{{shape(coin), shape(scene::Notch{{0, 0}, {0, 0}, 0.1})}})),
            "scene.lua:7: notch: from and to are the same point (a notch needs a length)");
  EXPECT_EQ(two(shape(scene::Difference{{shape(coin), shape(scene::Disc{{0, 0, 0}, 2, 0})}})),
            "scene.lua:7: difference: nothing is left of the first shape (the others cover it)");
  EXPECT_EQ(two(shape(scene::Union{})), "scene.lua:7: union: has no parts");
  EXPECT_EQ(two(shape(scene::Union{{shape(scene::MeshFile{"a.msh"})}})),
            "scene.lua:7: a mesh file cannot be part of a union or difference (it is already meshed); use it as a "
            "body's shape");
}

TEST(Refusal, NamesTheMeshOptionAndWhatWouldDo) {
  auto const with = [](auto change, scene::Shape const& s = shape(brick)) {
    scene::Scene scene = scene_of(s, 0.1);
    change(scene.bodies[0].mesh);
    return error_of([&] { make_mesh(scene, mesher_2d()); });
  };
  using Spec = scene::MeshSpec;
  std::string const body = "scene.lua:7: body \"part\": ";
  EXPECT_EQ(with([](Spec& m) { m.cells = "hex"; }), body +
                                                        "cells = \"hex\" is not for this program (its cells are "
                                                        "\"tri\" and \"quad\"); write \"block\", which fits both");
  EXPECT_EQ(with([](Spec& m) { m.cells = "tet"; }), body +
                                                        "cells = \"tet\" is not for this program (its cells are "
                                                        "\"tri\" and \"quad\"); write \"simplex\", which fits both");
  EXPECT_EQ(with([](Spec& m) { m.cells = "simplx"; }), body + "unknown cells \"simplx\"; did you mean \"simplex\"?");
  EXPECT_EQ(with([](Spec& m) { m.size = 0; }), body + "mesh size must be a number above 0 (it is 0)");
  EXPECT_EQ(with([](Spec& m) { m.structured = true; }, shape(coin)),
            body + "structured = true needs a box (other shapes have no regular grid); leave structured out");
  EXPECT_EQ(with([](Spec& m) { m.structured = true, m.seed = 1; }),
            body + "seed has no meaning with structured = true (a regular grid is not random); leave one out");
  EXPECT_EQ(with([](Spec& m) {
              m.structured = true, m.seams = {{{0, 0}, {0, 1}, {}}};
            }),
            body + "seam and structured = true exclude each other (a regular grid has its own lines); leave one out");
  EXPECT_EQ(with([](Spec& m) {
              m.irregular = 0.2, m.seams = {{{0, 0}, {0, 1}, {}}};
            }),
            body + "seam and irregular exclude each other (its nodes would be moved); leave one out");
  std::string most = std::to_string(most_cells());  // fewer on a machine with little memory
  most.resize(static_cast<std::size_t>(std::snprintf(most.data(), most.size() + 1, "%.2g", most_cells())));
  auto const too_many = [&](std::string const& said, std::string const& cells, double least, double largest) {
    std::string const begin =
        body + "its mesh would have about " + cells + " cells (at most " + most + " are possible); mesh sizes about ";
    EXPECT_EQ(said.substr(0, begin.size()), begin);
    double const times = std::strtod(said.c_str() + std::min(said.size(), begin.size()), nullptr);
    EXPECT_TRUE(least <= times && times <= largest) << said;
  };
  double const room = 50e6 / most_cells();  // 1 on a machine with much memory
  for (bool structured : {false, true})
    too_many(with([=](Spec& m) { m.size = 1e-4, m.structured = structured; }), structured ? "4e+08" : "5.2e+08",
             2.8 * std::sqrt(room), 4 * std::sqrt(room));
  // edges along a line
  too_many(with([](Spec&) {}, shape(scene::Box{{0, 0, 0}, {1e8, 1e-3, 0}})), "2e+09", 40 * room, 48 * room);
}

TEST(Refusal, CountsTheCellsOfAllBodiesBeforeTheFirstIsMeshed) {
  for (Mesher const* mesher : {&mesher_2d(), &mesher_3d()})
    for (auto const& one : {shape(scene::Box{{0, 0, 0}, {1, 1, 1}}), shape(scene::Disc{{0, 0, 0}, 0.6, 1}),
                            shape(scene::Ball{{0, 0, 0}, 0.65}), shape(scene::Rod{{0, 0, 0}, 0.6, 1}),
                            shape(scene::Ring{{0, 0, 0}, 0.1, 0.6, 1})}) {
      double const per_body = most_cells() / 3;  // each would be accepted, and take minutes
      scene::Scene scene =
          scene_of(one, std::pow(mesher->cells_per_size() / per_body, 1.0 / (node_count(mesher->kind()) - 1)));
      for (int i = 0; i < 3; ++i) scene.bodies.push_back(scene.bodies[0]);
      EXPECT_NE(error_of([&] { make_mesh(scene, *mesher); }).find("the bodies up to this one would have about"),
                std::string::npos);
    }
}

TEST(Refusal, OfASeamThatIsNotInside) {
  auto const with = [](scene::Seam const& seam, Mesher const& mesher, char const* cells = "simplex") {
    scene::Scene scene = scene_of(shape(brick), 0.25);
    scene.bodies[0].mesh.seams = {seam}, scene.bodies[0].mesh.cells = cells;
    return error_of([&] { make_mesh(scene, mesher); });
  };
  for (Mesher const* mesher : {&mesher_2d(), &mesher_3d()}) {
    EXPECT_EQ(with({{2, 0}, {2, 1}, {}}, *mesher), "scene.lua:7: seam: no part of it lies inside the body");
    for (scene::Seam const& edge :
         {scene::Seam{{0, 0}, {0, 2}, {}}, scene::Seam{{0, 0.5}, {0, 1}, {}}, scene::Seam{{-1, 2}, {3, 2}, {}}})
      EXPECT_EQ(with(edge, *mesher),
                "scene.lua:7: seam: it lies on the body's boundary (where the mesh has faces anyway); leave it out or "
                "move it inside");
    EXPECT_EQ(with({{0, 0}, {0.5, 1}, {}}, *mesher), "no error");
    EXPECT_EQ(with({{0, 0.7}, {1, 1.3}, {}}, *mesher, "block"), "no error");
    for (scene::Seam const& end : {scene::Seam{{0, 0}, {0.5, 1}, {}}, scene::Seam{{0.3, 1}, {0.7, 1}, {}}}) {
      SCOPED_TRACE(::testing::Message() << node_count(mesher->kind()) << " nodes, from " << end.from[0]);
      EXPECT_EQ(with(end, *mesher, "block"),
                "scene.lua:7: seam: it ends inside the body, and a mesh of blocks has no faces along such a line; lead "
                "it from side to side, or take cells = \"simplex\"");
    }
  }
}

class Broken : public ::testing::Test {
 protected:
  std::string error() {
    Mesh mesh = no_bodies(CellKind::triangle);
    return error_of([&] { add_body(mesh, part, "part", at); });
  }
  Part part{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {0, 1, 2, 1, 3, 2}, "", {}, {}, {}, {}};
};

TEST_F(Broken, BlocksThatTurnTheOtherWayAreTurned) {
  part.cells.clear();
  part.blocks = {0, 2, 3, 1};
  Mesh mesh = no_bodies(CellKind::triangle);
  add_body(mesh, part, "part", at);
  expect_sound(mesh);
  EXPECT_EQ(mesh.n_blocks(0), 1);
  EXPECT_EQ(mesh.n_simplices(0), 0);
}

TEST_F(Broken, FoldedBlocksAreRefused) {
  part.cells.clear();
  part.blocks = {0, 1, 3, 2};
  part.nodes[3] = {0.2, 0.2, 0};
  EXPECT_EQ(error(),
            "scene.lua:7: body \"part\": block 0 near (0.3, 0.3, 0) is folded or flat (its least scaled Jacobian is "
            "-0.88, a box has 1); "
            "another mesh size or seed, or cells = \"simplex\"?");
}

TEST_F(Broken, NothingIsRefusedInAGoodMesh) { EXPECT_EQ(error(), "no error"); }

TEST_F(Broken, CellsThatTurnTheOtherWayAreTurned) {
  part.cells = {0, 2, 1, 1, 3, 2};
  Mesh mesh = no_bodies(CellKind::triangle);
  add_body(mesh, part, "part", at);
  expect_sound(mesh);
}

TEST_F(Broken, FlatCellsAreRefused) {
  part.nodes[3] = {2, -1, 0};
  EXPECT_EQ(error(),
            "scene.lua:7: body \"part\": cell 1 near (1, 0, 0) is degenerate (its radius ratio is 0, "
            "a regular one has 1); repair the mesh");
}

TEST_F(Broken, DoubledCellsAreRefused) {
  part.cells = {0, 1, 2, 1, 3, 2, 3, 2, 1};
  EXPECT_EQ(
      error(),
      "scene.lua:7: body \"part\": cell 1 near (0.6667, 0.6667, 0) and cell 2 near (0.6667, 0.6667, 0) have the same "
      "corners; remove one of them");
}

TEST_F(Broken, ThreeCellsAtAFaceAreRefused) {
  part.nodes.push_back({2, 2, 0});
  part.cells = {0, 1, 2, 1, 3, 2, 1, 4, 2};
  EXPECT_EQ(
      error(),
      "scene.lua:7: body \"part\": more than two cells share a face (cell 0 near (0.3333, 0.3333, 0), cell 1 near "
      "(0.6667, 0.6667, 0) and cell 2 near (1, 1, 0)); repair the mesh");
}

TEST_F(Broken, FoldedCellsAreRefused) {
  part.nodes[3] = {0.2, 0.2, 0};
  EXPECT_EQ(
      error(),
      "scene.lua:7: body \"part\": cell 0 near (0.3333, 0.3333, 0) and cell 1 near (0.4, 0.4, 0) overlap (both lie on "
      "the same side of the face they share); repair the mesh");
}

TEST_F(Broken, NodesOutOfRangeAreRefused) {
  part.cells[4] = 4;
  EXPECT_EQ(error(), "scene.lua:7: body \"part\": cell 1 uses node 4, but the mesh has 4 nodes");
}

TEST_F(Broken, CoordinatesThatAreNoNumbersAreRefused) {
  part.nodes[2].y() = NAN;
  EXPECT_EQ(error(), "scene.lua:7: body \"part\": node 2 of its mesh has a coordinate that is not a number");
}

TEST_F(Broken, AnEmptyMeshIsRefused) {
  part.cells.clear();
  EXPECT_EQ(
      error(),
      "scene.lua:7: body \"part\": its mesh has no cells (the shape may be empty or far smaller than its mesh size)");
}

TEST_F(Broken, NodesOfNoCellAreDropped) {
  part.nodes.insert(part.nodes.begin(), {9, 9, 9});
  for (int& n : part.cells) ++n;
  Mesh mesh = no_bodies(CellKind::triangle);
  add_body(mesh, part, "part", at);
  EXPECT_EQ(mesh.nodes.size(), 4u);
  expect_sound(mesh);
}
