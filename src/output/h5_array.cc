#include "output/h5_array.h"

#include "base/error.h"

#include <hdf5.h>

#include <algorithm>
#include <array>

namespace kerf::output::h5 {
namespace {

constexpr std::size_t chunk_bytes = 1 << 18;
constexpr unsigned gzip_level = 1; // higher levels cost time and gain little on floating-point numbers

hid_t native(const Number number) {
  switch (number) {
    case Number::float64:
      return H5T_NATIVE_DOUBLE;
    case Number::float32:
      return H5T_NATIVE_FLOAT;
    case Number::int64:
      return H5T_NATIVE_INT64;
    case Number::int32:
      return H5T_NATIVE_INT32;
    case Number::uint64:
      return H5T_NATIVE_UINT64;
    case Number::uint32:
      return H5T_NATIVE_UINT32;
    case Number::uint16:
      return H5T_NATIVE_UINT16;
    case Number::uint8:
      return H5T_NATIVE_UINT8;
  }
  return H5I_INVALID_HID;
}

/// Rank 1 for one column, else 2; the second entry of each array is then not looked at.
using Extent = std::array<hsize_t, 2>;
int rank(const Layout& layout) { return layout.n_columns == 1 ? 1 : 2; }

Handle space_of(const Layout& layout, const Extent& extent, const hsize_t max_rows) {
  const Extent max = {max_rows, extent[1]};
  return {H5Screate_simple(rank(layout), extent.data(), max.data()), H5Sclose};
}

Object create(const Object& parent, const std::string& name, const hid_t type, const Handle& space,
              const Handle& creation) {
  Object dataset{
    {H5Dcreate2(parent.id(), name.c_str(), type, space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT), H5Dclose},
    parent.file,
    parent.path_of(name)};
  if (dataset.id() < 0)
    fail(parent, name, "create");
  return dataset;
}

std::array<hsize_t, 2> extent_of(const Object& dataset) {
  const Handle space(H5Dget_space(dataset.id()), H5Sclose);
  Extent extent = {1, 1};
  const int n = H5Sget_simple_extent_ndims(space.id());
  if (n > 2 || n < 0 || H5Sget_simple_extent_dims(space.id(), extent.data(), nullptr) < 0)
    fail(dataset, "", "tell the shape of");
  return extent;
}

Object write_texts(const Object& parent, const std::string& name, const Handle& space, const std::size_t length,
                   const std::string& padded) {
  const auto type = text_type(length, padded);
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  auto dataset = create(parent, name, type.id(), space, creation);
  if (!padded.empty() && H5Dwrite(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()) < 0)
    fail(parent, name, "write");
  return dataset;
}

} // namespace

Object write_rows(const Object& parent, const std::string& name, const Layout& layout, const void* rows,
                  const std::size_t n_rows, const Storage storage) {
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const Extent extent = {n_rows, layout.n_columns};
  if (n_rows > 0 && storage == Storage::compressed) {
    const auto row_bytes = H5Tget_size(native(layout.number)) * layout.n_columns;
    const Extent chunk = {std::clamp<hsize_t>(chunk_bytes / row_bytes, 1, n_rows), layout.n_columns};
    if (H5Pset_chunk(creation.id(), rank(layout), chunk.data()) < 0 || H5Pset_shuffle(creation.id()) < 0 ||
        H5Pset_deflate(creation.id(), gzip_level) < 0)
      fail(parent, name, "compress");
  }
  auto dataset = create(parent, name, native(layout.number), space_of(layout, extent, n_rows), creation);
  if (n_rows > 0 && H5Dwrite(dataset.id(), native(layout.number), H5S_ALL, H5S_ALL, H5P_DEFAULT, rows) < 0)
    fail(parent, name, "write");
  return dataset;
}

Object write_array(const Object& parent, const std::string& name, const Shape& shape, const void* values) {
  const std::vector<hsize_t> extent(shape.extent.begin(), shape.extent.end());
  const int rank = static_cast<int>(extent.size());
  const Handle space(H5Screate_simple(rank, extent.data(), nullptr), H5Sclose);
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const bool is_empty = std::ranges::count(extent, 0u) > 0; // a chunk may not be
  if (!is_empty && (H5Pset_chunk(creation.id(), rank, extent.data()) < 0 || H5Pset_shuffle(creation.id()) < 0 ||
                    H5Pset_deflate(creation.id(), gzip_level) < 0))
    fail(parent, name, "compress");
  auto dataset = create(parent, name, native(shape.number), space, creation);
  if (!is_empty && H5Dwrite(dataset.id(), native(shape.number), H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
    fail(parent, name, "write");
  return dataset;
}

Object create_series(const Object& parent, const std::string& name, const Layout& layout,
                     const std::size_t chunk_rows) {
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const Extent chunk = {chunk_rows, layout.n_columns};
  if (H5Pset_chunk(creation.id(), rank(layout), chunk.data()) < 0)
    fail(parent, name, "create");
  return create(parent, name, native(layout.number), space_of(layout, {0, layout.n_columns}, H5S_UNLIMITED), creation);
}

void append_rows(const Object& series, const Layout& layout, const void* rows, const std::size_t n_rows) {
  if (n_rows == 0)
    return;
  const auto before = extent_of(series)[0];
  const Extent after = {before + n_rows, layout.n_columns}, start = {before, 0}, count = {n_rows, layout.n_columns};
  if (H5Dset_extent(series.id(), after.data()) < 0)
    fail(series, "", "extend");
  const Handle target(H5Dget_space(series.id()), H5Sclose);
  const auto memory = space_of(layout, count, n_rows);
  if (H5Sselect_hyperslab(target.id(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) < 0 ||
      H5Dwrite(series.id(), native(layout.number), memory.id(), target.id(), H5P_DEFAULT, rows) < 0)
    fail(series, "", "append to");
}

Object open_dataset(const Object& parent, const std::string& name) {
  Object dataset{{H5Dopen2(parent.id(), name.c_str(), H5P_DEFAULT), H5Dclose}, parent.file, parent.path_of(name)};
  if (dataset.id() < 0)
    fail(parent, name, "open");
  return dataset;
}

std::size_t n_rows(const Object& dataset) { return extent_of(dataset)[0]; }

std::size_t n_columns(const Object& dataset) { return extent_of(dataset)[1]; }

void read_rows(const Object& dataset, const Layout& layout, void* rows) {
  if (n_columns(dataset) != layout.n_columns)
    throw DataError({.file = dataset.file,
                     .path = dataset.path,
                     .rule = "has " + std::to_string(n_columns(dataset)) + " columns where " +
                             std::to_string(layout.n_columns) + " are wanted"});
  if (n_rows(dataset) > 0 && H5Dread(dataset.id(), native(layout.number), H5S_ALL, H5S_ALL, H5P_DEFAULT, rows) < 0)
    fail(dataset, "", "read");
}

Object write_text(const Object& parent, const std::string& name, const std::string& text) {
  return write_texts(parent, name, {H5Screate(H5S_SCALAR), H5Sclose}, text.size(),
                     text.empty() ? std::string(1, '\0') : text);
}

Object write_lines(const Object& parent, const std::string& name, const std::vector<std::string>& lines) {
  std::size_t length = 1;
  for (const auto& line : lines)
    length = std::max(length, line.size());
  std::string padded;
  for (const auto& line : lines)
    padded += line + std::string(length - line.size(), '\0');
  const hsize_t n = lines.size();
  return write_texts(parent, name, {H5Screate_simple(1, &n, nullptr), H5Sclose}, length, padded);
}

std::vector<std::string> read_lines(const Object& parent, const std::string& name) {
  const auto dataset = open_dataset(parent, name);
  const Handle type(H5Dget_type(dataset.id()), H5Tclose);
  if (H5Tget_class(type.id()) != H5T_STRING || H5Tis_variable_str(type.id()) > 0)
    fail(parent, name, "read text from");
  const auto length = H5Tget_size(type.id());
  std::string padded(n_rows(dataset) * length, '\0');
  if (!padded.empty() && H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()) < 0)
    fail(parent, name, "read");
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < padded.size(); at += length) {
    const auto line = padded.substr(at, length);
    lines.push_back(line.substr(0, line.find('\0')));
  }
  return lines;
}

std::string read_text(const Object& parent, const std::string& name) {
  const auto lines = read_lines(parent, name);
  return lines.empty() ? "" : lines.front();
}

} // namespace kerf::output::h5
