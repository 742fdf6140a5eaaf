// Meshes from Gmsh's .msh files, formats 2.2 and 4.1 in ASCII.
#pragma once
#include <string>
#include <string_view>

#include "mesh/part.h"

namespace fissure::mesh {

/// Simplices of `kind` with physical groups of every dimension as named groups (a group without a name is called by its
/// number). Cells in no group are read as well. Throws Error as `file:line: ...` for everything else: other versions,
/// binary files, other cells, second order, references to nothing, text that is no mesh.
Part read_msh(std::string const& file, std::string_view text, CellKind kind);

/// The same from a file on disk.
Part read_msh_file(std::string const& path, CellKind kind);

}  // namespace fissure::mesh
