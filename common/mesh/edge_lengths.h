// How long edges are told to be from place to place, and what is refused before Gmsh takes for ever.
#pragma once
#include "mesh/drawing.h"

namespace fissure::mesh {

/// Edges grow by so much per length away from what asks for short ones.
inline constexpr double growth = 0.3;

/// Distance from a place to a line in the plane [m].
double distance(scene::Near const& near, double x, double y);
/// Refuses more cells near a place than are possible. `deep`: out of the plane [m], 0 in 2D. Throws Error.
void refuse_many_near(scene::Near const& near, double measure, double deep, scene::Body const& body,
                      Mesher const& mesher);
/// Tells Gmsh how long edges are where that depends on the place or the body: where bodies meet, the shorter.
void set_edge_lengths(Drawn const& drawn, double over);
/// Where most of the outline is cut finer than `size` (a polygon of many points), edges grow from there to `size`
/// inside. Returns the number of its short lines; 0: nothing was done.
int grow_inwards(double size);
/// Refuses the solid with too many lines shorter than half its edges: Gmsh's time grows with the square of their number
/// (half a minute for a prism of 1000 points, which has 2000). Throws Error.
void refuse_too_many_lines(Entities const& pieces, double over, scene::Body const& body, bool together);

}  // namespace fissure::mesh
