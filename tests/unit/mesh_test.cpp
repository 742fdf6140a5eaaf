// Meshes of shapes and files: measures against closed form, topology, order, names, and what is refused in which words.
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "../../src2d/shapes.h"
#include "../../src3d/shapes.h"
#include "mesh/msh_file.h"
#include "mesh/part.h"
#include "mesh/simplex.h"

using namespace fissure;
using namespace fissure::mesh;

namespace {

double const pi = std::acos(-1.0);
Source const at{"scene.lua", 7};

template <class Primitive>
scene::Shape shape(Primitive primitive) {
  return {primitive, {}};
}

scene::Scene scene_of(scene::Shape const& one, double size, unsigned seed = 0) {
  scene::Body body;
  body.name = "part";
  body.source = at;
  body.shape = one;
  body.mesh.size = size;
  body.mesh.seed = seed;
  scene::Scene scene;
  scene.bodies.push_back(body);
  return scene;
}

Mesh mesh_of(Mesher const& mesher, scene::Shape const& one, double size, unsigned seed = 0) {
  return make_mesh(scene_of(one, size, seed), mesher);
}

template <class Call>
std::string error_of(Call const& call) {
  try {
    call();
  } catch (Error const& error) {
    return error.what();
  }
  return "no error";
}

Simplex simplex(Mesh const& mesh, int c) {
  int const corners = node_count(mesh.kind);
  return Simplex(std::span(mesh.cells).subspan(std::size_t(c) * corners, corners), mesh.nodes);
}

double total_measure(Mesh const& mesh) {
  double sum = 0;
  for (Quality const& q : quality(mesh)) sum += q.measure;
  return sum;
}

/// Vertices - edges + faces - cells: 1 for a ball or a disc, 0 with one hole.
int euler_characteristic(Mesh const& mesh) {
  int const corners = node_count(mesh.kind);
  std::set<std::set<int>> parts;
  for (int c = 0; c < mesh.n_cells(); ++c)
    for (int mask = 1; mask < 1 << corners; ++mask) {
      std::set<int> part;
      for (int a = 0; a < corners; ++a)
        if (mask >> a & 1) part.insert(mesh.cells[c * corners + a]);
      parts.insert(part);
    }
  int sum = 0;
  for (auto const& part : parts) sum += part.size() % 2 ? 1 : -1;
  return sum;
}

/// What must hold for every mesh, whatever its shape.
void expect_sound(Mesh const& mesh) {
  int const corners = node_count(mesh.kind);
  ASSERT_EQ(mesh.body_first_cell.back(), mesh.n_cells());
  ASSERT_EQ(mesh.body_first_node.back(), static_cast<int>(mesh.nodes.size()));
  int next = 0;
  for (int n : mesh.cells) {
    ASSERT_LE(n, next) << "nodes are numbered by first use";
    next = std::max(next, n + 1);
  }
  ASSERT_EQ(next, static_cast<int>(mesh.nodes.size()));
  for (int c = 0; c < mesh.n_cells(); ++c) ASSERT_GT(simplex(mesh, c).measure(), 0) << c;

  std::vector<int> const across = neighbours(mesh);
  ASSERT_EQ(across.size(), mesh.cells.size());
  std::size_t open = 0;
  Vec3 sum = Vec3::Zero();
  double area = 0;
  for (std::size_t use = 0; use < across.size(); ++use) {
    int const c = static_cast<int>(use) / corners, a = static_cast<int>(use) % corners;
    if (across[use] < 0) {
      ASSERT_EQ(mesh.boundary[open].cell, c) << "boundary faces are ordered by cell";
      Vec3 const normal = simplex(mesh, c).face_vector(a);
      EXPECT_GT(normal.dot(simplex(mesh, c).point[(a + 1) % corners] - simplex(mesh, c).point[a]), 0) << "outward";
      // The face's own order of nodes gives the same normal.
      auto const& n = mesh.boundary[open].node;
      Vec3 const e = mesh.nodes[n[1]] - mesh.nodes[n[0]];
      Vec3 const own = corners == 3 ? Vec3(e.y(), -e.x(), 0) : Vec3(e.cross(mesh.nodes[n[2]] - mesh.nodes[n[0]]) / 2);
      EXPECT_LT((own - normal).norm(), 1e-9 * normal.norm());
      sum += normal;
      area += normal.norm();
      ++open;
    } else {
      auto const* first = &across[std::size_t(across[use]) * corners];
      EXPECT_EQ(std::count(first, first + corners, c), 1) << "neighbours know each other";
    }
  }
  EXPECT_EQ(open, mesh.boundary.size());
  EXPECT_LT(sum.norm(), 1e-12 * area) << "the boundary is closed";
}

bool same(Mesh const& a, Mesh const& b) {
  return a.nodes == b.nodes && a.cells == b.cells && a.named_nodes == b.named_nodes && a.named_faces == b.named_faces;
}

/// Measure of the named faces.
double measure_of(Mesh const& mesh, std::string const& name) {
  double sum = 0;
  for (int f : mesh.named_faces[0].at(name)) {
    auto const& n = mesh.boundary[f].node;
    Vec3 const e = mesh.nodes[n[1]] - mesh.nodes[n[0]];
    sum += mesh.kind == CellKind::triangle ? e.norm() : e.cross(mesh.nodes[n[2]] - mesh.nodes[n[0]]).norm() / 2;
  }
  return sum;
}

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
  EXPECT_NEAR(tet.shape(), 3 / (3 + std::sqrt(3)) / (std::sqrt(3) / 2), 1e-14);      // r = 1/(3 + sqrt3), R = sqrt3/2
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
    near += std::abs(across[use] - use / 4) <= 64;  // a few cache lines; in rows of the grid a third are 96 or more away
  }
  EXPECT_GT(near, 0.75 * inner);
}

