// What elastoplastic laws remember, and the pressure that they share about a node.
#pragma once
#include <vector>

#include "backend/buffer.h"

namespace fissure::model {

/// Internal variables of elements and of blocks' points that flow, body by body, each law's own numbers.
template <class Real>
struct InternalVariables {
  Buffer<Real> memory;
  Buffer<double> work;                 // dissipated by flow [J]: of elements, then of blocks' points
  std::vector<Buffer<double>> curves;  // yield stresses [Pa]
};

/// Averaged pressure: the corners at a node whose elements are still joined about it share one (a patch).
template <class Real>
struct PressurePatches {
  Buffer<Index> of_corner;        // blocked as Elements::vertex
  Buffer<Index> first, list;      // elements of each
  Buffer<Real> pressure, energy;  // [Pa], [J/m^3]
  Buffer<Real> swelling, volume;  // of elements: change of volume and volume [m^3]
};

}  // namespace fissure::model
