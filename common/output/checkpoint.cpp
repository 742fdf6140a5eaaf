#include "output/checkpoint.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <span>

#include "output/file.h"

namespace fissure::output {

namespace {

// Layout: magic, version, length of the whole file, the numbers and texts, the blobs, checksum. Integers and floats are
// those of the machine; all that Fissure runs on are little-endian.
static_assert(std::endian::native == std::endian::little);
constexpr std::string_view magic = "FISSURE CHECKPOINT\n";
constexpr std::uint64_t format_version = 23;  // one more whenever what a state holds changes
constexpr std::size_t frame_size = magic.size() + 3 * sizeof(std::uint64_t);  // magic, version, length and checksum

/// FNV-1a, 64 bits: every change of a single byte changes it.
std::uint64_t checksum(std::uint64_t hash, std::span<std::byte const> bytes) {
  for (std::byte const b : bytes) hash = (hash ^ static_cast<std::uint64_t>(b)) * 0x100000001b3u;
  return hash;
}
constexpr std::uint64_t checksum_of_nothing = 0xcbf29ce484222325u;

template <class T>
std::span<std::byte const> bytes_of(T const& value) {
  return std::as_bytes(std::span(&value, 1));
}

/// Counts first, writes after: the length stands at the beginning.
template <class Put>
void write_content(Checkpoint const& checkpoint, Put put) {
  auto const block = [&](std::span<std::byte const> bytes) {
    std::uint64_t const size = bytes.size();
    put(bytes_of(size));
    put(bytes);
  };
  for (auto const* text : {&checkpoint.program, &checkpoint.version, &checkpoint.scene_hash, &checkpoint.precision})
    block(std::as_bytes(std::span(*text)));
  std::int64_t const numbers[] = {checkpoint.dimension, checkpoint.step};
  put(std::as_bytes(std::span(numbers)));
  put(bytes_of(checkpoint.time));
  std::uint64_t const blobs = checkpoint.blobs.size();
  put(bytes_of(blobs));
  for (auto const& [name, bytes] : checkpoint.blobs) {
    block(std::as_bytes(std::span(name)));
    block(bytes);
  }
}

/// Takes values from the front of a text; what does not fit is a damaged file.
struct Content {
  std::string_view rest;
  std::string const& path;

  std::string_view take(std::uint64_t size) {
    if (size > rest.size())
      throw Error(path + ": is damaged (its parts do not fit its length); go on from another checkpoint");
    std::string_view const part = rest.substr(0, size);
    rest.remove_prefix(size);
    return part;
  }
  template <class T>
  T number() {
    T value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  std::string_view block() { return take(number<std::uint64_t>()); }
};

}  // namespace

std::vector<std::byte> const& Checkpoint::find(std::string const& name, std::size_t size) const {
  auto const found = blobs.find(name);
  if (found == blobs.end())
    throw Error("checkpoint: lacks \"" + name + "\" (written by another version of the program?)");
  if (found->second.size() % size != 0)
    throw Error(
        fmt::format("checkpoint: \"{}\" has {} bytes, no multiple of {} (written by another version of the program?)",
                    name, found->second.size(), size));
  return found->second;
}

void save(std::string const& path, Checkpoint const& checkpoint) {
  std::uint64_t length = frame_size, sum = checksum_of_nothing;
  write_content(checkpoint, [&](std::span<std::byte const> bytes) { length += bytes.size(); });
  AtomicFile file(path);
  auto const put = [&](std::span<std::byte const> bytes) {
    sum = checksum(sum, bytes);
    file.write(bytes);
  };
  put(std::as_bytes(std::span(magic)));
  put(bytes_of(format_version));
  put(bytes_of(length));
  write_content(checkpoint, put);
  file.write(bytes_of(sum));
  file.commit();
}

Checkpoint load(std::string const& path) {
  std::string const text = read_whole(path);
  if (!text.starts_with(magic)) throw Error(path + ": is no checkpoint (it does not begin as one)");
  Content content{std::string_view(text).substr(magic.size()), path};
  if (text.size() < frame_size)
    throw Error(fmt::format("{}: is cut off ({} bytes left); go on from another checkpoint", path, text.size()));
  if (auto const version = content.number<std::uint64_t>(); version != format_version)
    throw Error(
        fmt::format("{}: is a checkpoint of format {} (this program reads format {})", path, version, format_version));
  if (auto const length = content.number<std::uint64_t>(); length != text.size())
    throw Error(
        fmt::format("{}: is cut off ({} of {} bytes); go on from another checkpoint", path, text.size(), length));
  std::uint64_t sum = 0;
  std::memcpy(&sum, text.data() + text.size() - sizeof sum, sizeof sum);
  if (sum != checksum(checksum_of_nothing, std::as_bytes(std::span(text).first(text.size() - sizeof sum))))
    throw Error(path + ": is damaged (its checksum is wrong); go on from another checkpoint");

  content.rest.remove_suffix(sizeof sum);
  Checkpoint checkpoint;
  for (auto* into : {&checkpoint.program, &checkpoint.version, &checkpoint.scene_hash, &checkpoint.precision})
    *into = content.block();
  checkpoint.dimension = static_cast<int>(content.number<std::int64_t>());
  checkpoint.step = static_cast<long>(content.number<std::int64_t>());
  checkpoint.time = content.number<double>();
  for (auto left = content.number<std::uint64_t>(); left > 0; --left) {
    std::string const name(content.block());
    auto const bytes = std::as_bytes(std::span(content.block()));
    checkpoint.blobs[name].assign(bytes.begin(), bytes.end());
  }
  return checkpoint;
}

}  // namespace fissure::output
