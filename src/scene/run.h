#pragma once

/// The main flow: cut, step, follow, record.

#include "scene/progress.h"
#include "scene/recorder.h"
#include "scene/world.h"

namespace kerf::scene {

/// Runs the world from time 0 to its end. On an error the recorder's files say what failed and when, and the error
/// goes on to the caller. Returns seconds per stage over the whole run [s], composing excluded.
Timings run(World& world, Recorder& recorder, Progress& progress);

} // namespace kerf::scene
