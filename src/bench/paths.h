#pragma once

/// The hot paths of the program, each on cubes of any number of cells: what a step, a cut and a frame are made of.
/// Bodies are composed as a scene would have them, so what is measured is what runs.

#include "bench/machine.h"
#include "output/bench_file.h"

#include <functional>
#include <string>
#include <vector>

namespace kerf::bench {

struct Options {
  std::string only = {}; ///< of the paths, those whose name has this; empty: all
  double largest = 1e5;  ///< cells of a body
  int n_samples = 7;     ///< of each path and size
  double least = 0.02;   ///< seconds that a sample takes at least
};

/// Names of all, for people.
std::vector<std::string> names_of_paths();

/// Measures six sizes and more, from about 200 cells to the largest; `say` is told each row as it comes.
std::vector<output::BenchRow> measure_paths(const Options& options, const Machine& machine,
                                            const std::function<void(const output::BenchRow&)>& say);

} // namespace kerf::bench
