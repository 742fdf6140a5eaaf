// Element kernels in single precision.
#include "dim.h"

#include "solver/element_launch.impl.h"

namespace fissure {
template void element_forces<2, float>(Device&, model::Model<2, float>&, scene::Scene const&, ElementRun const&);
template Sums<3> element_energy<2, float>(Device&, model::Model<2, float>&, scene::Scene const&, ElementRun const&);
template void element_stress<2, float>(Device&, model::Model<2, float>&, scene::Scene const&, ElementRun const&, double*);
template double largest_gradients<2, float>(Device&, model::Model<2, float>&, scene::Scene const&);
}  // namespace fissure
