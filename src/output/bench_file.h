#pragma once

/// The table of a benchmark, in HDF5 (table_columns.h): /bench/rows/..., one entry for each hot path and size;
/// attributes threads, peak_flops [1/s] and bandwidth [B/s] as measured beside it. And the same as CSV.

#include "output/records.h"

#include <filesystem>

namespace kerf::output {

struct BenchRow {
  std::string path;       ///< "stiffness product, elements"
  std::string item;       ///< what is counted: "elements"
  std::int64_t cells = 0; ///< of the body
  std::int64_t n = 0;     ///< items that a call works on
  double seconds = 0;     ///< of a call on the clock, median
  double spread = 0;      ///< between the quartiles of the repetitions, over the median [1]
  double rate = 0;        ///< items a second
  double of_peak = 0; ///< operations that a call needs, over what the machine does in its time [1]; NaN: not counted
  double of_bandwidth = 0; ///< bytes that it must move at least, likewise [1]; NaN: not counted
};

struct BenchTable {
  std::int64_t n_threads = 1;
  double peak_flops = 0; ///< additions and multiplications a second, double precision, measured
  double bandwidth = 0;  ///< bytes a second from and to memory, measured
  std::vector<BenchRow> rows = {};
};

/// Writes the file, or replaces it. Throws DataError when it cannot be written.
void write_bench_file(const std::filesystem::path& path, const BenchTable& table, const RunInfo& info);
void write_bench_csv(const std::filesystem::path& path, const BenchTable& table);

/// Reads the table of the HDF5 file back. Throws DataError.
BenchTable read_bench_file(const std::filesystem::path& path);

} // namespace kerf::output
