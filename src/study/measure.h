#pragma once

/// One row of a study: composes its scene, runs it, and measures.

#include "output/results_folder.h"
#include "output/study_file.h"
#include "study/plan.h"

#include <filesystem>

namespace kerf::study {

/// Composes and runs a row in this process; run.h5, with the series but hardly a frame, goes into `folder`. Whatever
/// fails in composing and running becomes the row's outcome. Throws ParameterError when the study asks for a body or a
/// series that the scene does not have, or in another unit; DataError when the folder cannot be written; Interrupted.
output::StudyRow measure(const Plan& plan, const PlannedRow& row, const std::filesystem::path& folder,
                         const output::RunInfo& info, output::Earlier earlier);

/// A row that has no numbers, only a reason.
output::StudyRow failed_row(const PlannedRow& planned, const std::string& why);

/// The number that stands for a series over time: the last one; the largest, the smallest; the mean over the last part
/// of it [1], of one entry at least. NaN for a series without entries.
double take(const std::vector<double>& series, const std::string& how, double last_part);

} // namespace kerf::study
