#pragma once

#include "output/records.h"

namespace kerf::scene {

/// Where this program comes from, and what it was built with: everything of a run's record that does not depend on
/// the run.
output::RunInfo build_info();

} // namespace kerf::scene
