// mesh.near: smaller elements about lines and points, whatever else the mesh was asked for.
#include <map>

#include "../../src2d/shapes.h"
#include "../../src3d/shapes.h"
#include "lua/script.h"
#include "mesh_checks.h"

namespace fissure::mesh {
namespace {

using namespace testing;

scene::Box const plate{{0, 0, 0}, {1, 0.6, 0.1}};
scene::Near const line{{0, -0.3}, {0, 0.3}, 0.05, 0.02}, point{{0.35, 0}, {0.35, 0}, 0.04, 0.015};

double distance(Vec3 const& p, scene::Near const& near) {
  Vec3 const from(near.from[0], near.from[1], 0), to(near.to[0], near.to[1], 0), along = to - from,
                                                                                 flat(p.x(), p.y(), 0);
  double const t = along.norm() > 0 ? std::clamp((flat - from).dot(along) / along.squaredNorm(), 0.0, 1.0) : 0;
  return (flat - from - t * along).norm();
}

/// Mean length in the plane of the edges of cells whose nodes are all where `there` says.
template <class There>
double mean_edge(Mesh const& mesh, There const& there) {
  double sum = 0;
  int count = 0;
  auto const look = [&](std::vector<int> const& cells, int corners, int in_plane) {
    for (std::size_t c = 0; c < cells.size(); c += corners) {
      std::span const nodes = std::span(cells).subspan(c, corners);
      if (!std::all_of(nodes.begin(), nodes.end(), [&](int n) { return there(mesh.nodes[n]); })) continue;
      for (int a = 0; a < in_plane; ++a)
        for (int b = 0; b < a; ++b)
          if (in_plane == corners || a - b != 2)  // no diagonals of quadrilaterals
            sum += (mesh.nodes[nodes[a]] - mesh.nodes[nodes[b]]).norm(), ++count;
    }
  };
  look(mesh.cells, node_count(mesh.kind), node_count(mesh.kind));
  return count ? sum / count : 0;
}

struct Option {
  char const* name;
  void (*set)(scene::MeshSpec&);
};

TEST(MeshNear, IsFineThereAndCoarseElsewhere) {
  for (Mesher const* mesher : {&mesher_2d(), &mesher_3d()})
    for (Option const& option :
         {Option{"plain", [](scene::MeshSpec&) {}}, Option{"seed", [](scene::MeshSpec& m) { m.seed = 3; }},
          Option{"seam",
                 [](scene::MeshSpec& m) {
                   m.seams = {{{0, -0.3}, {0, 0.3}, {}}};
                 }},
          Option{"irregular", [](scene::MeshSpec& m) { m.irregular = 0.2; }}}) {
      SCOPED_TRACE(option.name);
      scene::Scene scene = scene_of(shape(plate), 0.08);
      option.set(scene.bodies[0].mesh);
      auto const even = make_mesh(scene, *mesher);
      scene.bodies[0].mesh.near = {line, point};
      auto const mesh = make_mesh(scene, *mesher);
      expect_sound(mesh);
      EXPECT_GT(mesh.n_cells(), 3 * even.n_cells());
      for (auto const& near : {line, point})
        EXPECT_NEAR(mean_edge(mesh, [&](Vec3 const& p) { return distance(p, near) < near.radius; }) / near.size, 1.1,
                    0.25);
      auto const far = [](Vec3 const& p) { return p.x() < -0.3; };
      EXPECT_NEAR(mean_edge(mesh, far) / mean_edge(even, far), 1, 0.1);
    }
}

TEST(MeshNear, MakesBlocksFineToo) {
  for (Mesher const* mesher : {&mesher_2d(), &mesher_3d()}) {
    scene::Scene scene = scene_of(shape(plate), 0.08);
    scene.bodies[0].mesh.cells = "block";
    auto const even = make_mesh(scene, *mesher);
    scene.bodies[0].mesh.near = {line};
    auto const mesh = make_mesh(scene, *mesher);
    expect_sound(mesh);
    auto const fine = quality(mesh)[0], coarse = quality(even)[0];
    EXPECT_GT(fine.blocks, 2 * coarse.blocks);
    EXPECT_LT(fine.least_edge, line.size);
    EXPECT_GT(fine.largest_edge, 0.06);
  }
}

TEST(MeshNear, DoesNotDependOnTheUnitOfLength) {
  for (Mesher const* mesher : {&mesher_2d(), &mesher_3d()}) {
    scene::Scene scene = scene_of(shape(plate), 0.08);
    scene.bodies[0].mesh.near = {line};
    auto const mesh = make_mesh(scene, *mesher);
    double const f = std::exp2(-24);
    scene.bodies[0].shape = shape(scene::Box{{0, 0, 0}, f * plate.size});
    scene.bodies[0].mesh.size *= f;
    scene.bodies[0].mesh.near = {{{0, -0.3 * f}, {0, 0.3 * f}, 0.05 * f, 0.02 * f}};
    auto const small = make_mesh(scene, *mesher);
    EXPECT_NEAR(static_cast<double>(small.n_cells()) / static_cast<double>(mesh.n_cells()), 1, 0.05);
    EXPECT_NEAR(quality(small)[0].mean_edge / f / quality(mesh)[0].mean_edge, 1, 0.02);
  }
}

TEST(MeshNear, RefusesWhatMakesNoSense) {
  auto const with = [](auto change, Mesher const& mesher) {
    scene::Scene scene = scene_of(shape(plate), 0.08);
    scene.bodies[0].mesh.near = {line};
    change(scene.bodies[0]);
    return error_of([&] { make_mesh(scene, mesher); });
  };
  std::string const body = "scene.lua:7: body \"part\": ";
  for (Mesher const* mesher : {&mesher_2d(), &mesher_3d()}) {
    EXPECT_EQ(
        with([](scene::Body& b) { b.mesh.structured = true; }, *mesher),
        body + "near and structured = true exclude each other (the cells of a regular grid are alike); leave one out");
    EXPECT_EQ(with([](scene::Body& b) { b.shape = shape(scene::MeshFile{"a.msh"}); }, *mesher),
              body + "near has no meaning for a mesh file (it is already meshed); leave it out");
    EXPECT_EQ(with(
                  [](scene::Body& b) {
                    b.mesh.near = {{{2, 0}, {3, 1}, 0.1, 0.02}};
                  },
                  *mesher),
              body + "mesh.near: no part of the body is within 0.1 m of the place from (2, 0) to (3, 1) m");
    EXPECT_EQ(
        with([](scene::Body& b) { b.mesh.near[0].size = 1e-5; }, *mesher).rfind(body + "its mesh would have about ", 0),
        0u);
  }
}

scene::MeshSpec read(std::string const& near) {
  return lua::read_scene_text(
             "local m = material{ density = 1, elastic = { young = 1e9, poisson = 0.2 } }\n"
             "body{ \"b\", shape = box{ size = { 1, 1, 1 } }, material = m, mesh = { size = 0.1,\n"
             "near = " +
                 near + " } }\nrun{ time = 1 }",
             "s.lua", 2, {})
      .bodies[0]
      .mesh;
}

TEST(MeshNear, IsReadAsOnePlaceOrAList) {
  auto const one = read("{ from = { 0, 0.1 }, radius = 0.2, size = 0.01 }").near;
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].to, one[0].from);
  auto const two = read(
                       "{ { from = { 0, 0.1 }, radius = 0.2, size = 0.01 }, { from = { 0, 0 }, to = { 1, 2 }, radius = "
                       "0, size = 0.02 } }")
                       .near;
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[0].from, (std::array{0.0, 0.1}));
  EXPECT_EQ(two[1].to, (std::array{1.0, 2.0}));
  EXPECT_EQ(two[1].size, 0.02);
  for (auto const& [near, why] : std::map<std::string, std::string>{
           {"5", "mesh.near must be a table or a list of tables, not a number"},
           {"{ { from = { 0, 0 }, radius = 0, size = 0.01 }, 7 }", "mesh.near must be a list of tables, not a number"},
           {"{ from = { 0, 0 }, radius = 0.1, size = 0.2 }",
            "mesh.near.size = 0.2 is no smaller than mesh.size = 0.1; near is for places with smaller elements"},
           {"{ from = { 0, 0 }, radius = -1, size = 0.01 }",
            "mesh.near.radius = -1 m is not allowed (it must be >= 0)"},
           {"{ { from = { 0, 0 }, radis = 0, radius = 0, size = 0.01 } }",
            "unknown key \"radis\" in mesh.near; did you mean \"radius\"?"}}) {
    std::string const said = error_of([&, text = near] { read(text); });
    EXPECT_NE(said.find("body \"b\": " + why), std::string::npos) << said;
  }
}

}  // namespace
}  // namespace fissure::mesh
