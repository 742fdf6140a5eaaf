// A mesh as plain data: nodes, cells by body, faces found by name. Made by generators or read from files; refused when broken.
#pragma once
#include <array>
#include <map>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace fissure::mesh {

/// Cells by kind; node order is VTK's. Quadrilaterals and hexahedra join this list with their kernels.
enum class CellKind { triangle, tetrahedron };

inline int node_count(CellKind kind) { return kind == CellKind::triangle ? 3 : 4; }

/// A boundary face of a cell: edge in 2D, triangle in 3D, ordered so that its normal points outward
/// (2D: outward is to the right of from -> to).
struct Face { int cell; std::array<int, 4> node; };

/// Bodies never share nodes; nodes within a body are shared by its cells.
struct Mesh {
  CellKind kind = CellKind::triangle;
  std::vector<Vec3> nodes;                               // [m]; z = 0 in 2D
  std::vector<int> cells;                                // node_count(kind) per cell; positive orientation; ordered along a Hilbert curve within each body
  std::vector<int> body_first_cell;                      // n_bodies + 1; body b has cells [b, b + 1)
  std::vector<int> body_first_node;                      // n_bodies + 1
  std::vector<Face> boundary;                            // outer faces, ordered by cell
  std::vector<std::map<std::string, std::vector<int>>> named_nodes;  // per body: "left" -> nodes (global numbers, ascending)
  std::vector<std::map<std::string, std::vector<int>>> named_faces;  // per body: "left" -> indices into boundary
  double thickness = 1;                                  // out of plane [m], 2D only

  int n_cells() const { return static_cast<int>(cells.size()) / node_count(kind); }
  int n_bodies() const { return static_cast<int>(body_first_cell.size()) - 1; }
};

/// Per body, printed by `check` and at the start of a run.
struct Quality {
  int cells = 0, nodes = 0;
  double least_edge = 0, mean_edge = 0, largest_edge = 0;   // [m]
  double least_shape = 0, mean_shape = 0;                   // 1: regular simplex, 0: flat (radius ratio: d * inradius / circumradius)
  int worst_cell = -1;
  double measure = 0;                                       // area [m^2] or volume [m^3]
};

/// The CAD side of one dimension: what each shape is in it. src2d and src3d derive from it.
class Mesher;

/// Mesh every body of a scene. `dimension` is how many coordinates the calling program has.
/// Throws Error with the body's place for shapes that cannot be meshed, and with cell numbers for
/// inverted, degenerate or non-manifold meshes.
Mesh make_mesh(scene::Scene const& scene, Mesher const& mesher);

std::vector<Quality> quality(Mesh const& mesh);

}  // namespace fissure::mesh
