// Shapes in two dimensions: plane sections, meshed with triangles.
#pragma once
#include "mesh/mesher.h"

namespace fissure::mesh {

/// Box, disc, ring and polygon are their section at mid-plane; a rod is its lengthwise section, a rectangle of width
/// 2 radius; a ball is its middle section, a circle.
Mesher const& mesher_2d();

}  // namespace fissure::mesh
