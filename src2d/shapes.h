// Shapes in two dimensions: plane sections, meshed with triangles.
#pragma once
#include "mesh/mesher.h"

namespace fissure::mesh {

Mesher const& mesher_2d();
/// Box, disc, ring and polygon are their section at mid-plane; a rod is its lengthwise section, a rectangle of width
/// 2 radius; a ball is its middle section, a circle. Null without Gmsh.
Drawer const* drawer_2d();
/// Sections of bodies of revolution about the y axis, at x >= 0. Null without Gmsh.
Drawer const* axisymmetric_drawer();

}  // namespace fissure::mesh
