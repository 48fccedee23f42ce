#pragma once

/// A few arrays as a file of their own, in HDF5: each a dataset at its path with the attributes unit and description,
/// the file with those of a run's file and a title and source.

#include "output/records.h"

#include <filesystem>

namespace kerf::output {

struct NamedArray {
  std::string name; ///< path below the root: "field/one front/visibility"
  std::string unit;
  std::string description;
  std::vector<std::size_t> extent; ///< the last index is the fastest
  std::vector<double> values;
};

/// Writes the file, or replaces it. Throws DataError when it cannot be written, or values do not fit their extent.
void write_array_file(const std::filesystem::path& path, const std::string& title, const std::string& source,
                      std::span<const NamedArray> arrays, const RunInfo& info);

} // namespace kerf::output
