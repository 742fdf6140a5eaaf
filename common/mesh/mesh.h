// A mesh as plain data: nodes, cells by body, faces found by name. Made by generators or read from files; refused when
// broken.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace fissure::mesh {

/// Simplices by kind; node order is VTK's.
enum class CellKind { triangle, tetrahedron };

inline int node_count(CellKind kind) { return kind == CellKind::triangle ? 3 : 4; }
/// Corners of a block, a quadrilateral or hexahedron, in VTK's order.
inline int block_corners(CellKind kind) { return kind == CellKind::triangle ? 4 : 8; }
/// Simplices that a block is made of.
inline int block_parts(CellKind kind) { return kind == CellKind::triangle ? 2 : 6; }

/// A boundary face of a cell: edge in 2D, triangle in 3D, ordered so that its normal points outward
/// (2D: outward is to the right of from -> to).
struct Face {
  int cell;
  std::array<int, 4> node;
};

/// A face between bodies that bonds hold together: cell * node_count(kind) + a on both sides, and the index into
/// Scene::bonds. Not all of them are joined: others are a crack from the start, since their corners may be.
struct BondedFace {
  std::array<int, 2> use;
  int bond;
  bool joined = true;
};

/// A node that a tie hangs on a cell of another body, by shares in that cell's corners, and the index into Scene::ties.
struct HungNode {
  int node, cell, tie;
  std::array<double, 4> share;  // 1 together
};
/// Whether it hangs on corner a of that cell: on a face, the corner opposite to it carries nothing.
inline bool carries(HungNode const& hung, int a) { return std::abs(hung.share[a]) > 1e-12; }

/// Bodies never share nodes; nodes within a body are shared by its cells. All cells are simplices: a block lies in the
/// mesh as its parts, simplices that share its corners. Surfaces, places, contact and cracks know only them; the forces
/// inside a block are those of its own shape (kernels/blocks.h).
struct Mesh {
  CellKind kind = CellKind::triangle;
  std::vector<Vec3> nodes;  // [m]; z = 0 in 2D; numbered by first use
  std::vector<int> cells;   // node_count(kind) per cell; positive orientation; along a Hilbert curve in a body
  // n_bodies + 1; body b has cells [b, b + 1): first those that are no part of a block
  std::vector<int> body_first_cell;
  std::vector<int> blocks;            // block_corners(kind) nodes per block, in the order of their parts
  std::vector<int> body_first_block;  // n_bodies + 1; empty: no body has blocks
  std::vector<int> body_first_node;   // n_bodies + 1
  std::vector<Face> boundary;         // outer faces that no bond joins, ordered by cell
  std::vector<BondedFace> bonded;     // those that are joined first, by bond and cell
  // per node: of those that bonds hold at one place the lowest; empty: there are no bonds
  std::vector<int> twin;
  std::vector<HungNode> hung;  // by tie and node
  // Per body: "left" -> nodes (global numbers, ascending), and indices into boundary (ascending).
  std::vector<std::map<std::string, std::vector<int>>> named_nodes, named_faces;
  double thickness = 1;  // out of plane [m]: Scene::out_of_plane in 2D, 1 in 3D

  int n_cells() const { return static_cast<int>(cells.size()) / node_count(kind); }
  int n_blocks(int body) const {
    return body_first_block.empty() ? 0 : body_first_block[body + 1] - body_first_block[body];
  }
  /// Cells of a body that are no part of a block: they stand first.
  int n_simplices(int body) const {
    return body_first_cell[body + 1] - body_first_cell[body] - n_blocks(body) * block_parts(kind);
  }
  /// The block that a cell is part of; -1: none.
  int block_of(int body, int cell) const {
    int const part = cell - body_first_cell[body] - n_simplices(body);
    return part < 0 ? -1 : body_first_block[body] + part / block_parts(kind);
  }
  int n_bodies() const { return static_cast<int>(body_first_cell.size()) - 1; }
  int body_of_cell(int cell) const {
    return static_cast<int>(std::upper_bound(body_first_cell.begin(), body_first_cell.end(), cell) -
                            body_first_cell.begin()) -
           1;
  }
  int body_of_node(int node) const {
    return static_cast<int>(std::upper_bound(body_first_node.begin(), body_first_node.end(), node) -
                            body_first_node.begin()) -
           1;
  }
  /// The node that stands for all that bonds hold at its place.
  int place(int node) const { return twin.empty() ? node : twin[node]; }
};

