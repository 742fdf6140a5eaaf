// The little of HDF5 that the writers need: files built in memory, so that a full disk never meets HDF5.
#pragma once
#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace fissure::output::h5 {

/// An HDF5 identifier that closes itself.
class Id {
 public:
  Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Id(Id&& other) noexcept : id_(other.id_), close_(other.close_) { other.id_ = -1; }
  Id& operator=(Id&&) = delete;
  ~Id() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

using Shape = std::vector<hsize_t>;

/// A stretch of a virtual dataset's first dimension and where its values lie.
struct Piece {
  std::string file, dataset;
  hsize_t rows = 0;
};

/// An HDF5 file in memory. Paths may name groups that do not exist yet.
class Image {
 public:
  /// `bytes`: about how large it becomes.
  explicit Image(std::size_t bytes = 1 << 16);

  void group(std::string const& path);
  void attribute(std::string const& path, std::string const& name, double value);
  void attribute(std::string const& path, std::string const& name, std::int64_t value);
  void attribute(std::string const& path, std::string const& name, std::vector<std::int64_t> const& values);
  void attribute(std::string const& path, std::string const& name, std::string const& text);

  /// Values row by row; stored as `stored` (single precision, bytes, ...).
  void dataset(std::string const& path, Shape const& shape, double const* values, hid_t stored);
  void dataset(std::string const& path, Shape const& shape, std::int64_t const* values, hid_t stored = H5T_STD_I64LE);
  /// A dataset made of rows that lie in other files, one piece after the other; each row has shape `row`.
  void virtual_dataset(std::string const& path, Shape const& row, std::vector<Piece> const& pieces, hid_t stored);

  /// The file as it must stand on the disk.
  std::vector<std::byte> bytes() const;

 private:
  void write(std::string const& path, Shape const& shape, void const* values, hid_t in_memory, hid_t stored);
  void attribute(std::string const& path, std::string const& name, hid_t type, hid_t space, void const* value);
  Id links_, file_;
};

/// Reads what frames hold about themselves; throws Error naming the file when it is no HDF5 file or lacks something.
class Reader {
 public:
  explicit Reader(std::string path);
  bool has(std::string const& object) const;
  double number(std::string const& object, std::string const& attribute) const;
  std::string text(std::string const& object, std::string const& attribute) const;
  Shape shape(std::string const& dataset) const;
  std::vector<std::string> members(std::string const& group) const;  // in the order of their making
  std::vector<std::int64_t> integers(std::string const& dataset) const;

 private:
  hid_t check(hid_t id, std::string const& what) const;
  std::string path_;
  Id file_;
};

}  // namespace fissure::output::h5
