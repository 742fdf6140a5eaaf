// Files that are whole or not there: written beside their name, synced, renamed; a failure names path and reason.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace fissure::output {

/// A file that appears under its name only when it is complete. Until commit() an older file of that name stays
/// untouched, and a process killed on the way leaves nothing but `path.part`.
class AtomicFile {
 public:
  /// Opens `path.part`. Throws Error when the folder is missing or not writable.
  explicit AtomicFile(std::string path);
  ~AtomicFile();
  AtomicFile(AtomicFile const&) = delete;
  AtomicFile& operator=(AtomicFile const&) = delete;

  /// Throws Error when the disk is full or fails; the older file is still there.
  void write(std::span<std::byte const> bytes);
  /// Bytes are on the disk and the name points at them.
  void commit();

 private:
  [[noreturn]] void fail(int reason) const;
  std::string path_, part_;
  int file_ = -1;
};

void write_whole(std::string const& path, std::span<std::byte const> bytes);
void write_whole(std::string const& path, std::string_view text);

/// The whole file. Throws Error when it cannot be read.
std::string read_whole(std::string const& path);

/// "path: cannot be <done> (reason of the system); <what a user can do>"
Error file_error(std::string const& path, std::string const& done, int reason);

}  // namespace fissure::output
