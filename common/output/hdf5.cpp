#include "output/hdf5.h"

#include <functional>
#include <numeric>

#include "base/error.h"

namespace fissure::output::h5 {

namespace {

/// HDF5 prints its own stack of errors unless told not to; ours are complete without it.
void be_quiet() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

/// Writing to memory fails only when there is none left.
hid_t made(hid_t id) {
  if (id < 0) throw Error("results: HDF5 could not build a frame in memory (not enough memory?)");
  return id;
}

Id dataspace(Shape const& shape) {
  return Id(made(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr)), H5Sclose);
}

Id link_properties() {
  be_quiet();
  Id links(made(H5Pcreate(H5P_LINK_CREATE)), H5Pclose);
  H5Pset_create_intermediate_group(links, 1);
  return links;
}

/// Without the time of day, so that equal runs give equal bytes.
Id dataset_properties() {
  Id properties(made(H5Pcreate(H5P_DATASET_CREATE)), H5Pclose);
  made(H5Pset_obj_track_times(properties, false));
  return properties;
}

Id file_in_memory(std::size_t bytes) {
  Id const access(made(H5Pcreate(H5P_FILE_ACCESS)), H5Pclose);
  made(H5Pset_fapl_core(access, bytes, false));
  return Id(made(H5Fcreate("results in memory", H5F_ACC_TRUNC, H5P_DEFAULT, access)), H5Fclose);
}

}  // namespace

Image::Image(std::size_t bytes) : links_(link_properties()), file_(file_in_memory(bytes)) {}

