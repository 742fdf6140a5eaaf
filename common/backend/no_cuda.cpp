// The CUDA side of a build without nvcc.
#if !defined(FISSURE_CUDA)
#include <cstdlib>

#include "backend/device.h"

namespace fissure::cuda {
std::string why_not() { return "this program was built without CUDA"; }
std::string device_name() { std::abort(); }
void* allocate(std::size_t) { std::abort(); }
void release(void*) noexcept {}
void upload(void*, void const*, std::size_t) { std::abort(); }
void download(void*, void const*, std::size_t) { std::abort(); }
void wait() {}
}  // namespace fissure::cuda
#endif
