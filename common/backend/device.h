// Where kernels run: the CPU's threads or a CUDA device, chosen when the program starts, never a template parameter.
#pragma once
#include <cstddef>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

namespace fissure {

enum class Backend { cpu, cuda };

/// A device counts what it is asked to do, so that a test can hold a plan to "what is not modelled costs nothing".
class Device {
 public:
  /// `name`: "cpu", "cuda" or "auto": what the environment variable FISSURE_BACKEND says, else a usable GPU, else the
  /// CPU; `threads`: 0 takes all there are (OMP_NUM_THREADS of them where that is set); `gpu`: its number as nvidia-smi
  /// counts. Throws Error when the name is unknown or CUDA was asked for and cannot run here (and says why).
  static Device select(std::string const& name, int threads = 0, int gpu = 0);

  Backend backend() const { return backend_; }
  int threads() const { return threads_; }
  std::string describe() const;

  // zeroed, 64-byte aligned; throws Error when there is no memory
  void* allocate(std::string const& array, std::size_t bytes);
  void release(std::string const& array, std::size_t bytes, void* memory) noexcept;
  void upload(void* to, void const* from, std::size_t bytes);    // host -> device
  void download(void* to, void const* from, std::size_t bytes);  // device -> host
  /// Values of `size` bytes (1, 4 or 8) at these places of an array on the device, in one copy to the host.
  void gather(void* to, void const* from, std::vector<std::size_t> const& at, std::size_t size);
  void wait();  // until everything launched has finished

  /// Makes a launch, which it counts; where the device is watched, waits for the kernel, so that what fails is named,
  /// and times it.
  template <class Launch>
  auto run(char const* kernel, Launch const& launch) {
    ++launches_[kernel];
    double const start = watched_ ? now() : 0;
    if constexpr (std::is_void_v<decltype(launch())>) {
      launch();
      if (watched_) time(kernel, start);
    } else {
      auto const result = launch();
      if (watched_) time(kernel, start);
      return result;
    }
  }
  std::map<std::string, long> const& launches() const { return launches_; }
  /// Waits for every kernel and times it from now on: FISSURE_SYNC=1 in the environment does so from the start.
  void watch(bool on) { watched_ = on; }
  bool watched() const { return watched_; }
  std::map<std::string, double> const& times() const { return times_; }  // of kernels while watched [s]
  /// Copies between host and device, for each of which the host waits.
  long copies() const { return copies_; }
  std::size_t copied_bytes() const { return copied_bytes_; }
  void count_copy(std::size_t bytes) { ++copies_, copied_bytes_ += bytes; }
  std::map<std::string, std::size_t> const& arrays() const { return arrays_; }  // bytes by name
  std::size_t bytes() const;
  /// Memory that is free on the device, at most FISSURE_MEMORY of the environment [B].
  std::size_t room() const;

 private:
  static double now();
  void time(char const* kernel, double start);

  Backend backend_ = Backend::cpu;
  int threads_ = 1;
  std::string name_;
  bool watched_ = false;
  long copies_ = 0;
  std::size_t copied_bytes_ = 0;
  std::map<std::string, long> launches_;
  std::map<std::string, double> times_;
  std::map<std::string, std::size_t> arrays_;
};

/// The CUDA side; without CUDA in the build every call but why_not() is unreachable.
namespace cuda {
std::string why_not(int gpu);  // "" when that device is usable: it is the current one then
std::string device_name();
std::size_t free_memory();          // [B]
void* allocate(std::size_t bytes);  // zeroed; null when there is no memory
void release(void* memory) noexcept;
void upload(void* to, void const* from, std::size_t bytes);
void download(void* to, void const* from, std::size_t bytes);
void gather(void* to, void const* from, std::size_t const* at, std::size_t n, std::size_t size);
void wait(char const* kernel = nullptr);  // named when it fails
}  // namespace cuda

}  // namespace fissure