/// Per body, printed by `check` and at the start of a run. Edges and shapes are those of simplices and blocks.
struct Quality {
  int cells = 0, nodes = 0;  // cells: simplices and blocks
  int blocks = 0;
  double least_edge = 0, mean_edge = 0, largest_edge = 0;  // [m]
  // simplex: d * inradius / circumradius; block: least scaled Jacobian; 1 regular, 0 flat
  double least_shape = 0, mean_shape = 0;
  int worst_cell = -1;  // its number in results
  Vec3 worst_place{0, 0, 0};
  // least altitude of the worst cell, and of a cell on average [m]
  double worst_altitude = 0, mean_altitude = 0;
  double measure = 0;  // area [m^2] or volume [m^3]
};

/// The CAD side of one dimension (mesh/mesher.h): what each shape is in it. src2d and src3d derive from it.
class Mesher;

/// Mesh every body of a scene with the cells of `mesher`. MeshSpec::size is Gmsh's: the length of edges on the surface;
/// inside a volume they are a quarter longer on average (tetrahedra do not fill space).
/// Throws Error with the body's place for shapes that cannot be meshed, and with cell numbers for
/// degenerate, overlapping or non-manifold meshes. Two calls give the same mesh to the last bit.
///
/// Named places of every body: "all" (nodes only), "surface", "left"/"right" (least/largest x), "bottom"/"top" (y),
/// "back"/"front" (z), and the physical groups of a mesh file, which win over these. A side is made of the boundary
/// faces whose outward normal is within 20 degrees of the axis and whose nodes all lie at the body's extreme (within
/// 1e-6 of its size). Where the body is round there and has no such face, it is the faces about the extreme: all nodes
/// within the depth that a circle as wide as the body is along the axis reaches 1.5 mean edges from its top. Where
/// there is no such face either (a sharp tip) the place has the extreme nodes and no faces.
Mesh make_mesh(scene::Scene const& scene, Mesher const& mesher);

/// One body: a box as a regular grid of about `spacing` [m], at least one cell along every axis, each cell cut into
/// simplices (2 triangles or 6 tetrahedra) as in Todd's triangulation J1: neighbours are mirror images, so that no
/// direction is preferred (in the plane: the union jack) and the mesh of a box is as symmetric as the box.
Mesh structured_box(CellKind kind, Vec3 const& center, Vec3 const& size, double spacing);

/// For every cell the cell across its face a (opposite to its corner a), of its body or bonded to it, -1 at the
/// boundary: node_count(kind) per cell.
std::vector<int> neighbours(Mesh const& mesh);

/// Whether a body fills the space between any two of its points, to within half an edge where its surface is smooth
/// (triangles on a round surface leave hollows of that kind): then it cannot touch itself while its strains are small.
bool convex(Mesh const& mesh, int body);

/// One entry per body.
std::vector<Quality> quality(Mesh const& mesh);

/// A cell whose radius ratio lies below this is a sliver.
inline constexpr double good_shape = 0.1;

/// What slivers cost, one line for every body that has one.
std::vector<std::string> warnings(scene::Scene const& scene, Mesh const& mesh);

/// Strengths of joints over those of their material, of every face of every cell (opposite to its corner a), the same
/// from both sides; empty: all are 1. 0: broken before anything moves. `lines`: what each joint set consists of;
/// `doubts`: what may not be meant. Bonds have strengths of their own; 1 is what the bond's joint says. Throws Error
/// with the set's place when no face belongs to it, or one belongs to two.
struct JointStrengths {
  std::vector<double> of_face;
  // 1: one of many faces that a crack may choose; 0: of a set or bond, which is a plane of its own
  std::vector<double> any_plane;
  std::vector<double> least;  // of each body's joints that hold at all, 1 at most; empty as of_face
  std::vector<std::string> lines, doubts;
};
JointStrengths joint_strengths(scene::Scene const& scene, Mesh const& mesh);

/// Largest extent of a body along an axis [m].
double width(Mesh const& mesh, int body);

/// What overlaps before anything has moved, and plates and walls that nothing touches: one line for each. `deepest`: of
/// all overlaps, as a share of an edge. `plates`, `walls`: whether something lies against each.
struct StartingContact {
  std::vector<std::string> overlaps, gaps;
  double deepest = 0;
  std::vector<bool> plates, walls;
};
StartingContact starting_contact(scene::Scene const& scene, Mesh const& mesh);

/// "disc: 12 345 triangles, 6 301 nodes, edges 0.8-1.4 mm (mean 1.0), worst shape 0.61 (cell 88), mean 0.94".
std::string describe(std::string const& body, CellKind kind, Quality const& quality);

}  // namespace fissure::mesh
