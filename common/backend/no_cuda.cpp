// The CUDA side of a build without nvcc.
#if !defined(FISSURE_CUDA)
#include <cstdlib>

#include "backend/device.h"

namespace fissure::cuda {
std::string why_not(int) { return "this program was built without CUDA"; }
std::string device_name() { std::abort(); }
std::size_t free_memory() { std::abort(); }
void* allocate(std::size_t) { std::abort(); }
void release(void*) noexcept {}
void upload(void*, void const*, std::size_t) { std::abort(); }
void download(void*, void const*, std::size_t) { std::abort(); }
void gather(void*, void const*, std::size_t const*, std::size_t, std::size_t) { std::abort(); }
void wait(char const*) {}
}  // namespace fissure::cuda
#endif
