#pragma once

#include "scene_arguments.h"

namespace kerf::apps {

/// Runs each of several scenes as a process of its own, `n_jobs` at a time, into a folder of its own: one that fails,
/// or is killed, leaves the others. Says how each ended, names those that failed again at the end, and returns the
/// worst exit code: 0 where all have completed. A signal is passed on to all that run, and no more is begun.
int run_batch(const SceneArguments& arguments);

} // namespace kerf::apps
