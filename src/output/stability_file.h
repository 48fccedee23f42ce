#pragma once

/// The table of a study of stability, in HDF5 (table_columns.h): /stability/rows/..., one entry a run;
/// /stability/text is the study, with what --set changed and absolute file names.

#include "output/records.h"

#include <filesystem>

namespace kerf::output {

struct StabilityRow {
  std::string sweep, variant, cases, changes; ///< names; what was changed of the scene
  std::string backend, integrator;
  double dt = 0;             ///< [s]
  std::string outcome;       ///< "stable", "damped out", "drifted", "not back", "refused", "stopped", "failed"
  std::string reason;        ///< of one that was refused or stopped, or in what it failed
  double start_energy = 0;   ///< kinetic and elastic, after what cuts at time 0 [J]
  double largest_energy = 0; ///< over the start's [1]
  double last_energy = 0;    ///< over the start's [1]
  double momentum = 0;       ///< change over that of all mass at the speed of the start's energy [1]
  double volume = 0;         ///< at the end, over that at rest [1]
  std::int64_t n_steps = 0, n_iterations = 0, n_divided = 0;
  double cpu_seconds = 0;
  double predicted_step = 0, largest_step = 0; ///< [s]; NaN where not asked
};

struct StabilityTable {
  std::string title, text;
  Outcome outcome = Outcome::running;
  std::vector<StabilityRow> rows;
  std::string made_of = {}; ///< a hash of all that the rows depend on (study/resumed.h)
};

/// Writes the file, or replaces it. Throws DataError when it cannot be written.
void write_stability_file(const std::filesystem::path& path, const StabilityTable& table, const RunInfo& info);

/// Reads the table back. Throws DataError.
StabilityTable read_stability_file(const std::filesystem::path& path);

} // namespace kerf::output
