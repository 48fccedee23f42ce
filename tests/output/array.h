#pragma once

/// Datasets of whole numbers of any rank.

#include <gtest/gtest.h>
#include <hdf5.h>

#include <filesystem>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

namespace kerf::output {

/// As every program reads it: shape and numbers by the C API alone.
struct Array {
  std::vector<hsize_t> shape;
  std::vector<int> values;

  int operator()(const std::vector<std::size_t>& index) const {
    std::size_t flat = 0;
    for (std::size_t d = 0; d < shape.size(); ++d)
      flat = flat * shape[d] + index[d];
    return values.at(flat);
  }
};

inline Array read_array(const std::filesystem::path& path, const std::string& name) {
  Array array;
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t dataset = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
  const hid_t space = H5Dget_space(dataset);
  array.shape.resize(H5Sget_simple_extent_ndims(space));
  H5Sget_simple_extent_dims(space, array.shape.data(), nullptr);
  array.values.resize(std::accumulate(array.shape.begin(), array.shape.end(), hsize_t(1), std::multiplies<>()));
  EXPECT_GE(H5Dread(dataset, H5T_NATIVE_INT, H5S_ALL, H5S_ALL, H5P_DEFAULT, array.values.data()), 0) << name;
  H5Sclose(space);
  H5Dclose(dataset);
  H5Fclose(file);
  return array;
}

/// The extent in each dimension.
using Shape = std::vector<hsize_t>;

} // namespace kerf::output
