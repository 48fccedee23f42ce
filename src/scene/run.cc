#include "scene/run.h"

#include "base/error.h"
#include "base/interrupt.h"
#include "base/loan.h"
#include "dynamics/sound_steps.h"
#include "scene/initial_state.h"
#include "scene/soundness.h"

#include <algorithm>
#include <iomanip>
#include <sstream>

namespace kerf::scene {

namespace {

/// Runs `action` on a body; an error says which body, step and time, and where the scene sets a time step that is
/// refused.
template <class Action>
void on(const World& world, const Body& body, const int step, const double time, const Action& action) {
  const auto place = [&] {
    std::ostringstream text;
    text << "body " << body.name << ", step " << step << ", time " << std::setprecision(9) << time << " s: ";
    return text.str(); // a sum of time steps has round-off in its last digits
  };
  try {
    action();
  } catch (const dynamics::StepError& error) {
    throw NumericalError(place() + error.what() + ". It shows most at " + particle_at(body, error.particle()) +
                         ". Use a smaller time step, smaller loads or, of an implicit integrator, more Newton iterations "
                         "('Newton iterations [1]', 'Line search')");
  } catch (const NumericalError& error) {
    throw NumericalError(place() + error.what());
  } catch (const ParameterError& error) {
    Complaint complaint = error.complaint();
    complaint.rule = place() + complaint.rule;
    if (complaint.path == world.time_step_place.key) {
      complaint.file = world.time_step_place.file;
      complaint.line = world.time_step_place.line;
      complaint.path = world.time_step_place.path;
    }
    throw ParameterError(complaint);
  }
}

/// With the surfaces whose time has come. What is in an initial state is cut at rest at time 0.
void cut_at_once(Body& body, const World& world, const int step, Timings& seconds) {
  const auto is_now = [&](const TimedSurface& timed) { return timed.step == step; };
  if (std::none_of(world.cut_surfaces.begin(), world.cut_surfaces.end(), is_now))
    return;
  const bool is_put = step == 1 && body.initial;
  if (is_put)
    put_at_rest(body);
  for (const TimedSurface& timed : world.cut_surfaces)
    if (is_now(timed))
      cut_at_once(body, timed.surface, seconds);
  if (is_put)
    put_in_initial_state(body, world.time_step);
}

/// What cuts do to the energy is booked as theirs.
template <class Cut>
void take(Body& body, const Cut& cut) {
  const int n_recuts = body.n_recuts;
  const double before = body.accounts ? total_energy(*body.physics, body.loads, body.state) : 0;
  cut();
  if (body.accounts && body.n_recuts != n_recuts)
    body.accounts->add_work_of_cut(total_energy(*body.physics, body.loads, body.state) - before);
}

/// A body that moves is cut after its step, so that it and the blades go their ways in the same time; in statics
/// before, so that it is in balance with what it is cut to.
void advance(Body& body, World& world, const int step, Watch& watch, Timings& seconds) {
  const double dt = world.time_step, t0 = (step - 1) * dt, t1 = step * dt;
  const bool is_cut_before = body.physics->motion() == dynamics::MotionKind::quasi_static;
  if (body.cutter)
    take(body, [&] {
      cut_at_once(body, world, step, seconds);
      if (is_cut_before)
        recut(body, world.blades, t0, t1, seconds);
    });
  {
    const ScopedTimer timer(seconds, "visibility");
    if (body.physics->catch_up(seen(body)))
      make_loads(body);
  }
  {
    const ScopedTimer timer(seconds, "solve");
    hold(body, world.forceps, step, t0);
    if (body.accounts)
      body.accounts->before_step(body.state);
    Loan<Vec3> before = Loan<Vec3>::with_room(body.state.x.size());
    copy(body.state.x, *before);
    body.report = body.physics->step(body.state, body.loads, dt);
    watch.way += require_sound_motion(body, before, dt);
    body.n_divided += body.report.n_rejected > 0 ? 1 : 0;
    if (body.accounts)
      body.accounts->after_step(*body.physics, body.loads, body.report.begins_anew, body.state);
    follow(body);
  }
  if (body.cutter && !is_cut_before)
    take(body, [&] { recut(body, world.blades, t0, t1, seconds); });
}

/// Between two steps: after a signal, what has been computed is kept for --resume.
void end_if_asked(World& world, Recorder& recorder, const int step) {
  const int signal = wish_to_end();
  if (signal == 0)
    return;
  recorder.keep_now(world, step);
  throw Interrupted(signal, " after step " + std::to_string(step) + " of " + std::to_string(world.n_steps) +
                              "; --resume goes on from there. Results so far are in " + recorder.folder().string());
}

} // namespace

void advance(World& world, const int step, Timings& seconds) {
  const double t1 = step * world.time_step;
  world.watches.resize(world.bodies.size());
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    Body& body = world.bodies[b];
    Watch& watch = world.watches[b];
    const int n_recuts = body.n_recuts;
    on(world, body, step, t1, [&] { advance(body, world, step, watch, seconds); });
    const bool is_cut = body.n_recuts != n_recuts; // which moves corners, and makes other pieces
    const ScopedTimer timer(seconds, "solve");
    on(world, body, step, t1, [&] { require_sound_volume(body, watch, is_cut || step >= world.n_steps); });
  }
  for (Body& body : world.bodies)
    if (body.interior)
      paint(*body.interior, body.surface, seconds);
}

Timings run(World& world, Recorder& recorder, Progress& progress) {
  Timings seconds = world.setup_seconds, total;
  int step = 0;
  try {
    const Start start = recorder.resume(world);
    for (const std::string& line : start.lines)
      progress.say(line);
    if ((step = start.step) < 0)
      recorder.record(world, step = 0, seconds);
    progress.begin(step);
    while (step < world.n_steps) {
      end_if_asked(world, recorder, step);
      advance(world, ++step, seconds);
      for (const auto& [stage, s] : seconds)
        total[stage] += s;
      recorder.record(world, step, seconds);
      recorder.keep(world, step, seconds);
      progress.show(step, step * world.time_step);
    }
    for (const auto& [stage, s] : seconds)
      total[stage] += s;
  } catch (const Interrupted& wish) {
    progress.finish();
    const int last = std::max(step, recorder.last_earlier_step()); // what the files hold
    recorder.interrupt(wish.what(), last, last * world.time_step);
    throw;
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