// ------------------------------------------------------------------------------------------------- unstructured shapes
struct Case { char const* name; scene::Shape shape; double area, volume, error; int euler_2d, euler_3d; };

class Shapes : public testing::TestWithParam<Case> {};

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
    testing::Values(
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

TEST(Mesh, GivesOpenMpItsThreadsBack) {
  int const before = omp_get_max_threads();
  omp_set_num_threads(3);
  mesh_of(mesher_2d(), shape(coin), 0.5);
  EXPECT_EQ(omp_get_max_threads(), 3);
  omp_set_num_threads(before);
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
    for (auto const& [name, nodes] : solid.named_nodes[0]) EXPECT_TRUE(std::is_sorted(nodes.begin(), nodes.end())) << name;
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

// ------------------------------------------------------------------------------------------------------------ refusals
TEST(Refusal, NamesTheShapeAndWhatIsWrongWithIt) {
  auto const two = [](scene::Shape const& s) { return error_of([&] { mesh_of(mesher_2d(), s, 0.1); }); };
  auto const three = [](scene::Shape const& s) { return error_of([&] { mesh_of(mesher_3d(), s, 0.1); }); };
  EXPECT_EQ(two(shape(scene::Disc{{0, 0, 0}, -1, 0})), "scene.lua:7: disc: radius must be a number above 0 (it is -1)");
  EXPECT_EQ(three(shape(scene::Disc{{0, 0, 0}, 1, 0})), "scene.lua:7: disc: thickness must be a number above 0 (it is 0)");
  EXPECT_EQ(three(scene::Shape{scene::Box{{0, 0, 0}, {1, 1, 0}}, {"shapes.lua", 3}}),
            "shapes.lua:3: box: size must be a number above 0 (it is 0)");
  EXPECT_EQ(two(shape(scene::Box{{NAN, 0, 0}, {1, 1, 1}})), "scene.lua:7: box: a coordinate is not a finite number");
  EXPECT_EQ(two(shape(scene::Ring{{0, 0, 0}, 2, 1, 0})), "scene.lua:7: ring: inner must be below outer (inner is 2, outer 1)");
  EXPECT_EQ(two(shape(scene::Polygon{{{0, 0}, {1, 0}}, 0})), "scene.lua:7: polygon: needs at least three corners (it has 2)");
  EXPECT_EQ(two(shape(scene::Polygon{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}, 0})), "scene.lua:7: polygon: sides 1 and 3 cross or touch");
  EXPECT_EQ(two(shape(scene::Polygon{{{0, 0}, {1, 0}, {0.5, 0}, {0, 1}}, 0})), "scene.lua:7: polygon: sides 1 and 2 lie on each other");
  EXPECT_EQ(two(shape(scene::Polygon{{{0, 0}, {0, 1}, {1, 0}}, 0})),
            "scene.lua:7: polygon: corners must go counter-clockwise (they go clockwise); reverse their order");
  EXPECT_EQ(two(shape(scene::Notch{{0, 0}, {1, 0}, 0.1})),
            "scene.lua:7: a notch is no body of its own (it is a slot to be taken away); write difference{ shape, notch }");
  EXPECT_EQ(two(shape(scene::Difference{{shape(coin), shape(scene::Notch{{0, 0}, {0, 0}, 0.1})}})),
            "scene.lua:7: notch: from and to are the same point (a notch needs a length)");
  EXPECT_EQ(two(shape(scene::Difference{{shape(coin), shape(scene::Disc{{0, 0, 0}, 2, 0})}})),
            "scene.lua:7: difference: nothing is left of the first shape (the others cover it)");
  EXPECT_EQ(two(shape(scene::Union{})), "scene.lua:7: union: has no parts");
  EXPECT_EQ(two(shape(scene::Union{{shape(scene::MeshFile{"a.msh"})}})),
            "scene.lua:7: a mesh file cannot be part of a union or difference (it is already meshed); use it as a body's shape");
}

TEST(Refusal, NamesTheMeshOptionAndWhatWouldDo) {
  auto const with = [](auto change, scene::Shape const& s = shape(brick)) {
    scene::Scene scene = scene_of(s, 0.1);
    change(scene.bodies[0].mesh);
    return error_of([&] { make_mesh(scene, mesher_2d()); });
  };
  using Spec = scene::MeshSpec;
  std::string const body = "scene.lua:7: body \"part\": ";
  EXPECT_EQ(with([](Spec& m) { m.cells = "hex"; }), body + "cells = \"hex\" is not available (only simplices are); write \"simplex\" or \"tri\"");
  EXPECT_EQ(with([](Spec& m) { m.cells = "tet"; }),
            body + "cells = \"tet\" is not for this program (its cells are \"tri\"); write \"simplex\", which fits both");
  EXPECT_EQ(with([](Spec& m) { m.cells = "simplx"; }), body + "unknown cells \"simplx\"; did you mean \"simplex\"?");
  EXPECT_EQ(with([](Spec& m) { m.size = 0; }), body + "mesh size must be a number above 0 (it is 0)");
  EXPECT_EQ(with([](Spec& m) { m.structured = true; }, shape(coin)),
            body + "structured = true needs a box (other shapes have no regular grid); leave structured out");
  EXPECT_EQ(with([](Spec& m) { m.structured = true, m.seed = 1; }),
            body + "seed has no meaning with structured = true (a regular grid is not random); leave one out");
  for (bool structured : {false, true})
    EXPECT_EQ(with([=](Spec& m) { m.size = 1e-4, m.structured = structured; }),
              body + "its mesh would have about " + (structured ? "4e+08" : "5.2e+08") +
                  " cells (at most 5e+07 are possible); a larger mesh size than 0.0001 m is needed");
  EXPECT_EQ(with([](Spec&) {}, shape(scene::Box{{0, 0, 0}, {1e8, 1e-3, 0}})),
            body + "its mesh would have about 2e+09 cells (at most 5e+07 are possible); a larger mesh size than 0.1 m is needed");
}

class Broken : public testing::Test {
 protected:
  std::string error() {
    Mesh mesh = no_bodies(CellKind::triangle);
    return error_of([&] { add_body(mesh, part, "part", at); });
  }
  Part part{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {0, 1, 2, 1, 3, 2}, "", {}, {}, {}};
};

TEST_F(Broken, NothingIsRefusedInAGoodMesh) { EXPECT_EQ(error(), "no error"); }

TEST_F(Broken, CellsThatTurnTheOtherWayAreTurned) {
  part.cells = {0, 2, 1, 1, 3, 2};
  Mesh mesh = no_bodies(CellKind::triangle);
  add_body(mesh, part, "part", at);
  expect_sound(mesh);
}

TEST_F(Broken, FlatCellsAreRefused) {
  part.nodes[3] = {2, -1, 0};
  EXPECT_EQ(error(), "scene.lua:7: body \"part\": cell 1 near (1, 0, 0) is degenerate (its radius ratio is 0, "
                     "a regular one has 1); repair the mesh");
}

TEST_F(Broken, DoubledCellsAreRefused) {
  part.cells = {0, 1, 2, 1, 3, 2, 3, 2, 1};
  EXPECT_EQ(error(), "scene.lua:7: body \"part\": cell 1 near (0.6667, 0.6667, 0) and cell 2 near (0.6667, 0.6667, 0) have the same "
                     "corners; remove one of them");
}

TEST_F(Broken, ThreeCellsAtAFaceAreRefused) {
  part.nodes.push_back({2, 2, 0});
  part.cells = {0, 1, 2, 1, 3, 2, 1, 4, 2};
  EXPECT_EQ(error(), "scene.lua:7: body \"part\": more than two cells share a face (cell 0 near (0.3333, 0.3333, 0), cell 1 near "
                     "(0.6667, 0.6667, 0) and cell 2 near (1, 1, 0)); repair the mesh");
}

TEST_F(Broken, FoldedCellsAreRefused) {
  part.nodes[3] = {0.2, 0.2, 0};
  EXPECT_EQ(error(), "scene.lua:7: body \"part\": cell 0 near (0.3333, 0.3333, 0) and cell 1 near (0.4, 0.4, 0) overlap (both lie on "
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
  EXPECT_EQ(error(), "scene.lua:7: body \"part\": its mesh has no cells (the shape may be empty or far smaller than its mesh size)");
}

TEST_F(Broken, NodesOfNoCellAreDropped) {
  part.nodes.insert(part.nodes.begin(), {9, 9, 9});
  for (int& n : part.cells) ++n;
  Mesh mesh = no_bodies(CellKind::triangle);
  add_body(mesh, part, "part", at);
  EXPECT_EQ(mesh.nodes.size(), 4u);
  expect_sound(mesh);
}

// --------------------------------------------------------------------------------------------------------- mesh files
namespace {

// The unit square, two triangles, lower side and upper half named; element 4 belongs to two groups.
std::string const square_2 = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
1 1 "floor"
2 2 "upper half"
2 3 "left"
$EndPhysicalNames
$Nodes
5
10 0 0 0.5
11 1 0 0.5
12 1 1 0.5
13 0 1 0.5
99 7 7 7
$EndNodes
$Elements
5
1 1 2 1 1 10 11
2 15 2 8 1 12
3 2 2 0 1 10 11 12
4 2 2 2 1 10 12 13
5 2 2 3 1 10 12 13
$EndElements
)";

// Two tetrahedra with a common face, which is named, as is one outer face; an unnamed group of both volumes.
std::string const pair_4 = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
2 1 "between"
2 2 "under side"
$EndPhysicalNames
$Entities
1 0 2 1
1 0 0 0 0
1 0 0 0 1 1 1 1 1 0
2 0 0 0 1 1 0 2 2 -5 1 7
1 0 0 0 1 1 1 1 9 2 1 -2
$EndEntities
$Nodes
2 5 1 5
0 1 0 1
1
0 0 0
3 1 1 4
2
3
4
5
1 0 0 0.5 0.5 0.5
0 1 0 0.5 0.5 0.5
0 0 1 0.5 0.5 0.5
1 1 1 0.5 0.5 0.5
$EndNodes
$Elements
3 4 1 4
2 1 2 1
1 2 3 4
2 2 2 1
2 1 2 3
3 1 4 2
3 1 2 3 4
4 2 3 4 5
$EndElements
$NodeData
1 2 3 whatever
$EndNodeData
)";

Mesh read(std::string const& text, CellKind kind) {
  Mesh mesh = no_bodies(kind);
  add_body(mesh, read_msh("part.msh", text, kind), "part", at);
  return mesh;
}

std::string replaced(std::string text, std::string const& what, std::string const& with) {
  std::size_t const found = text.find(what);
  EXPECT_NE(found, std::string::npos) << what;
  return text.replace(found, what.size(), with);
}

std::string error_in(std::string const& text, CellKind kind = CellKind::triangle) {
  return error_of([&] { read(text, kind); });
}

}  // namespace

