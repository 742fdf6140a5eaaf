// Where kernels run: the CPU's threads or a CUDA device, chosen when the program starts, never a template parameter.
#pragma once
#include <cstddef>
#include <map>
#include <string>

namespace fissure {

enum class Backend { cpu, cuda };

/// A device counts what it is asked to do, so that a test can hold a plan to "what is not modelled costs nothing".
class Device {
 public:
  /// `name`: "cpu", "cuda" or "auto": what the environment variable FISSURE_BACKEND says, else a usable GPU, else the CPU;
  /// `threads`: 0 takes all the machine has. Throws Error when the name is unknown or CUDA was asked for and cannot run
  /// here (and says why).
  static Device select(std::string const& name, int threads = 0);

  Backend backend() const { return backend_; }
  int threads() const { return threads_; }
  std::string describe() const;

  void* allocate(std::string const& array, std::size_t bytes);  // zeroed, 64-byte aligned; throws Error when there is no memory
  void release(std::string const& array, std::size_t bytes, void* memory) noexcept;
  void upload(void* to, void const* from, std::size_t bytes);   // host -> device
  void download(void* to, void const* from, std::size_t bytes); // device -> host
  void wait();                                                  // until everything launched has finished

  void count(char const* kernel) { ++launches_[kernel]; }
  std::map<std::string, long> const& launches() const { return launches_; }
  std::map<std::string, std::size_t> const& arrays() const { return arrays_; }  // bytes by name
  std::size_t bytes() const;

 private:
  Backend backend_ = Backend::cpu;
  int threads_ = 1;
  std::string name_;
  std::map<std::string, long> launches_;
  std::map<std::string, std::size_t> arrays_;
};

/// The CUDA side; without CUDA in the build every call but why_not() is unreachable.
namespace cuda {
std::string why_not();  // "" when a device is usable
std::string device_name();
void* allocate(std::size_t bytes);  // zeroed; null when there is no memory
void release(void* memory) noexcept;
void upload(void* to, void const* from, std::size_t bytes);
void download(void* to, void const* from, std::size_t bytes);
void wait();
}  // namespace cuda

}  // namespace fissure
