// What a run writes down, as plain data: the solver fills it, the writers know nothing of the solver.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace fissure::output {

/// One field over vertices or cells; 1, 3 (vector) or 6 (symmetric tensor xx yy zz xy yz zx) components, row by row.
struct Field {
  std::string name, unit;
  int components = 1;
  std::vector<double> values;
};

/// The cells whose topology never changes during a run, written once. Vertices are the solver's (a node split by joints
/// stands once per cell).
struct Topology {
  std::vector<std::int64_t> cells;  // vertex numbers, cell by cell
  // of each cell, VTK's: 5 triangle, 9 quadrilateral, 10 tetrahedron, 12 hexahedron
  std::vector<int> types;
  std::vector<std::int64_t> held = {};  // vertices with prescribed motion
  // plates, then walls as boxes without thickness: 9 or 12, corners of their own
  int rigid_cells = 0, rigid_type = 0;
};

/// Broken and breaking joints at one time, each a cell of its own with private points (VTK line 3 or triangle 5).
struct Cracks {
  int nodes_per_cell = 0;                 // 2: line, 3: triangle
  std::vector<double> points;             // 3 per point [m], cell by cell: middle surface, deformed
  std::vector<double> damage;             // per cell, 1 when broken
  std::vector<double> mode;               // share of slip in the work: 0 opening (I), 1 slip (II, III)
  std::vector<double> slip_out_of_plane;  // share of mode III in the slip, 3D only (0 in 2D)
  std::vector<double> time;               // when it broke [s]; -1 while softening
  std::vector<double> opening, slip;      // [m]
};

struct Frame {
  double time = 0;  // [s]
  long step = 0;
  std::vector<double> points;  // 3 per vertex, deformed [m]
  std::vector<Field> point_fields, cell_fields;
  Cracks cracks;
  std::vector<double> rigid_points = {};  // 3 per corner of a rigid cell [m]
};

}  // namespace fissure::output
