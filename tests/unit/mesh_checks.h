// What mesh tests share: scenes of one body, and what must hold for every mesh.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "mesh/mesher.h"
#include "mesh/part.h"
#include "mesh/simplex.h"

namespace fissure::mesh::testing {

inline double const pi = std::acos(-1.0);
inline Source const at{"scene.lua", 7};

template <class Primitive>
scene::Shape shape(Primitive primitive) {
  return {primitive, {}};
}

inline scene::Scene scene_of(scene::Shape const& one, double size, unsigned seed = 0) {
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

inline Mesh mesh_of(Mesher const& mesher, scene::Shape const& one, double size, unsigned seed = 0) {
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

/// Length or area of the cells' faces whose nodes all lie where `there` says, each counted once; boundary faces are
/// left out.
template <class There>
double measure_of_inner_faces(Mesh const& mesh, There const& there) {
  int const corners = node_count(mesh.kind);
  std::vector<int> const across = neighbours(mesh);
  double sum = 0;
  for (std::size_t use = 0; use < across.size(); ++use) {
    int const cell = static_cast<int>(use) / corners, a = static_cast<int>(use) % corners;
    if (across[use] < cell) continue;
    auto const face = face_corners(corners, a);
    std::span const nodes = std::span(mesh.cells).subspan(std::size_t(cell) * corners, corners);
    if (std::all_of(face.begin(), face.end(), [&](int i) { return there(mesh.nodes[nodes[i]]); }))
      sum += Simplex(nodes, mesh.nodes).face_vector(a).norm();
  }
  return sum;
}

inline Simplex simplex(Mesh const& mesh, int c) {
  int const corners = node_count(mesh.kind);
  return Simplex(std::span(mesh.cells).subspan(std::size_t(c) * corners, corners), mesh.nodes);
}

inline double total_measure(Mesh const& mesh) {
  double sum = 0;
  for (Quality const& q : quality(mesh)) sum += q.measure;
  return sum;
}

/// Vertices - edges + faces - cells: 1 for a ball or a disc, 0 with one hole.
inline int euler_characteristic(Mesh const& mesh) {
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
inline void expect_sound(Mesh const& mesh) {
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

inline bool same(Mesh const& a, Mesh const& b) {
  return a.nodes == b.nodes && a.cells == b.cells && a.named_nodes == b.named_nodes && a.named_faces == b.named_faces;
}

/// Measure of the named faces.
inline double measure_of(Mesh const& mesh, std::string const& name) {
  double sum = 0;
  for (int f : mesh.named_faces[0].at(name)) {
    auto const& n = mesh.boundary[f].node;
    Vec3 const e = mesh.nodes[n[1]] - mesh.nodes[n[0]];
    sum += mesh.kind == CellKind::triangle ? e.norm() : e.cross(mesh.nodes[n[2]] - mesh.nodes[n[0]]).norm() / 2;
  }
  return sum;
}

}  // namespace fissure::mesh::testing
