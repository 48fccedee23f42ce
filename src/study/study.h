#pragma once

/// A study: runs every planned row, writes the table after each of them, tells orders of convergence.

#include "output/results_folder.h"
#include "output/study_file.h"
#include "study/plan.h"

#include <filesystem>
#include <functional>

namespace kerf::study {

/// Runs all rows. FOLDER/study.h5 holds the rows so far at any time, FOLDER/rows/NAME/run.h5 the series of each;
/// `done` is told each row. A row that fails does not end the study. To resume, rows that study.h5 holds are taken as they
/// are, and the next one goes on where it was kept. Throws as output::ResultsFolder, make_plan() and measure(), and
/// NumericalError, with the table written, when all rows have failed.
output::StudyTable run_study(const Plan& plan, const std::filesystem::path& folder, const output::RunInfo& info,
                             output::Earlier earlier, const std::function<void(const output::StudyRow&)>& done);

/// Fills the orders: log |e_1 / e_2| / log(h_1 / h_2) in each row of a family but its first, for the rows of the family
/// that have errors, in the order in which they stand; unknown (NaN) where h is the same.
void tell_orders(std::vector<output::StudyRow>& rows);

/// The rows as aligned text for people, with a line of units; '-' for what is not known.
std::string aligned(const output::StudyTable& table);

} // namespace kerf::study
