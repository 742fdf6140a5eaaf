#include "backend/device.h"

#include <sched.h>
#include <sys/mman.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "base/error.h"

namespace fissure {

namespace {

/// A whole number above 0 that the environment gives, or 0.
std::size_t environment(char const* name) {
  char const* const text = std::getenv(name);
  if (!text || !*text) return 0;
  char* end = nullptr;
  double const value = std::strtod(text, &end);
  if (*end != '\0' || !(value >= 1 && value < 1e18))
    throw Error(std::string(name) + ": \"" + text + "\" is not a number of 1 or more");
  return static_cast<std::size_t>(value);
}

/// Processors this process may run on, or fewer where OMP_NUM_THREADS, which users of other programs know, says so.
int all_threads() {
  if (std::size_t const asked = environment("OMP_NUM_THREADS"))
    return static_cast<int>(std::min(asked, std::size_t{1024}));
  cpu_set_t mine;
  return sched_getaffinity(0, sizeof mine, &mine) == 0 ? std::max(CPU_COUNT(&mine), 1) : 1;
}

/// Memory that Linux could give to a program [B]; all there is where it does not say.
std::size_t free_host_memory() {
  std::ifstream file("/proc/meminfo");
  std::string word;
  std::size_t kilobytes = 0;
  while (file >> word)
    if (word == "MemAvailable:" && file >> kilobytes) return kilobytes * 1024;
  return static_cast<std::size_t>(-1);
}

}  // namespace

Device Device::select(std::string const& asked, int threads, int gpu) {
  char const* const wish = std::getenv("FISSURE_BACKEND");
  bool const wished = asked == "auto" && wish && *wish;
  std::string const name = wished ? wish : asked;
  if (name != "auto" && name != "cpu" && name != "cuda")
    throw Error((wished ? "FISSURE_BACKEND: " : "") + ("unknown backend \"" + name) + "\" (known: auto, cpu, cuda)" +
                suggestion(name, {"auto", "cpu", "cuda"}));
  std::string const obstacle = name == "cpu" ? "not asked for" : cuda::why_not(gpu);
  if (name == "cuda" && !obstacle.empty())
    throw Error("backend \"cuda\" cannot be used (" + obstacle + "); run with --backend cpu?");
  Device device;
  device.backend_ = obstacle.empty() ? Backend::cuda : Backend::cpu;
  device.threads_ = threads > 0 ? threads : all_threads();
  device.name_ = device.backend_ == Backend::cuda
                     ? cuda::device_name()
                     : "CPU, " + std::to_string(device.threads_) + (device.threads_ == 1 ? " thread" : " threads");
  device.watched_ = environment("FISSURE_SYNC") > 0;
  return device;
}

std::size_t Device::room() const {
  std::size_t const free = backend_ == Backend::cuda ? cuda::free_memory() : free_host_memory(),
                    most = environment("FISSURE_MEMORY");
  return most > 0 ? std::min(free, most) : free;
}

double Device::now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void Device::time(char const* kernel, double start) {
  if (backend_ == Backend::cuda) cuda::wait(kernel);
  times_[kernel] += now() - start;
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
  if (!memory)
    throw Error("no memory for " + array + " (" + std::to_string(bytes >> 20) + " MiB); use a coarser mesh?");
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
  count_copy(bytes);
  if (backend_ == Backend::cuda)
    cuda::upload(to, from, bytes);
  else
    std::memcpy(to, from, bytes);
}

void Device::download(void* to, void const* from, std::size_t bytes) {
  if (bytes == 0) return;
  count_copy(bytes);
  if (backend_ == Backend::cuda)
    cuda::download(to, from, bytes);
  else
    std::memcpy(to, from, bytes);
}

void Device::gather(void* to, void const* from, std::vector<std::size_t> const& at, std::size_t size) {
  count_copy(at.size() * size);
  if (backend_ == Backend::cuda) return cuda::gather(to, from, at.data(), at.size(), size);
  for (std::size_t i = 0; i < at.size(); ++i)
    std::memcpy(static_cast<char*>(to) + i * size, static_cast<char const*>(from) + at[i] * size, size);
}

void Device::wait() {
  if (backend_ == Backend::cuda) cuda::wait();
}

}  // namespace fissure
