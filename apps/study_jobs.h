#pragma once

#include "scene_arguments.h"
#include "study/study.h"

namespace kerf::apps {

/// Runs the rows of a study as processes of their own, `n_jobs` at a time; one at a time where their times count, or by
/// default. A row whose process is killed has failed, and leaves the others; one that ends because the study is no
/// good, or a file, ends the study. A signal is passed on to all that run. Throws as study::run_study().
output::StudyTable run_study_jobs(const study::Plan& plan, const SceneArguments& arguments, const output::RunInfo& info,
                                  const std::function<void(const output::StudyRow&)>& done);

} // namespace kerf::apps
