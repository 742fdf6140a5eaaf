// Kernels for CPUs in single precision.
#include "clip.h"
#include "dim.h"
#include "kernels/instances.h"

namespace fissure::kernels {
template void compile_elements<3, float>();
template void compile_rest<3, float>();
}  // namespace fissure::kernels
