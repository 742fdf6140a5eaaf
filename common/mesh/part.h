// A body's mesh as it comes from a generator or a file: not yet checked, oriented or ordered.
#pragma once
#include "mesh/mesh.h"

namespace fissure::mesh {

struct Part {
  std::vector<Vec3> nodes;
  std::vector<int> cells;                                           // node_count(kind) per cell
  std::string file;                                                 // where it was read, for messages; empty: generated
  std::vector<long long> labels;                                    // the file's number of each cell; empty: its index
  std::map<std::string, std::vector<int>> group_nodes;              // physical groups of any dimension
  std::map<std::string, std::vector<std::array<int, 3>>> group_faces;  // those of faces; unused nodes are -1
};

/// Check a part and append it to the mesh as its next body: cells turned to positive orientation and ordered along a
/// Hilbert curve of their centroids, nodes in order of first use, nodes of no cell dropped, places named.
/// Throws Error at `at` with the number and place of the first cell that is degenerate (radius ratio below 1e-6),
/// doubled, overlapping its neighbour, or third at a face.
void add_body(Mesh& mesh, Part part, std::string const& name, Source const& at);

/// Fill named_nodes and named_faces of the mesh's last body, which `part` became (its groups in the new numbering).
void name_places(Mesh& mesh, Part const& part);

/// An empty mesh of no bodies, for add_body.
Mesh no_bodies(CellKind kind);

/// The grid of structured_box().
Part structured_part(CellKind kind, Vec3 const& center, Vec3 const& size, double spacing);

/// Number of simplices that structured_part() would make.
double structured_count(CellKind kind, Vec3 const& size, double spacing);

/// Draw the shape with Gmsh and mesh it.
Part generate(scene::Body const& body, Mesher const& mesher);

/// Moves every inner node by at most `share` of its shortest edge, at random; cells that would become slivers stay.
void make_irregular(Part& part, CellKind kind, double share, unsigned seed);

/// Throws when a mesh would have more cells than any run could use (50 million).
void refuse_too_many(double cells, scene::Body const& body);

}  // namespace fissure::mesh
