// Meshes of quadrilaterals and hexahedra: measures against closed form, soundness of their parts, what is refused.
#include "../../src2d/shapes.h"
#include "../../src3d/shapes.h"
#include "mesh/block.h"
#include "mesh_checks.h"

using namespace fissure;
using namespace fissure::mesh;
using namespace fissure::mesh::testing;

namespace {

Mesh blocks_of(Mesher const& mesher, scene::Shape const& one, double size, unsigned seed = 0) {
  scene::Scene scene = scene_of(one, size, seed);
  scene.bodies[0].mesh.cells = "block";
  return make_mesh(scene, mesher);
}

/// Volume of a body's blocks by their own shape functions.
double measure_of_blocks(Mesh const& mesh) {
  std::size_t const n = block_corners(mesh.kind);
  double sum = 0;
  for (std::size_t b = 0; b < mesh.blocks.size(); b += n)
    sum += Block(std::span(mesh.blocks).subspan(b, n), mesh.nodes).measure();
  return sum;
}

/// A polygon in a circle of the same edges has the area less the sixth of the square of an edge's angle: so halving the
/// size must quarter the error, whatever the shape of the blocks inside.
TEST(Blocks, RegularMeshesOfWhatIsRoundCloseInOnIt) {
  struct Case {
    Mesher const& mesher;
    scene::Shape one;
    double exact;
  };
  for (auto const& [mesher, one, exact] : std::vector<Case>{
           {mesher_2d(), shape(scene::Disc{{1, 2, 0}, 0.5, 0.1}), pi * 0.25},
           {mesher_2d(), shape(scene::Ring{{0, 0, 0}, 0.3, 0.5, 0.1}), pi * 0.16},
           {mesher_3d(), shape(scene::Disc{{1, 2, 3}, 0.5, 0.1}), pi * 0.025},
           {mesher_3d(), shape(scene::Ring{{0, 0, 0}, 0.3, 0.5, 0.1}), pi * 0.016},
           {mesher_3d(), shape(scene::Rod{{0, 1, 0}, 0.5, 2, 0}), pi * 0.5},
           {mesher_3d(), shape(scene::Rod{{0, 1, 0}, 0.5, 2, 0.25}), pi * 2 * (0.25 + 0.125 + 0.0625) / 3},
           {mesher_3d(), shape(scene::Ball{{0, 0, 1}, 0.5}), pi / 6}}) {
    double before = 0;
    for (double size : {0.1, 0.05}) {
      Mesh const mesh = blocks_of(mesher, one, size);
      expect_sound(mesh);
      Quality const q = quality(mesh)[0];
      EXPECT_EQ(q.blocks, q.cells);
      EXPECT_GT(q.least_shape, 0.3);
      EXPECT_NEAR(q.mean_edge / size, 1, 0.35);
      double const error = exact - measure_of_blocks(mesh);
      EXPECT_GT(error, 0);
      if (before > 0) {
        EXPECT_NEAR(before / error, 4, 1) << one.is.index();
      }
      before = error;
    }
    EXPECT_LT(before, 0.02 * exact);
  }
}

TEST(Blocks, ABoxIsAGridWithItsPlaces) {
  Mesh const flat = blocks_of(mesher_2d(), shape(scene::Box{{0, 0, 0}, {2, 1, 1}}), 0.25),
             solid = blocks_of(mesher_3d(), shape(scene::Box{{0, 0, 0}, {2, 1, 1}}), 0.25);
  EXPECT_EQ(flat.n_blocks(0), 32);
  EXPECT_EQ(solid.n_blocks(0), 128);
  for (auto const& mesh : {flat, solid}) {
    expect_sound(mesh);
    EXPECT_NEAR(measure_of_blocks(mesh), 2, 1e-12);
    EXPECT_NEAR(measure_of(mesh, "top"), 2, 1e-12);
    EXPECT_NEAR(measure_of(mesh, "left"), 1, 1e-12);
    EXPECT_DOUBLE_EQ(quality(mesh)[0].least_shape, 1);
  }
}

/// What has no regular mesh: quadrilaterals by recombination, in layers over them what is a prism.
TEST(Blocks, OtherShapesAreMeshedByGmsh) {
  scene::Shape const ell = shape(scene::Polygon{{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 0.5});
  Mesh const flat = blocks_of(mesher_2d(), ell, 0.2), solid = blocks_of(mesher_3d(), ell, 0.25);
  expect_sound(flat), expect_sound(solid);
  EXPECT_NEAR(total_measure(flat), 3, 1e-9);
  EXPECT_NEAR(measure_of_blocks(solid), 1.5, 1e-9);
  EXPECT_EQ(solid.n_simplices(0), 0);
  EXPECT_EQ(flat.n_simplices(0), 0);
  EXPECT_NEAR(quality(solid)[0].mean_edge, 0.25, 0.1);
}

/// Layers along z of prisms that were put together, cut out or parted by a seam: every node lies on a layer.
TEST(Blocks, PrismsAreMeshedInLayers) {
  scene::Shape const plate = shape(scene::Box{{0, 0, 1}, {2, 1, 0.4}}),
                     hole = shape(scene::Disc{{0.3, 0.1, 1}, 0.2, 0.4});
  scene::Shape const slot = shape(scene::Notch{{-1, 0}, {-0.4, 0}, 0.1});
  scene::Scene scene = scene_of(shape(scene::Difference{{plate, hole, slot}}), 0.1);
  scene.bodies[0].mesh.cells = "block";
  for (bool seam : {false, true}) {
    if (seam) scene.bodies[0].mesh.seams = {{{-0.4, 0}, {1, 0}, {}}};
    Mesh const mesh = make_mesh(scene, mesher_3d());
    expect_sound(mesh);
    EXPECT_EQ(mesh.n_simplices(0), 0);
    EXPECT_GT(quality(mesh)[0].least_shape, 0.2);
    // the hole is a polygon of some 13 sides
    EXPECT_NEAR(measure_of_blocks(mesh), 0.4 * (2 - pi * 0.04 - 0.06), 0.4 * pi * 0.04 * 0.1);
    for (Vec3 const& p : mesh.nodes) EXPECT_NEAR(std::remainder(p.z() - 0.8, 0.1), 0, 1e-12);
    if (seam) {
      EXPECT_NEAR(measure_of_inner_faces(mesh, [](Vec3 const& p) { return std::abs(p.y()) < 1e-9; }),
                  0.4 * (1.4 - 2 * std::sqrt(0.03)), 1e-2);
    }
  }
}

/// What is no prism: tetrahedra cut into hexahedra.
TEST(Blocks, SolidsThatAreNoPrismsAreCutTetrahedra) {
  scene::Shape const ball = shape(scene::Ball{{0, 0, 0}, 0.5}), box = shape(scene::Box{{0.5, 0, 0}, {1, 2, 2}});
  Mesh const half = blocks_of(mesher_3d(), shape(scene::Difference{{ball, box}}), 0.12);
  expect_sound(half);
  EXPECT_EQ(half.n_simplices(0), 0);
  EXPECT_NEAR(measure_of_blocks(half), pi / 12, 0.05 * pi / 12);
  // As much at the back as at the front, but not one behind the other.
  scene::Shape const low = shape(scene::Box{{0, 0, 0.5}, {1, 1, 1}}),
                     high = shape(scene::Box{{0.5, 0, 1.5}, {1, 1, 1}});
  Mesh const offset = blocks_of(mesher_3d(), shape(scene::Union{{low, high}}), 0.4);
  expect_sound(offset);
  EXPECT_NEAR(measure_of_blocks(offset), 2, 1e-9);
  for (Vec3 const& p : offset.nodes) EXPECT_FALSE(p.z() < 1 - 1e-9 && p.x() > 0.5 + 1e-9);
}

/// Two boxes side by side, the right one of n cells along y; with nodes of its own where they meet, or with the left
/// one's, or with the one at the origin's corner alone. Its own nodes may be numbered the other way around, so that its
/// faces are cut the other way.
Mesh side_by_side(Mesher const& mesher, int n, bool merged, bool reversed = false, bool hinged = false) {
  bool const flat = mesher.kind() == CellKind::triangle;
  Part part = structured_part(mesher.kind(), {0.5, 0.5, 0.5}, {1, 1, 1}, {1, 1, flat ? 0 : 1}, true);
  Part right = structured_part(mesher.kind(), {1.5, 0.5, 0.5}, {1, 1, 1}, {1, n, flat ? 0 : 1}, true);
  if (reversed) {
    std::reverse(right.nodes.begin(), right.nodes.end());
    for (int& node : right.blocks) node = static_cast<int>(right.nodes.size()) - 1 - node;
  }
  std::vector<int> number;
  for (Vec3 const& p : right.nodes) {
    auto const same = std::find_if(part.nodes.begin(), part.nodes.end(), [&](Vec3 const& q) {
      return (merged || (hinged && (p - Vec3(1, 0, 0)).norm() < 1e-9)) && (p - q).norm() < 1e-9;
    });
    number.push_back(static_cast<int>(same - part.nodes.begin()));
    if (same == part.nodes.end()) part.nodes.push_back(p);
  }
  for (int node : right.blocks) part.blocks.push_back(number[node]);
  Mesh mesh = no_bodies(mesher.kind());
  add_body(mesh, part, "part", at);
  return mesh;
}

TEST(Blocks, FacesThatLieOnEachOtherAreFound) {
  for (auto const* mesher : {&mesher_2d(), &mesher_3d()}) {
    int const parts = mesher->kind() == CellKind::triangle ? 1 : 2;  // of a block's face
    Mesh const merged = side_by_side(*mesher, 1, true), doubled = side_by_side(*mesher, 1, false),
               hanging = side_by_side(*mesher, 2, false);
    EXPECT_EQ(doubled_faces(merged, 0).count, 0);
    EXPECT_EQ(doubled_faces(doubled, 0).count, 2 * parts);
    EXPECT_FALSE(doubled_faces(doubled, 0).unmatched);
    for (bool hinged : {false, true}) {
      auto const other_way = doubled_faces(side_by_side(*mesher, 1, false, true, hinged), 0);
      EXPECT_EQ(other_way.count, 2 * parts);
      EXPECT_FALSE(other_way.unmatched);
    }
    EXPECT_EQ(error_of([&] { refuse_unmatched_faces(doubled, "part", at); }), "no error");
    EXPECT_TRUE(doubled_faces(hanging, 0).unmatched);
    std::string const why = error_of([&] { refuse_unmatched_faces(hanging, "part", at); });
    EXPECT_NE(why.find("scene.lua:7: body \"part\": faces of its mesh lie on each other near (1, 0.5, "),
              std::string::npos)
        << why;
    EXPECT_NE(why.find("and their nodes do not match; what does not share nodes is not tied"), std::string::npos)
        << why;
  }
}

TEST(Blocks, TooTwistedToBeCutAreRefused) {
  Part part;
  for (int k : {0, 1})  // the upper face turned by 50 degrees against the lower
    for (int a = 0; a < 4; ++a) {
      double const angle = (a + 0.5) * pi / 2 + k * 50 * pi / 180;
      part.nodes.push_back({std::cos(angle), std::sin(angle), 1.5 * k});
      part.blocks.push_back(4 * k + a);
    }
  Mesh mesh = no_bodies(CellKind::tetrahedron);
  std::string const why = error_of([&] { add_body(mesh, part, "part", at); });
  EXPECT_NE(why.find("is so twisted that it cannot be cut into simplices (contact needs them); another mesh size or "
                     "seed, or cells = \"simplex\"?"),
            std::string::npos)
      << why;
}

}  // namespace
