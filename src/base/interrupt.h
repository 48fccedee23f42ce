#pragma once

/// SIGINT, SIGTERM and SIGHUP as a wish: whoever runs long looks, between two steps, whether somebody wants it to end.
/// A second signal of a kind ends the process at once, as if nobody had heeded the first.

#include "base/error.h"

namespace kerf {

/// From now on the three signals are wishes; one that was ignored when the program began (nohup) stays ignored.
void heed_signals();

/// The signal that asked last, 0 when none has.
int wish_to_end();

/// Nothing has failed: a signal asked for the end. The exit code is 128 + the signal's number, that which shells give
/// to a process that the signal itself ends: so whoever started it (a shell, make, Slurm, Snakemake) understands it.
class Interrupted : public Error {
 public:
  /// "interrupted by SIGTERM" and what more there is to say.
  Interrupted(int signal, const std::string& more);
};

} // namespace kerf
