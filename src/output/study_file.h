#pragma once

/// The table of a study, in HDF5: one column a dataset, all of the same length, one entry a run.
///
///     /                attributes as of a run's file, and title, outcome (running, completed, interrupted, failed), made_of
///     /study/text      the study, with what --set changed and absolute file names
///     /study/rows/...  the columns; attributes unit and description
/// Numbers that are not known (the value of a run that failed, an error without a reference) are NaN.

#include "output/records.h"

#include <filesystem>

namespace kerf::output {

struct StudyRow {
  std::string name, family, backend, integrator;
  double h = 0, dt = 0; ///< [m], [s]
  std::int64_t n_dof = 0, n_steps = 0, n_iterations = 0;
  double value = 0, reference = 0; ///< in the study's unit
  double error = 0, order = 0;     ///< [1]
  double setup_seconds = 0, stepping_seconds = 0, cpu_seconds = 0;
  double peak_memory = 0; ///< beyond what the process had before [byte]
  std::string reference_source, changes, outcome;
};

struct StudyTable {
  std::string title, text, unit;
  std::string answer; ///< what the value is, in words
  Outcome outcome = Outcome::running;
  std::vector<StudyRow> rows;
  std::string made_of = {}; ///< a hash of all that the rows depend on (study/resumed.h)
};

/// Writes the file, or replaces it: beside the old one, which it then takes the place of. Throws DataError when it cannot be written.
void write_study_file(const std::filesystem::path& path, const StudyTable& table, const RunInfo& info);

/// Reads the table back. Throws DataError.
StudyTable read_study_file(const std::filesystem::path& path);

} // namespace kerf::output
