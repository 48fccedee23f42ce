#pragma once

/// Benchmarks beside each other and for people.

#include "output/bench_file.h"

#include <string>
#include <vector>

namespace kerf::bench {

/// One row as a line: what, how many, how long, how fast, of what the machine can.
std::string line_of(const output::BenchRow& row);
/// The head of such lines.
std::string heading();

struct Comparison {
  std::size_t n_compared = 0;       ///< rows of one path and size in both
  std::vector<std::string> fallen;  ///< a line for each that is slower by more than the part that is allowed
  std::vector<std::string> missing; ///< a line for each that only the earlier one has
};
/// `allowed`: part of the rate that may be lost [1]; where the samples of a row spread wider, as much as they do.
Comparison compare(const output::BenchTable& now, const output::BenchTable& before, double allowed);

} // namespace kerf::bench
