#include "backend/device.h"

#include <omp.h>
#include <sys/mman.h>

#include <cstdlib>
#include <cstring>

#include "base/error.h"

namespace fissure {

Device Device::select(std::string const& asked, int threads) {
  char const* const wish = std::getenv("FISSURE_BACKEND");
  bool const wished = asked == "auto" && wish && *wish;
  std::string const name = wished ? wish : asked;
  if (name != "auto" && name != "cpu" && name != "cuda")
    throw Error((wished ? "FISSURE_BACKEND: " : "") + ("unknown backend \"" + name) + "\" (known: auto, cpu, cuda)" +
                suggestion(name, {"auto", "cpu", "cuda"}));
  std::string const obstacle = name == "cpu" ? "not asked for" : cuda::why_not();
  if (name == "cuda" && !obstacle.empty())
    throw Error("backend \"cuda\" cannot be used (" + obstacle + "); run with --backend cpu?");
  Device device;
  device.backend_ = obstacle.empty() ? Backend::cuda : Backend::cpu;
  device.threads_ = threads > 0 ? threads : omp_get_max_threads();
  device.name_ = device.backend_ == Backend::cuda
                     ? cuda::device_name()
                     : "CPU, " + std::to_string(device.threads_) + (device.threads_ == 1 ? " thread" : " threads");
  return device;
}

std::string Device::describe() const { return name_; }

std::size_t Device::bytes() const {
  std::size_t sum = 0;
  for (auto const& [name, size] : arrays_) sum += size;
  return sum;
}

void* Device::allocate(std::string const& array, std::size_t bytes) {
  if (bytes == 0) return nullptr;
  void* memory = nullptr;
  if (backend_ == Backend::cuda) {
    memory = cuda::allocate(bytes);
  } else {
    // Big arrays on huge pages: gathers over scattered neighbours otherwise miss the TLB.
    std::size_t const page = std::size_t{1} << 21, unit = bytes >= page ? page : 64;
    memory = std::aligned_alloc(unit, (bytes + unit - 1) / unit * unit);
    if (memory && unit == page) madvise(memory, bytes, MADV_HUGEPAGE);
    if (memory) std::memset(memory, 0, bytes);
  }
  if (!memory) throw Error("no memory for " + array + " (" + std::to_string(bytes >> 20) + " MiB); use a coarser mesh?");
  arrays_[array] += bytes;
  return memory;
}

void Device::release(std::string const& array, std::size_t bytes, void* memory) noexcept {
  if (!memory) return;
  if (backend_ == Backend::cuda)
    cuda::release(memory);
  else
    std::free(memory);
  auto const entry = arrays_.find(array);
  if (entry != arrays_.end() && (entry->second -= bytes) == 0) arrays_.erase(entry);
}

void Device::upload(void* to, void const* from, std::size_t bytes) {
  if (bytes == 0) return;
  if (backend_ == Backend::cuda)
    cuda::upload(to, from, bytes);
  else
    std::memcpy(to, from, bytes);
}

void Device::download(void* to, void const* from, std::size_t bytes) {
  if (bytes == 0) return;
  if (backend_ == Backend::cuda)
    cuda::download(to, from, bytes);
  else
    std::memcpy(to, from, bytes);
}

void Device::wait() {
  if (backend_ == Backend::cuda) cuda::wait();
}

}  // namespace fissure
