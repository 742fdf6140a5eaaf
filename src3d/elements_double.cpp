// Element kernels in double precision.
#include "dim.h"

#include "solver/element_launch.impl.h"

namespace fissure {
template void element_forces<3, double>(Device&, model::Model<3, double>&, scene::Scene const&, ElementRun const&);
template Sums<3> element_energy<3, double>(Device&, model::Model<3, double>&, scene::Scene const&, ElementRun const&);
template void element_stress<3, double>(Device&, model::Model<3, double>&, scene::Scene const&, ElementRun const&, double*);
template double largest_gradients<3, double>(Device&, model::Model<3, double>&, scene::Scene const&);
}  // namespace fissure
