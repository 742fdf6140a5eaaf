// The solver in both precisions.
#include "clip.h"
#include "dim.h"
#include "solver/element_launch.impl.h"
#include "solver/solver.impl.h"

namespace fissure {
template void element_forces<3, double>(Device&, model::Model<3, double>&, scene::Scene const&, ElementRun const&);
template void average_pressure<3, double>(Device&, model::Model<3, double>&);
template Sums<3> element_energy<3, double>(Device&, model::Model<3, double>&, scene::Scene const&, ElementRun const&);
template void element_stress<3, double>(Device&, model::Model<3, double>&, scene::Scene const&, ElementRun const&,
                                        double*);
template void start_by_stress<3, double>(Device&, model::Model<3, double>&, scene::Scene const&, ElementRun const&,
                                         FacesFound const&);
template Deformation element_deformation<3, double>(Device&, model::Model<3, double>&, scene::Scene const&);
template void element_forces<3, float>(Device&, model::Model<3, float>&, scene::Scene const&, ElementRun const&);
template void average_pressure<3, float>(Device&, model::Model<3, float>&);
template Sums<3> element_energy<3, float>(Device&, model::Model<3, float>&, scene::Scene const&, ElementRun const&);
template void element_stress<3, float>(Device&, model::Model<3, float>&, scene::Scene const&, ElementRun const&,
                                       double*);
template void start_by_stress<3, float>(Device&, model::Model<3, float>&, scene::Scene const&, ElementRun const&,
                                        FacesFound const&);
template Deformation element_deformation<3, float>(Device&, model::Model<3, float>&, scene::Scene const&);
template FrozenJoints<3, double> freeze_joints<3, double>(Device&, model::Model<3, double>&);
template void joint_forces<3, double>(Device&, model::Model<3, double>&, scene::Scene const&, FrozenJoints<3, double>&);
template FrozenJoints<3, float> freeze_joints<3, float>(Device&, model::Model<3, float>&);
template void joint_forces<3, float>(Device&, model::Model<3, float>&, scene::Scene const&, FrozenJoints<3, float>&);
template class model::Simplices<3, double>;
template class model::Blocks<3, double>;
template class model::Model<3, double>;
template class model::Simplices<3, float>;
template class model::Blocks<3, float>;
template class model::Model<3, float>;
template class Bonds<3, double>;
template class Bonds<3, float>;
template class StableStep<3, double>;
template class StableStep<3, float>;
template class Solver<3, double>;
template class Solver<3, float>;

template <>
std::unique_ptr<Simulation> make_simulation<3>(Device& device, scene::Scene const& scene, mesh::Mesh const& mesh,
                                               Precision precision) {
  if (precision == Precision::single) return std::make_unique<Solver<3, float>>(device, scene, mesh);
  return std::make_unique<Solver<3, double>>(device, scene, mesh);
}
}  // namespace fissure
