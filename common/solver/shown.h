// The cells and vertices that output shows: padding and the parts of blocks are none of them.
#pragma once
#include <vector>

#include "model/model.h"

namespace fissure {

struct Shown {
  std::vector<Index> cells, number_of_cell;       // heads, body by body; each head's place among them, -1: not shown
  std::vector<Index> vertices, number_of_vertex;  // in the order that cells use them; each one's place among them

  template <int D, class Real>
  explicit Shown(model::Model<D, Real> const& model)
      : number_of_cell(model.elements.count, -1), number_of_vertex(model.vertices.count, -1) {
    for (Index e : model.elements.of_cell)
      if (model.cell_head(e) == e) {
        number_of_cell[e] = static_cast<Index>(cells.size());
        cells.push_back(e);
      }
    for (Index e : cells)
      for (Index vertex : model.cell_vertices(e)) {
        if (number_of_vertex[vertex] >= 0) continue;
        number_of_vertex[vertex] = static_cast<Index>(vertices.size());
        vertices.push_back(vertex);
      }
  }
};

}  // namespace fissure
