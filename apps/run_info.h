#pragma once

#include "commands.h"
#include "output/records.h"

namespace kerf::apps {

/// Where the results of `kerf COMMAND arguments` come from: program, host, time, threads.
output::RunInfo run_info(const std::string& command, const Arguments& arguments);

} // namespace kerf::apps
