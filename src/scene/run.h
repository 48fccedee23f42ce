#pragma once

/// The main flow: cut, step, follow, record.

#include "scene/progress.h"
#include "scene/recorder.h"
#include "scene/world.h"

namespace kerf::scene {

/// One step of the run, the first is 1: what is due then is cut, the physics steps, the surface follows. Adds the
/// seconds of its stages. An error names body, step and time.
void advance(World& world, int step, Timings& seconds);

/// Runs the world from time 0, or where the recorder can resume it, to its end. On an error the recorder's files say
/// what failed and when, and the error goes on to the caller; so does Interrupted, when a signal has asked for the end
/// between two steps. Returns seconds per stage over the whole run [s], composing excluded.
Timings run(World& world, Recorder& recorder, Progress& progress);

} // namespace kerf::scene
