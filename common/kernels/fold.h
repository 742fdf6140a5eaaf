// Whether two faces that belong together have folded about each other.
#pragma once
#include <Eigen/Dense>

#include "base/dim.h"
#include "base/lanes.h"

namespace fissure::kernels {

/// True where two faces have turned about each other by more than 120 degrees about an edge, or by more than 90 about
/// their normal: the surface midway between them has less than half their area, its normal means nothing and in the end
/// turns over. `middle`: spans of that surface [m]; `turn`: by how much those of either face differ from them, one
/// less, one more [m].
template <int D, class S>
FISSURE_HD MaskOf<S> folded(Eigen::Matrix<S, D, D - 1> const& middle, Eigen::Matrix<S, D, D - 1> const& turn) {
  auto const squared_area = [](Eigen::Matrix<S, D, D - 1> const& spans) {
    return Eigen::Matrix<S, D - 1, D - 1>(spans.transpose() * spans).determinant();
  };
  return S(4) * squared_area(middle) < root(squared_area(middle - turn)) * root(squared_area(middle + turn));
}

}  // namespace fissure::kernels
