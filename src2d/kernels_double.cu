// Kernels for CUDA in double precision.
#include "clip.h"
#include "dim.h"
#include "kernels/instances.h"

namespace fissure::kernels {
template void compile_elements<2, double>();
template void compile_rest<2, double>();
}  // namespace fissure::kernels
