#include "output/run_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "output/file.h"

namespace fissure::output {

namespace fs = std::filesystem;

namespace {

constexpr char const* mark = ".fissure";

void remove_files(fs::path const& folder) {
  for (auto const* name : {"run.json", "results.xdmf", "results.vtkhdf", "cracks.xdmf", "cracks.vtkhdf", "history.csv",
                           "history.h5", "checkpoint.bin"})
    for (auto const* ending : {"", ".part"}) fs::remove(folder / (std::string(name) + ending));
  fs::path const frames = folder / "frames";
  if (!fs::is_directory(fs::symlink_status(frames))) return;
  for (auto const& entry : fs::directory_iterator(frames))
    if (entry.path().extension() == ".h5" || entry.path().extension() == ".part") fs::remove(entry.path());
}

}  // namespace

void make_run_folder(std::string const& name) {
  fs::path const folder(name);
  std::error_code failed;
  if (fs::exists(folder, failed) && !fs::is_directory(folder, failed))
    throw Error(name + ": is a file (results need a folder); choose another name with --out");
  try {
    fs::create_directories(folder);
    for (auto const& entry : fs::directory_iterator(folder)) {
      if (fs::exists(folder / mark)) break;
      std::string const first = entry.path().filename().string();
      if (first != std::string(mark) + ".part")  // a run was killed right after its start
        throw Error(name + ": already holds files that are no run of Fissure (\"" + first +
                    "\"); choose another folder with --out");
    }
  } catch (fs::filesystem_error const& error) {
    throw file_error(name, "made ready for results", error.code().value());
  }
  write_whole((folder / mark).string(),
              "This folder is a run of Fissure. While this file is here, a new run may replace the results in it.\n");
}

void remove_earlier_run(std::string const& folder) {
  try {
    remove_files(folder);
  } catch (fs::filesystem_error const& error) {
    throw file_error(folder, "made ready for results", error.code().value());
  }
}

RunLock::RunLock(std::string const& folder) : handle_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  // some file systems know no locks
  if (handle_ < 0 || ::flock(handle_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::close(std::exchange(handle_, -1));
  throw Error(folder + ": a run is going on there; wait for its end or choose another folder with --out");
}

RunLock::~RunLock() {
  if (handle_ >= 0) ::close(handle_);
}

}  // namespace fissure::output