TEST(MeshFile, OfFormat22GivesCellsAndGroups) {
  Mesh const mesh = read(square_2, CellKind::triangle);
  expect_sound(mesh);
  EXPECT_EQ(mesh.n_cells(), 2);
  EXPECT_EQ(mesh.nodes.size(), 4u);
  EXPECT_DOUBLE_EQ(total_measure(mesh), 1);
  EXPECT_EQ(mesh.nodes[0].z(), 0);
  EXPECT_DOUBLE_EQ(measure_of(mesh, "floor"), 1);
  EXPECT_EQ(mesh.named_nodes[0].at("upper half").size(), 3u);
  EXPECT_EQ(mesh.named_nodes[0].at("left").size(), 3u) << "a group wins over a side";
  EXPECT_EQ(mesh.named_faces[0].count("left"), 0u);
  EXPECT_EQ(mesh.named_nodes[0].at("8").size(), 1u);
  EXPECT_DOUBLE_EQ(measure_of(mesh, "right"), 1);
}

TEST(MeshFile, OfFormat41GivesCellsAndGroups) {
  Mesh const mesh = read(pair_4, CellKind::tetrahedron);
  expect_sound(mesh);
  EXPECT_EQ(mesh.n_cells(), 2);
  EXPECT_DOUBLE_EQ(total_measure(mesh), 1.0 / 6 + 1.0 / 3);
  EXPECT_DOUBLE_EQ(measure_of(mesh, "under side"), 0.5);
  EXPECT_EQ(mesh.named_nodes[0].at("between").size(), 3u);
  EXPECT_EQ(mesh.named_faces[0].count("between"), 0u) << "it lies inside";
  EXPECT_DOUBLE_EQ(measure_of(mesh, "5"), 0.5);
  EXPECT_EQ(mesh.named_nodes[0].at("9").size(), 5u);
}

