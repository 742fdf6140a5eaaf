// A simulation's state as named bytes, so that a run that goes on from them ends in the same bits.
#pragma once
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

#include "base/algebra.h"
#include "base/error.h"

namespace fissure {

using State = std::map<std::string, std::vector<std::uint8_t>>;

template <class T>
std::vector<std::uint8_t> state_bytes(std::vector<T> const& values) {
  static_assert(std::is_trivially_copyable_v<T> || std::is_same_v<T, Eigen::Vector3d>);
  std::vector<std::uint8_t> raw(values.size() * sizeof(T));
  if (!raw.empty()) std::memcpy(raw.data(), static_cast<void const*>(values.data()), raw.size());
  return raw;
}

/// The values kept as `name`. Throws Error when there are none, or not `size` of them (where given).
template <class T>
std::vector<T> state_values(State const& state, std::string const& name, std::size_t size = std::size_t(-1)) {
  auto const found = state.find(name);
  if (found == state.end()) throw Error("the checkpoint has no \"" + name + "\" (it is of another scene or version)");
  std::size_t const bytes = found->second.size();
  if (bytes % sizeof(T) != 0 || (size != std::size_t(-1) && bytes != size * sizeof(T)))
    throw Error(
        "the checkpoint's \"" + name + "\" has " + std::to_string(bytes) + " bytes, this scene needs " +
        (size == std::size_t(-1) ? "a multiple of " + std::to_string(sizeof(T)) : std::to_string(size * sizeof(T))) +
        " (it is of another scene, mesh or precision)");
  std::vector<T> values(bytes / sizeof(T));
  if (bytes > 0) std::memcpy(static_cast<void*>(values.data()), found->second.data(), bytes);
  return values;
}

/// Throws Error unless an index that was read as part of `name` lies in [least, count): kernels follow it.
inline void check_index(std::string const& name, long index, std::size_t count, long least = 0) {
  if (index < least || index >= static_cast<long>(count))
    throw Error("the checkpoint's \"" + name + "\" names number " + std::to_string(index) + " of " +
                std::to_string(count) + " (it is damaged, or of another scene or mesh)");
}

}  // namespace fissure
