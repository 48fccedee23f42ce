#pragma once

/// The table of a study, in HDF5: one column a dataset, all of the same length, one entry a run.
///
///     /                attributes as of a run's file, and title, outcome (running, completed, interrupted, failed),
///     made_of
///     /study/text      the study, with what --set changed and absolute file names
///     /study/rows/...  the columns; attributes unit and description
///     /study/norms/... what else is asked of each row: name, unit, answer; its columns are value_NAME, reference_NAME,
///     error_NAME
///     /study/points    points of the material at rest, n x 3 [m], where there are any
///     /study/displacements, /study/reference_displacements   there, n_rows x 3 n [m]
/// Numbers that are not known (the value of a run that failed, an error without a reference) are NaN. The columns stand
/// in a file of comma-separated values too, where what is not known is empty.

#include "base/vec.h"
#include "output/records.h"

#include <filesystem>

namespace kerf::output {

/// What else is asked of each row.
struct StudyNorm {
  std::string name, unit;
  std::string answer; ///< what the value is, in words
};

struct NormValue {
  double value = 0, reference = 0; ///< in the norm's unit
  double error = 0;                ///< [1]
};

struct StudyRow {
  std::string name, family, backend, integrator;
  double h = 0, dt = 0; ///< [m], [s]
  std::int64_t n_dof = 0, n_steps = 0, n_iterations = 0;
  double value = 0, reference = 0; ///< in the study's unit
  double error = 0, order = 0;     ///< [1]
  std::int64_t n_repetitions = 1;
  double setup_seconds = 0, stepping_seconds = 0;                  ///< wall-clock, medians
  double setup_cpu_seconds = 0, cpu_seconds = 0;                   ///< of set-up and of all steps, medians
  double setup_spread = 0, stepping_spread = 0, cpu_spread = 0;    ///< largest less smallest
  double peak_memory = 0;                                          ///< beyond what the process had before [byte]
  std::string reference_source, changes, outcome;
  std::vector<NormValue> norms = {};                                    ///< in the table's order
  std::vector<double> displacements = {}, reference_displacements = {}; ///< x, y, z of each point [m]; empty: not known
  double error_l2 = 0, error_max = 0;                                   ///< of the displacements of all points [1]
};

struct StudyTable {
  std::string title, text, unit;
  std::string answer; ///< what the value is, in words
  Outcome outcome = Outcome::running;
  std::vector<StudyRow> rows;
  std::string made_of = {}; ///< a hash of all that the rows depend on (study/resumed.h)
  std::vector<StudyNorm> norms = {};
  Points points = {}; ///< [m]
};

/// Writes the file, or replaces it: beside the old one, which it then takes the place of. Throws DataError when it
/// cannot be written.
void write_study_file(const std::filesystem::path& path, const StudyTable& table, const RunInfo& info);

/// The columns as text, a line a row below a line of names with units; numbers to the last digit. Written as above.
void write_study_csv(const std::filesystem::path& path, const StudyTable& table);

/// Reads the table back. Throws DataError.
StudyTable read_study_file(const std::filesystem::path& path);

} // namespace kerf::output
