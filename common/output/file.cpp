#include "output/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace fissure::output {

Error file_error(std::string const& path, std::string const& done, int reason) {
  std::string advice;
  switch (reason) {
    case ENOSPC:
    case EDQUOT:
      advice = "; free some space or choose another folder with --out";
      break;
    case EFBIG:
      advice = "; the file size limit of the shell or file system is reached (ulimit -f)";
      break;
    case EACCES:
    case EPERM:
    case EROFS:
      advice = "; choose a folder that you may write to with --out";
      break;
    case ENOENT:
      advice = "; does its folder exist?";
      break;
    case ENOTDIR:
      advice = "; a part of the path is a file, not a folder";
      break;
    default:
      break;
  }
  return Error(path + ": cannot be " + done + " (" + std::strerror(reason) + ")" + advice);
}

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)), part_(path_ + ".part") {
  struct stat status;
  if (::stat(path_.c_str(), &status) == 0 && S_ISDIR(status.st_mode)) fail(EISDIR);
  file_ = ::open(part_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file_ < 0) fail(errno);
}

AtomicFile::~AtomicFile() {
  if (file_ < 0) return;
  ::close(file_);
  ::unlink(part_.c_str());
}

void AtomicFile::fail(int reason) const { throw file_error(path_, "written", reason); }

void AtomicFile::write(std::span<std::byte const> bytes) {
  while (!bytes.empty()) {
    ssize_t const written = ::write(file_, bytes.data(), std::min<std::size_t>(bytes.size(), 1u << 30));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(errno);
    if (written == 0) fail(ENOSPC);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void AtomicFile::commit() {
  // Some file systems find out that they are full only when the bytes go out. EINVAL: a file system that cannot sync.
  if (::fsync(file_) != 0 && errno != EINVAL) fail(errno);
  if (::rename(part_.c_str(), path_.c_str()) != 0) fail(errno);
  ::close(file_);
  file_ = -1;
}

void write_whole(std::string const& path, std::span<std::byte const> bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

void write_whole(std::string const& path, std::string_view text) {
  write_whole(path, std::as_bytes(std::span(text.data(), text.size())));
}

std::string read_whole(std::string const& path) {
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (!file) throw file_error(path, "read", errno);
  std::string text;
  char buffer[1 << 16];
  while (std::size_t const n = std::fread(buffer, 1, sizeof buffer, file)) text.append(buffer, n);
  int const reason = std::ferror(file) ? errno : 0;
  std::fclose(file);
  if (reason) throw file_error(path, "read", reason);
  return text;
}

}  // namespace fissure::output
