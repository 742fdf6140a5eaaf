// Element kernels in single precision.
#include "dim.h"

#include "solver/element_launch.impl.h"

namespace fissure {
template void element_forces<3, float>(Device&, model::Model<3, float>&, scene::Scene const&, ElementRun const&);
template Sums<3> element_energy<3, float>(Device&, model::Model<3, float>&, scene::Scene const&, ElementRun const&);
template void element_stress<3, float>(Device&, model::Model<3, float>&, scene::Scene const&, ElementRun const&, double*);
template double largest_gradients<3, float>(Device&, model::Model<3, float>&, scene::Scene const&);
}  // namespace fissure
