// Vertices: what moves; and the slots that cells' forces reach them by.
#pragma once
#include <array>
#include <vector>

#include "backend/buffer.h"

namespace fissure::model {

/// A mesh node is one vertex, or, where a body can crack, one for each cell's corner at it. Padding has no mass.
template <int D, class Real>
struct Vertices {
  Index count = 0;
  Buffer<Real> u, v, force;                      // [vertex][D] displacement [m], velocity [m/s], internal force [N]
  Buffer<Real> inverse_mass;                     // lumped [1/kg]
  Buffer<Index> on_axis;                         // the axis of revolution: they stay there
  std::vector<std::array<double, D>> reference;  // on the host: place at rest, about the origin [m]
  std::vector<double> start;                     // [vertex][D] u at the start [m]; empty: 0
  std::vector<double> mass;                      // on the host, scaled [kg]
  // What a vertex opposes to contact [kg]: its mass; where it is of a rigid body that holds move altogether, far more.
  std::vector<double> inertia;
  Buffer<Real> inverse_inertia;  // where it differs from that of mass, else empty [1/kg]
};

/// Where cells share vertices: a force for each corner of each cell [N], and per vertex the list of those it sums.
template <class Real>
struct CornerSlots {
  Buffer<Real> force;
  Buffer<Index> first, list;
};

}  // namespace fissure::model
