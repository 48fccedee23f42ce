#pragma once

/// Runs a scene to see whether it stays sound, whatever its material, step, start and cuts. No files but the table.
///
/// Outcomes, in this order:
///   refused     the scene or a step is no good, and the message says which key (ParameterError)
///   stopped     the run ended with a reason (NumericalError)
///   failed      it went on to its end, and is wrong: its energy more than doubled, or its volume is off by more than
///               30 % though its energy is gone. A run with exit code 0 that lies
///   not back    its initial state was inside out or crushed, and it still is drifted     energy grew by more than 1 %
///   in the mean over the second half of the steps, or momentum changed by more
///               than 1 %: nothing here gives them
///   damped out  less than 1e-3 of the energy is left; of equilibria this is what is asked, and they are stable
///   stable      none of these

#include "output/results_folder.h"
#include "output/stability_file.h"
#include "study/stability_plan.h"

#include <filesystem>
#include <functional>

namespace kerf::study {

/// One row. Nothing that a run may throw gets out but Interrupted.
output::StabilityRow watch(const StabilityCase& one, int n_steps);

/// Runs all rows; FOLDER/stability.h5 holds those so far, but for the last second's; `done` is told each row. Those
/// that it holds are not run again where the study is resumed.
output::StabilityTable run_stability_study(const StabilityPlan& plan, const std::filesystem::path& folder,
                                           const output::RunInfo& info, output::Earlier earlier,
                                           const std::function<void(const output::StabilityRow&)>& done);

/// How many rows of each variant had which outcome, by sweep, and the rows that did not end well with their reasons.
std::string aligned(const output::StabilityTable& table);

} // namespace kerf::study