TEST(MeshFile, IsReadFromDisk) {
  auto const path = std::filesystem::temp_directory_path() / "fissure_mesh_test.msh";
  std::ofstream(path) << square_2;
  EXPECT_EQ(mesh_of(mesher_2d(), shape(scene::MeshFile{path.string()}), 0).n_cells(), 2);
  EXPECT_EQ(error_of([&] { mesh_of(mesher_2d(), shape(scene::MeshFile{path.string()}), 0, 1); }),
            "scene.lua:7: body \"part\": seed has no meaning for a mesh file (it is already meshed); leave it out");
  std::filesystem::remove(path);
  EXPECT_EQ(error_of([&] { mesh_of(mesher_2d(), shape(scene::MeshFile{"none.msh"}), 0); }),
            "scene.lua:7: body \"part\": cannot read mesh file \"none.msh\" (no such file)");
}

TEST(MeshFile, OfAnotherKindIsRefused) {
  EXPECT_EQ(error_in(""), "part.msh:1: the file is empty");
  EXPECT_EQ(error_in("solid cube\n"), "part.msh:1: this is no Gmsh mesh (it should begin with $MeshFormat)");
  EXPECT_EQ(error_in(replaced(square_2, "2.2 0", "4 0")),
            "part.msh:2: this version of the format is not read (2.2 and 4.1 are); export with Mesh.MshFileVersion = 4.1");
  EXPECT_EQ(error_in(replaced(square_2, "2.2 0", "2.2 1")),
            "part.msh:2: the mesh is binary (only ASCII is read); export with Mesh.Binary = 0");
  EXPECT_EQ(error_in(replaced(pair_4, "$NodeData", "$PartitionedEntities"), CellKind::tetrahedron),
            "part.msh:41: the mesh is partitioned (its pieces are not joined); save it in one piece");
}

