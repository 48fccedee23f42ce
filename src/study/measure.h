#pragma once

/// One row of a study: composes its scene, runs it, and measures.

#include "output/results_folder.h"
#include "output/study_file.h"
#include "study/plan.h"

#include <filesystem>

namespace kerf::study {

/// Composes and runs a row in this process, as often as the study repeats it; run.h5, with the series but hardly a
/// frame, goes into `folder`, that of the second and later runs into `folder`/2 and so on. Whatever fails in composing
/// and running becomes the row's outcome, and so does what differs between repetitions. Throws ParameterError when the
/// study asks for a body or a series that the scene does not have, or in another unit; DataError when the folder cannot
/// be written; Interrupted.
output::StudyRow measure(const Plan& plan, const PlannedRow& row, const std::filesystem::path& folder,
                         const output::RunInfo& info, output::Earlier earlier);

/// A row that has no numbers, only a reason.
output::StudyRow failed_row(const PlannedRow& planned, const std::string& why);

/// One row of runs of the same: medians and spreads of their times, the most memory. Its outcome says what else
/// differs.
output::StudyRow together(const std::vector<output::StudyRow>& runs);

/// Fills the errors of value, norms and displacements; unknown (NaN) where one of both is.
void tell_errors(output::StudyRow& row);

/// Throws ParameterError, at the study's line, for a change of which no row reads a key. Composes a row of each case,
/// more where the first does not read it.
void require_changes_read(const Plan& plan);

/// The number that stands for a series over time: the last one; the largest, the smallest; the mean over the last part
/// of it [1], of one entry at least; the frequency [1/s] of its passages upwards through its mean, between entries `dt`
/// [s] apart. NaN for a series without entries, and without two passages.
double take(const std::vector<double>& series, const AnswerParameters& how, double dt);

} // namespace kerf::study
