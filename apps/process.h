#pragma once

/// This program again, as processes of their own.

#include <string>
#include <vector>

#include <sys/types.h>
#include <cstdio>

namespace kerf::apps {

struct Process {
  pid_t id = 0;
  std::FILE* said = nullptr; ///< what it writes, out of the way
};

/// Starts this program with the words, the first of which is its name. It gets the signal when we end, however we end.
/// Throws DataError where no process can be started.
Process start(const std::vector<std::string>& words, int signal_at_our_end);

/// Whether it has ended, and then how, as a shell would say it: -1 while it runs.
int exit_code_of(const Process& process);

/// The last line that it has written; closes what it wrote into.
std::string last_words(Process& process);

} // namespace kerf::apps