TEST(MeshFile, OfAnotherDimensionIsRefused) {
  EXPECT_EQ(error_in(square_2, CellKind::tetrahedron),
            "part.msh:26: the mesh has triangles but no tetrahedra (a mesh of surfaces in a program for solids); mesh the volume, "
            "or run it with fissure2d");
  EXPECT_EQ(error_in(pair_4), "part.msh:38: element 3 is a tetrahedron (a mesh of volumes in a program for the plane); run it with fissure3d");
  EXPECT_EQ(error_in(replaced(square_2, "12 1 1 0.5", "12 1 1 0.7")),
            "part.msh:14: a node of the mesh is out of plane (z = 0.7 here, 0.5 elsewhere; a plane mesh has one z)");
}

TEST(MeshFile, WithOtherCellsIsRefused) {
  EXPECT_EQ(error_in(replaced(square_2, "3 2 2 0 1 10 11 12", "3 3 2 0 1 10 11 12 13")),
            "part.msh:22: element 3 is a quadrangle (only triangles are read); mesh again without recombination");
  EXPECT_EQ(error_in(replaced(square_2, "3 2 2 0 1 10 11 12", "3 9 2 0 1 10 11 12 13 14 15")),
            "part.msh:22: element 3 is a second-order triangle (only triangles of first order are read); export with Mesh.ElementOrder = 1");
  EXPECT_EQ(error_in(replaced(square_2, "3 2 2 0", "3 77 2 0")),
            "part.msh:22: element 3 is of Gmsh's type 77 (only triangles of first order are read); export with Mesh.ElementOrder = 1");
  EXPECT_EQ(error_in(replaced(square_2, "$Elements\n5", "$Elements\n2\n1 1 2 1 1 10 11\n2 15 2 8 1 12\n$EndElements\n$Rest") + "$EndRest\n"),
            "part.msh:31: the mesh has no triangles; mesh it in Gmsh before export, with every physical group that matters");
}

