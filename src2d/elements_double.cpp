// Element kernels in double precision.
#include "dim.h"

#include "solver/element_launch.impl.h"

namespace fissure {
template void element_forces<2, double>(Device&, model::Model<2, double>&, scene::Scene const&, ElementRun const&);
template Sums<3> element_energy<2, double>(Device&, model::Model<2, double>&, scene::Scene const&, ElementRun const&);
template void element_stress<2, double>(Device&, model::Model<2, double>&, scene::Scene const&, ElementRun const&, double*);
template double largest_gradients<2, double>(Device&, model::Model<2, double>&, scene::Scene const&);
}  // namespace fissure
