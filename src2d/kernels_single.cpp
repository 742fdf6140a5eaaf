// Kernels for CPUs in single precision.
#include "clip.h"
#include "dim.h"
#include "kernels/instances.h"

namespace fissure::kernels {
template void compile_elements<2, float>();
template void compile_rest<2, float>();
}  // namespace fissure::kernels