TEST(MeshFile, WithBrokenTextIsRefusedByLine) {
  EXPECT_EQ(error_in(square_2.substr(0, square_2.find("13 0 1"))),
            "part.msh:15: the file ends where a node's number should be (it may be cut short); export it again");
  EXPECT_EQ(error_in(replaced(square_2, "11 1 0 0.5", "11 one 0 0.5")), "part.msh:13: x should be a number");
  EXPECT_EQ(error_in(replaced(square_2, "11 1 0 0.5", "11 nan 0 0.5")), "part.msh:13: x is not a finite number");
  EXPECT_EQ(error_in(replaced(square_2, "11 1 0 0.5", "10 1 0 0.5")), "part.msh:13: node 10 is given twice");
  EXPECT_EQ(error_in(replaced(square_2, "10 11 12\n", "10 11 55\n")),
            "part.msh:22: element 3 refers to node 55, which is not in the file");
  EXPECT_EQ(error_in(replaced(square_2, "$Nodes\n5", "$Nodes\n-5")), "part.msh:11: the number of nodes must lie between 0 and 300000000");
  EXPECT_EQ(error_in(replaced(square_2, "$EndNodes", "$EndNode")), "part.msh:17: $EndNodes expected here");
  EXPECT_EQ(error_in(replaced(square_2, "\"floor\"", "floor")), "part.msh:6: a physical group's name should be in quotes");
  EXPECT_EQ(error_in(replaced(square_2, "$Nodes", "$Nods")), "part.msh:10: this section has no $EndNods");
  EXPECT_EQ(error_in(replaced(square_2, "$Nodes", "Nodes")), "part.msh:10: a section (a word that begins with $) expected here");
}

TEST(MeshFile, WithBrokenCellsIsRefusedByElement) {
  EXPECT_EQ(error_in(replaced(square_2, "3 2 2 0 1 10 11 12", "3 2 2 0 1 10 11 11")),
            "scene.lua:7: body \"part\": element 3 of part.msh near (0.6667, 0, 0) is degenerate (its radius ratio is 0, a regular "
            "one has 1); repair the mesh");
  EXPECT_EQ(error_in(replaced(square_2, "5 2 2 3", "5 2 2 2")),
            "scene.lua:7: body \"part\": element 4 of part.msh near (0.3333, 0.6667, 0) and element 5 of part.msh near (0.3333, 0.6667, 0) "
            "have the same corners; remove one of them");
}
