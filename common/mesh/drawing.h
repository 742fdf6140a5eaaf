// Bodies drawn in OpenCASCADE, in the Gmsh model that is current: what is then cut into cells.
#pragma once
#include <gmsh.h>

#include <utility>
#include <vector>

#include "mesh/mesher.h"

namespace fissure::mesh {

using Entities = gmsh::vectorpair;

/// Bodies that are meshed together, and the entities that each is made of.
struct Drawn {
  std::vector<scene::Body> const& bodies;
  std::vector<Entities> pieces;
};

/// Draws bodies; where several touch, and along their seams, pieces share their nodes. Throws Error.
Drawn draw(std::vector<scene::Body> const& bodies, Mesher const& mesher);

/// Length, area or volume of an entity.
double measure_of(std::pair<int, int> const& entity);
/// Where entities begin and end along z.
std::pair<double, double> depth(Entities const& entities);

}  // namespace fissure::mesh
