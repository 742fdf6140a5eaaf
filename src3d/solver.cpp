// The solver in both precisions.
#include "clip.h"
#include "dim.h"

#include "solver/frame.impl.h"

namespace fissure {
template class model::Model<3, double>;
template class model::Model<3, float>;
template class Solver<3, double>;
template class Solver<3, float>;

template <>
std::unique_ptr<Simulation> make_simulation<3>(Device& device, scene::Scene const& scene, mesh::Mesh const& mesh, Precision precision) {
  if (precision == Precision::single) return std::make_unique<Solver<3, float>>(device, scene, mesh);
  return std::make_unique<Solver<3, double>>(device, scene, mesh);
}
}  // namespace fissure
