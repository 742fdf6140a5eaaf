// Shapes in three dimensions: solids, meshed with tetrahedra.
#pragma once
#include "mesh/mesher.h"

namespace fissure::mesh {

Mesher const& mesher_3d();
/// Disc, ring and polygon are extruded along z by their thickness about their mid-plane; a rod stands along y on its
/// base. Null without Gmsh.
Drawer const* drawer_3d();

}  // namespace fissure::mesh
