// Bodies drawn larger or smaller.
#pragma once
#include <vector>

#include "scene/scene.h"

namespace fissure::mesh {

/// The shortest length that bodies are given by, mesh sizes too [m].
double least_length(std::vector<scene::Body> const& bodies);
/// The bodies and their mesh sizes times a factor.
std::vector<scene::Body> scaled(std::vector<scene::Body> bodies, double factor);

}  // namespace fissure::mesh
