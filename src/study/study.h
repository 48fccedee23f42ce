#pragma once

/// A study: runs every planned row, writes the table after each of them, tells orders of convergence.

#include "output/results_folder.h"
#include "output/study_file.h"
#include "study/plan.h"

#include <filesystem>
#include <functional>
#include <optional>

namespace kerf::study {

/// The table of a study while its rows come in, in whatever order. FOLDER/study.h5 holds those so far at any time,
/// study.csv the same as text; FOLDER/rows/NAME/run.h5 the series of each, and row.h5 beside it a row that was run
/// alone.
class StudyRows {
 public:
  /// Takes the folder. To resume, rows that study.h5 or a row.h5 holds are taken as they are. Throws as
  /// output::ResultsFolder, and ParameterError where they are of another study.
  StudyRows(const Plan& plan, const std::filesystem::path& folder, const output::RunInfo& info,
            output::Earlier earlier);

  bool has(std::size_t k) const { return rows_[k].has_value(); }
  const output::StudyRow& row(std::size_t k) const { return *rows_[k]; }
  void put(std::size_t k, output::StudyRow row);
  /// Whether a process of its own has left a row.h5.
  bool is_written(std::size_t k) const;
  /// What it holds.
  output::StudyRow read_row(std::size_t k) const;
  void interrupt() { write(table(output::Outcome::interrupted)); }
  /// The whole table, written as completed. Throws NumericalError when all rows have failed.
  output::StudyTable finish();

 private:
  output::StudyTable table(output::Outcome outcome) const;
  void write(const output::StudyTable& table) const;

  const Plan& plan_;
  const std::filesystem::path folder_;
  const output::RunInfo& info_;
  const output::ResultsFolder claimed_;
  const std::string made_of_;
  std::vector<std::optional<output::StudyRow>> rows_; ///< as planned
};

/// Where the k-th row goes, below the study's folder.
std::filesystem::path row_folder(const Plan& plan, std::size_t k);

/// Runs all rows that are not there yet, one after the other; `done` is told each row. A row that fails does not end
/// the study; one that was under way goes on where it was kept. Throws as StudyRows, measure() and make_plan().
output::StudyTable run_study(const Plan& plan, const std::filesystem::path& folder, const output::RunInfo& info,
                             output::Earlier earlier, const std::function<void(const output::StudyRow&)>& done);

/// Runs the k-th row alone, and writes it as a study of one row into row.h5 in its folder; to resume, one that is there
/// is taken as it is. Several may run at a time, of one study into one folder.
output::StudyRow run_row(const Plan& plan, std::size_t k, const std::filesystem::path& folder,
                         const output::RunInfo& info, output::Earlier earlier);

/// Fills what is not known of the references of rows from the row that the study names, or 'finest': of each family the
/// completed one with the smallest h, or the smallest time step where h is the same. Then tells errors anew. An empty name: nothing.
void tell_references(const std::string& name, std::vector<output::StudyRow>& rows);

/// Fills the orders: log |e_1 / e_2| / log(h_1 / h_2) in each row of a family but its first, for the rows of the family
/// that have errors, in the order in which they stand; where h is the same, by time steps dt; unknown (NaN) where these
/// are the same too.
void tell_orders(std::vector<output::StudyRow>& rows);

/// The rows as aligned text for people, with a line of units; '-' for what is not known.
std::string aligned(const output::StudyTable& table);

} // namespace kerf::study
