// Kernels for CUDA in double precision.
#include "clip.h"
#include "dim.h"
#include "kernels/instances.h"

namespace fissure::kernels {
template void compile_elements<3, double>();
template void compile_rest<3, double>();
}  // namespace fissure::kernels
