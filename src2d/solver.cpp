// The solver in both precisions.
#include "clip.h"
#include "dim.h"
#include "solver/element_launch.impl.h"
#include "solver/solver.impl.h"

namespace fissure {
template void element_forces<2, double>(Device&, model::Model<2, double>&, scene::Scene const&, ElementRun const&);
template void average_pressure<2, double>(Device&, model::Model<2, double>&);
template Sums<3> element_energy<2, double>(Device&, model::Model<2, double>&, scene::Scene const&, ElementRun const&);
template void element_stress<2, double>(Device&, model::Model<2, double>&, scene::Scene const&, ElementRun const&,
                                        double*);
template void start_by_stress<2, double>(Device&, model::Model<2, double>&, scene::Scene const&, ElementRun const&,
                                         FacesFound const&);
template Deformation element_deformation<2, double>(Device&, model::Model<2, double>&, scene::Scene const&);
template void element_forces<2, float>(Device&, model::Model<2, float>&, scene::Scene const&, ElementRun const&);
template void average_pressure<2, float>(Device&, model::Model<2, float>&);
template Sums<3> element_energy<2, float>(Device&, model::Model<2, float>&, scene::Scene const&, ElementRun const&);
template void element_stress<2, float>(Device&, model::Model<2, float>&, scene::Scene const&, ElementRun const&,
                                       double*);
template void start_by_stress<2, float>(Device&, model::Model<2, float>&, scene::Scene const&, ElementRun const&,
                                        FacesFound const&);
template Deformation element_deformation<2, float>(Device&, model::Model<2, float>&, scene::Scene const&);
template FrozenJoints<2, double> freeze_joints<2, double>(Device&, model::Model<2, double>&);
template void joint_forces<2, double>(Device&, model::Model<2, double>&, scene::Scene const&, FrozenJoints<2, double>&);
template FrozenJoints<2, float> freeze_joints<2, float>(Device&, model::Model<2, float>&);
template void joint_forces<2, float>(Device&, model::Model<2, float>&, scene::Scene const&, FrozenJoints<2, float>&);
template class model::Simplices<2, double>;
template class model::Blocks<2, double>;
template class model::Model<2, double>;
template class model::Simplices<2, float>;
template class model::Blocks<2, float>;
template class model::Model<2, float>;
template class Bonds<2, double>;
template class Bonds<2, float>;
template class StableStep<2, double>;
template class StableStep<2, float>;
template class Solver<2, double>;
template class Solver<2, float>;

template <>
std::unique_ptr<Simulation> make_simulation<2>(Device& device, scene::Scene const& scene, mesh::Mesh const& mesh,
                                               Precision precision) {
  if (precision == Precision::single) return std::make_unique<Solver<2, float>>(device, scene, mesh);
  return std::make_unique<Solver<2, double>>(device, scene, mesh);
}
}  // namespace fissure
