// The complete state of a run in one file, byte for byte, so that a run that goes on from it ends in the same bits.
#pragma once
#include <cstddef>
#include <cstring>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

#include "base/error.h"

namespace fissure::output {

struct Checkpoint {
  std::string program, version;       // what wrote it
  std::string scene_hash, precision;  // what it fits; the app compares them before it goes on
  int dimension = 0;
  long step = 0;
  double time = 0;  // [s]
  std::map<std::string, std::vector<std::byte>> blobs;

  template <class T>
  void put(std::string const& name, std::vector<T> const& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    auto& blob = blobs[name];
    blob.resize(values.size() * sizeof(T));
    if (!blob.empty()) std::memcpy(blob.data(), values.data(), blob.size());
  }

  /// Throws Error when there is no such blob or it holds no whole number of T.
  template <class T>
  std::vector<T> get(std::string const& name) const {
    static_assert(std::is_trivially_copyable_v<T>);
    auto const& blob = find(name, sizeof(T));
    std::vector<T> values(blob.size() / sizeof(T));
    if (!blob.empty()) std::memcpy(values.data(), blob.data(), blob.size());
    return values;
  }

 private:
  std::vector<std::byte> const& find(std::string const& name, std::size_t size) const;
};

/// The file of a run folder that `restart` goes on from.
inline std::string checkpoint_path(std::string const& folder) { return folder + "/checkpoint.bin"; }

/// The previous checkpoint of that name stays until the new one is on the disk. Throws Error with path and reason.
void save(std::string const& path, Checkpoint const& checkpoint);

/// Throws Error when the file is missing, foreign, of another version, cut off or damaged.
Checkpoint load(std::string const& path);

}  // namespace fissure::output
