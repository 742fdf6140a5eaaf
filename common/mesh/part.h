// A body's mesh as it comes from a generator or a file: not yet checked, oriented or ordered.
#pragma once
#include <optional>

#include "mesh/mesh.h"

namespace fissure::mesh {

struct Part {
  std::vector<Vec3> nodes;
  std::vector<int> cells;  // node_count(kind) per simplex
  std::string file;        // where it was read, for messages; empty: generated
  // the file's number of each simplex, then of each block; empty: its index
  std::vector<long long> labels;
  std::map<std::string, std::vector<int>> group_nodes;                 // physical groups of any dimension
  std::map<std::string, std::vector<std::array<int, 3>>> group_faces;  // those of faces of cells; unused nodes are -1
  std::vector<int> blocks;                                             // block_corners(kind) per block
};

/// Check a part and append it to the mesh as its next body: cells turned to positive orientation and ordered along a
/// Hilbert curve of their centroids, nodes in order of first use, nodes of no cell dropped, places named.
/// Blocks are split into their parts; two that share a face split it along the same diagonal.
/// Throws Error at `at` with the number and place of the first cell that is degenerate (radius ratio below 1e-6),
/// doubled, overlapping its neighbour, or third at a face.
void add_body(Mesh& mesh, Part part, std::string const& name, Source const& at);

/// Fill named_nodes and named_faces of the mesh's last body, which `part` became (its groups in the new numbering).
void name_places(Mesh& mesh, Part const& part);

/// Boundary faces of a body that lie on other faces of it, or of another body, the other way around.
struct DoubledFaces {
  int count = 0;           // all of them
  bool unmatched = false;  // one has a node that no node of the other side meets
  Vec3 place{0, 0, 0};     // of that node, else of the first face [m]
  // of faces that have all nodes in common, one of each body: indices into the boundary
  std::vector<std::array<int, 2>> pairs;
};
DoubledFaces doubled_faces(Mesh const& mesh, int body);
DoubledFaces doubled_faces(Mesh const& mesh, int body, int other);
/// Throws Error where nodes of such faces of the mesh's last body do not match.
void refuse_unmatched_faces(Mesh const& mesh, std::string const& name, Source const& at);

/// Joins bodies by the scene's bonds, once all of them are in the mesh: fills `bonded` and `twin` and takes the faces
/// that are bonded from the boundary. Throws Error at a bond's place when two of its bodies do not meet or their nodes
/// do not match there.
void bond_bodies(Mesh& mesh, scene::Scene const& scene);

/// Hangs the surfaces of tied bodies on each other: fills `hung`. Throws Error at a tie's place when its bodies do not
/// meet.
void tie_bodies(Mesh& mesh, scene::Scene const& scene);

/// An empty mesh of no bodies, for add_body.
Mesh no_bodies(CellKind kind);

/// The grid of structured_box(); as blocks: not cut.
Part structured_part(CellKind kind, Vec3 const& center, Vec3 const& size, double spacing, bool as_blocks = false);
/// The same of n cells along each axis (0 along one that there is not).
Part structured_part(CellKind kind, Vec3 const& center, Vec3 const& size, std::array<int, 3> const& n, bool as_blocks);

/// A regular mesh of blocks of a rod, disc, ring or ball (but in axisymmetry): rings of blocks, and a square or cube in
/// the middle of what is round. Nothing for other shapes.
std::optional<Part> block_part(scene::Body const& body, Mesher const& mesher);

/// Number of simplices that structured_part() would make.
double structured_count(CellKind kind, Vec3 const& size, double spacing);

/// Draw the shape of a body with Gmsh and mesh it; as blocks where the body asks for them: triangles recombined in 2D,
/// in 3D those of the base in layers where the shape is a prism along z, else every tetrahedron cut into four
/// hexahedra. Of several bodies, all of simplices, the nodes match where they meet. One part for each.
std::vector<Part> generate(std::vector<scene::Body> const& bodies, Mesher const& mesher);

/// Moves every inner node by at most `share` of its shortest edge, at random; cells that would become slivers stay.
void make_irregular(Part& part, CellKind kind, double share, unsigned seed);

/// Cells that a mesh can have: 50 million, fewer where this machine's memory does not hold them.
double most_cells();

/// Throws when a mesh would have more cells than that.
void refuse_too_many(double cells, scene::Body const& body, int dimension);

}  // namespace fissure::mesh