void Image::group(std::string const& path) {
  Id const properties(made(H5Pcreate(H5P_GROUP_CREATE)), H5Pclose);
  made(H5Pset_link_creation_order(properties, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
  made(H5Pset_obj_track_times(properties, false));
  Id const group(made(H5Gcreate2(file_, path.c_str(), links_, properties, H5P_DEFAULT)), H5Gclose);
}

void Image::attribute(std::string const& path, std::string const& name, hid_t type, hid_t space, void const* value) {
  Id const made_type(type, H5Tclose), made_space(space, H5Sclose);
  Id const object(made(H5Oopen(file_, path.c_str(), H5P_DEFAULT)), H5Oclose);
  Id const attribute(made(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT)), H5Aclose);
  made(H5Awrite(attribute, type, value));
}

void Image::attribute(std::string const& path, std::string const& name, double value) {
  attribute(path, name, made(H5Tcopy(H5T_NATIVE_DOUBLE)), made(H5Screate(H5S_SCALAR)), &value);
}

void Image::attribute(std::string const& path, std::string const& name, std::int64_t value) {
  attribute(path, name, made(H5Tcopy(H5T_NATIVE_INT64)), made(H5Screate(H5S_SCALAR)), &value);
}

void Image::attribute(std::string const& path, std::string const& name, std::vector<std::int64_t> const& values) {
  hsize_t const size = values.size();
  attribute(path, name, made(H5Tcopy(H5T_NATIVE_INT64)), made(H5Screate_simple(1, &size, nullptr)), values.data());
}

void Image::attribute(std::string const& path, std::string const& name, std::string const& text) {
  hid_t const type = made(H5Tcopy(H5T_C_S1));  // fixed length: VTK takes no other
  H5Tset_size(type, text.empty() ? 1 : text.size());
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  attribute(path, name, type, made(H5Screate(H5S_SCALAR)), text.c_str());
}

void Image::write(std::string const& path, Shape const& shape, void const* values, hid_t in_memory, hid_t stored) {
  Id const space = dataspace(shape);
  Id const set(made(H5Dcreate2(file_, path.c_str(), stored, space, links_, dataset_properties(), H5P_DEFAULT)),
               H5Dclose);
  if (H5Sget_simple_extent_npoints(space) > 0) made(H5Dwrite(set, in_memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
}

void Image::dataset(std::string const& path, Shape const& shape, double const* values, hid_t stored) {
  write(path, shape, values, H5T_NATIVE_DOUBLE, stored);
}

void Image::dataset(std::string const& path, Shape const& shape, std::int64_t const* values, hid_t stored) {
  write(path, shape, values, H5T_NATIVE_INT64, stored);
}

void Image::virtual_dataset(std::string const& path, Shape const& row, std::vector<Piece> const& pieces, hid_t stored) {
  Shape shape{0};
  shape.insert(shape.end(), row.begin(), row.end());
  for (auto const& piece : pieces) shape[0] += piece.rows;
  if (shape[0] == 0) return write(path, shape, nullptr, stored, stored);

  Id const whole = dataspace(shape), properties = dataset_properties();
  Shape first(shape.size(), 0), count = shape;
  for (auto const& piece : pieces) {
    if (piece.rows == 0) continue;
    count[0] = piece.rows;
    Id const part = dataspace(count);
    made(H5Sselect_hyperslab(whole, H5S_SELECT_SET, first.data(), nullptr, count.data(), nullptr));
    made(H5Pset_virtual(properties, whole, piece.file.c_str(), piece.dataset.c_str(), part));
    first[0] += piece.rows;
  }
  Id const set(made(H5Dcreate2(file_, path.c_str(), stored, dataspace(shape), links_, properties, H5P_DEFAULT)),
               H5Dclose);
}

std::vector<std::byte> Image::bytes() const {
  made(H5Fflush(file_, H5F_SCOPE_LOCAL));
  ssize_t const size = H5Fget_file_image(file_, nullptr, 0);
  made(static_cast<hid_t>(size));
  std::vector<std::byte> bytes(static_cast<std::size_t>(size));
  made(static_cast<hid_t>(H5Fget_file_image(file_, bytes.data(), bytes.size())));
  return bytes;
}

Reader::Reader(std::string path)
    : path_(std::move(path)),
      file_((be_quiet(), check(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "an HDF5 header")), H5Fclose) {}

hid_t Reader::check(hid_t id, std::string const& what) const {
  if (id < 0) throw Error(path_ + ": cannot be read (it lacks " + what + "; not written by this program, or damaged)");
  return id;
}

bool Reader::has(std::string const& object) const { return H5Lexists(file_, object.c_str(), H5P_DEFAULT) > 0; }

double Reader::number(std::string const& object, std::string const& attribute) const {
  Id const id(check(H5Aopen_by_name(file_, object.c_str(), attribute.c_str(), H5P_DEFAULT, H5P_DEFAULT), attribute),
              H5Aclose);
  double value = 0;
  check(H5Aread(id, H5T_NATIVE_DOUBLE, &value), attribute);
  return value;
}

std::string Reader::text(std::string const& object, std::string const& attribute) const {
  Id const id(check(H5Aopen_by_name(file_, object.c_str(), attribute.c_str(), H5P_DEFAULT, H5P_DEFAULT), attribute),
              H5Aclose);
  Id const type(check(H5Aget_type(id), attribute), H5Tclose);
  std::string value(H5Tget_size(type), '\0');
  check(H5Aread(id, type, value.data()), attribute);
  value.resize(std::min(value.size(), value.find('\0')));
  return value;
}

Shape Reader::shape(std::string const& dataset) const {
  Id const set(check(H5Dopen2(file_, dataset.c_str(), H5P_DEFAULT), dataset), H5Dclose);
  Id const space(check(H5Dget_space(set), dataset), H5Sclose);
  Shape shape(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
  H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  return shape;
}

std::vector<std::string> Reader::members(std::string const& group) const {
  std::vector<std::string> names;
  auto const collect = [](hid_t, char const* name, H5L_info_t const*, void* into) -> herr_t {
    static_cast<std::vector<std::string>*>(into)->emplace_back(name);
    return 0;
  };
  check(
      H5Literate_by_name(file_, group.c_str(), H5_INDEX_CRT_ORDER, H5_ITER_INC, nullptr, collect, &names, H5P_DEFAULT),
      group);
  return names;
}

std::vector<std::int64_t> Reader::integers(std::string const& dataset) const {
  Shape const size = shape(dataset);
  std::vector<std::int64_t> values(std::accumulate(size.begin(), size.end(), hsize_t{1}, std::multiplies<>()));
  Id const set(check(H5Dopen2(file_, dataset.c_str(), H5P_DEFAULT), dataset), H5Dclose);
  if (!values.empty()) check(H5Dread(set, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), dataset);
  return values;
}

}  // namespace fissure::output::h5
