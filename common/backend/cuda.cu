// The CUDA side of a device: its memory and its errors.
#include <string>

#include "backend/launch.cuh"
#include "base/error.h"

namespace fissure::cuda {
namespace {

std::string version_text(int version) {
  return std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 10);
}

std::string text_of(cudaError_t error) {
  return std::string(cudaGetErrorString(error)) + ", " + cudaGetErrorName(error);
}

/// Errors of kernels show in whatever asks next, so all of them are errors of the run.
void require(cudaError_t error, char const* doing) {
  if (error != cudaSuccess)
    throw Error(std::string("the GPU failed while ") + doing + " (" + text_of(error) + "); run with --backend cpu?");
}

__global__ void nothing() {}

template <class Word>
__global__ void gather_words(Word* to, Word const* from, std::size_t const* at, std::size_t n) {
  std::size_t const i = static_cast<std::size_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i < n) to[i] = from[at[i]];
}

/// Why that device cannot be used, or "".
std::string obstacle(int gpu) {
  int driver = 0, runtime = 0, devices = 0;
  cudaRuntimeGetVersion(&runtime);
  if (cudaDriverGetVersion(&driver) != cudaSuccess || driver == 0)
    return "there is no NVIDIA driver: libcuda is not installed";
  cudaError_t const counted = cudaGetDeviceCount(&devices);
  if (counted == cudaErrorInsufficientDriver)
    return "the NVIDIA driver knows CUDA " + version_text(driver) + ", this program needs " + version_text(runtime);
  if (counted == cudaErrorNoDevice || (counted == cudaSuccess && devices == 0))
    return "the NVIDIA driver sees no device";
  if (counted != cudaSuccess) return text_of(counted);
  if (gpu < 0 || gpu >= devices)
    return "there is no GPU " + std::to_string(gpu) + ": the driver sees " +
           (devices == 1 ? "one, number 0" : std::to_string(devices) + ", numbers 0 to " + std::to_string(devices - 1));
  if (cudaError_t const chosen = cudaSetDevice(gpu); chosen != cudaSuccess) return text_of(chosen);
  cudaFuncAttributes attributes;
  cudaError_t const fits = cudaFuncGetAttributes(&attributes, nothing);
  if (fits == cudaErrorNoKernelImageForDevice || fits == cudaErrorInvalidDeviceFunction)
    return device_name() +
           " has no code in this program: build it with -DCMAKE_CUDA_ARCHITECTURES=native on this machine";
  return fits == cudaSuccess ? "" : text_of(fits);
}

}  // namespace

std::string why_not(int gpu) {
  std::string const why = obstacle(gpu);
  cudaGetLastError();  // what was found out here is no error of what comes
  return why;
}

std::string device_name() {
  int device = 0;
  cudaDeviceProp properties;
  require(cudaGetDevice(&device), "being asked its number");
  require(cudaGetDeviceProperties(&properties, device), "being asked its name");
  return properties.name;
}

std::size_t free_memory() {
  std::size_t free = 0, all = 0;
  require(cudaMemGetInfo(&free, &all), "being asked for its memory");
  return free;
}

void* allocate(std::size_t bytes) {
  void* memory = nullptr;
  cudaError_t const error = cudaMalloc(&memory, bytes);
  if (error == cudaErrorMemoryAllocation) {
    cudaGetLastError();
    return nullptr;
  }
  require(error, "allocating memory");
  require(cudaMemset(memory, 0, bytes), "clearing memory");
  return memory;
}

void release(void* memory) noexcept { cudaFree(memory); }

void upload(void* to, void const* from, std::size_t bytes) {
  require(cudaMemcpy(to, from, bytes, cudaMemcpyHostToDevice), "copying to it");
}

void download(void* to, void const* from, std::size_t bytes) {
  require(cudaMemcpy(to, from, bytes, cudaMemcpyDeviceToHost), "computing or copying from it");
}

void gather(void* to, void const* from, std::size_t const* at, std::size_t n, std::size_t size) {
  double* const values = scratch(2 * n);
  auto* const places = reinterpret_cast<std::size_t*>(values + n);
  upload(places, at, n * sizeof *at);
  auto const blocks = static_cast<unsigned>((n + 127) / 128);
  if (size == 8)
    gather_words<<<blocks, 128>>>(values, static_cast<double const*>(from), places, n);
  else if (size == 4)
    gather_words<<<blocks, 128>>>(reinterpret_cast<float*>(values), static_cast<float const*>(from), places, n);
  else
    gather_words<<<blocks, 128>>>(reinterpret_cast<char*>(values), static_cast<char const*>(from), places, n);
  check_launch("gather");
  download(to, values, n * size);
}

void wait(char const* kernel) {
  std::string const doing = kernel ? "computing \"" + std::string(kernel) + "\"" : "computing";
  require(cudaDeviceSynchronize(), doing.c_str());
}

void check_launch(char const* kernel) {
  cudaError_t const error = cudaGetLastError();
  if (error != cudaSuccess)
    throw Error("the GPU failed at kernel \"" + std::string(kernel) + "\" or before it (" + text_of(error) +
                "); run with --backend cpu?");
}

double* scratch(std::size_t n) {
  static double* memory = nullptr;
  static std::size_t size = 0;
  if (n > size) {
    release(memory);
    memory = nullptr, size = 0;
    memory = static_cast<double*>(allocate(n * sizeof(double)));
    if (!memory) throw Error("the GPU has no memory for sums; use a coarser mesh?");
    size = n;
  }
  return memory;
}

}  // namespace fissure::cuda
