#include "scene/run.h"

#include "base/error.h"
#include "base/parameters.h"

namespace kerf::scene {

namespace {

void require_finite(const Body& body) {
  double sum = 0;
  for (const Vec3& x : body.state.x)
    sum += x.sum();
  if (!(sum - sum == 0))
    throw NumericalError("corner positions are no longer finite. Use a smaller time step");
}

/// Runs `action` on a body; an error says which body, step and time.
template <class Action>
void on(const Body& body, const int step, const double time, const Action& action) {
  try {
    action();
  } catch (const NumericalError& error) {
    throw NumericalError("body " + body.name + ", step " + std::to_string(step) + ", time " + to_text(time) +
                         " s: " + error.what());
  }
}

void cut(World& world, const int step, Timings& seconds) {
  const double dt = world.time_step, t0 = (step - 1) * dt, t1 = step * dt;
  for (Body& body : world.bodies) {
    if (!body.cutting)
      continue;
    on(body, step, t1, [&] {
      for (const TimedSurface& timed : world.cut_surfaces)
        if (timed.step == step)
          cut_at_once(body, timed.surface, seconds);
      recut(body, world.blades, t0, t1, seconds);
    });
  }
}

void advance(World& world, const int step, Timings& seconds) {
  const double dt = world.time_step, t1 = step * dt;
  cut(world, step, seconds);
  for (Body& body : world.bodies) {
    const ScopedTimer timer(seconds, "solve");
    on(body, step, t1, [&] {
      body.report = body.physics.stepper->step(body.state, body.loads, dt);
      require_finite(body);
    });
  }
  for (Body& body : world.bodies) {
    const ScopedTimer timer(seconds, "surface");
    follow(body);
  }
}

} // namespace

Timings run(World& world, Recorder& recorder, Progress& progress) {
  Timings seconds = world.setup_seconds, total;
  int step = 0;
  try {
    recorder.record(world, 0, seconds);
    for (step = 1; step <= world.n_steps; ++step) {
      advance(world, step, seconds);
      for (const auto& [stage, s] : seconds)
        total[stage] += s;
      recorder.record(world, step, seconds);
      progress.show(step, step * world.time_step);
    }
    for (const auto& [stage, s] : seconds)
      total[stage] += s;
  } catch (const std::exception& error) {
    progress.finish();
    recorder.fail(error.what(), step, step * world.time_step);
    throw;
  }
  progress.finish();
  recorder.complete();
  return total;
}

} // namespace kerf::scene
