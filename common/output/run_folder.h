// The folder of a run: made with its parents, replaced only when an earlier run made it, never when it holds anything
// else.
#pragma once
#include <string>
#include <utility>

namespace fissure::output {

/// Makes `folder` and its parents and marks it with a file ".fissure". Throws Error when the folder is a file, is not
/// writable, or holds files but no mark.
void make_run_folder(std::string const& folder);

/// Removes results, frames, history, run.json and checkpoint of the run that was in a marked folder; other files stay.
void remove_earlier_run(std::string const& folder);

/// Held by the one run that writes in a folder, until it ends, however it ends.
class RunLock {
 public:
  RunLock() = default;
  /// Throws Error when another run holds it.
  explicit RunLock(std::string const& folder);
  RunLock(RunLock&& other) noexcept : handle_(std::exchange(other.handle_, -1)) {}
  RunLock& operator=(RunLock&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~RunLock();

 private:
  int handle_ = -1;
};

}  // namespace fissure::output
