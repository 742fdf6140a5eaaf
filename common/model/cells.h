// Cells as sets: simplices (triangles, tetrahedra) and blocks (quadrilaterals, hexahedra), body by body.
#pragma once
#include <cstdint>
#include <vector>

#include "backend/buffer.h"

namespace fissure::model {

/// Simplices that are cells of their own, and those that a block is cut into, which only contact and output see. Padded
/// to whole packs with copies without mass. Numbers are blocked (kernels::blocked) where that is said.
template <class Real>
struct Elements {
  Index count = 0;
  Buffer<Real> X;                  // place of the corners at rest, about the origin, blocked [m]
  Buffer<Index> vertex;            // at each corner, blocked; empty when every corner is its own vertex
  Buffer<std::int8_t> parity;      // sign of the volume that the order of the corners gives
  Buffer<double> viscous_work;     // [J]
  std::vector<Index> host_vertex;  // as vertex
  std::vector<int> node;           // [element][corner] of the mesh, of twins the lowest, ascending; -1: padding
  std::vector<Index> cell;         // of the mesh; -1: padding
  std::vector<Index> of_cell;      // the element of each
  std::vector<int> body;           // -1: padding
};

template <class Real>
struct Blocks {
  Index count = 0;                    // padded
  Index parts = 1;                    // simplices that one is cut into
  Buffer<Index> vertex;               // at each of 2^D corners, blocked
  Buffer<Real> shapes;                // numbers of their shapes at rest, body by body
  std::vector<Index> host_vertex;     // as vertex
  std::vector<Real> host_shapes;      // as shapes
  std::vector<double> corner_volume;  // [block][2^D] what each corner gets of the volume [m^3]
};

}  // namespace fissure::model
