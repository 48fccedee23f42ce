#include "study/stability.h"

#include "base/error.h"
#include "base/interrupt.h"
#include "material/elastic.h"
#include "output/checkpoint_file.h"
#include "scene/compose.h"
#include "scene/run.h"
#include "study/resumed.h"
#include "study/rows.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>

namespace kerf::study {

namespace {

constexpr char file_name[] = "stability.h5";

/// What was seen of a run.
struct Seen {
  enum class End { completed, refused, stopped } end = End::completed;
  std::string reason;
  double start = 0, largest = 0, late = 0, last = 0; ///< energies [J]; late: mean of the second half
  double scale = 0;                                  ///< energy that the others are measured by [J]
  double momentum = 0, mass = 0;                     ///< its change [kg m/s], [kg]
  double volume = 1;                                 ///< over that at rest [1]
  bool is_back = true;                               ///< was sound once
  int n_steps = 0, n_divided = 0;
  std::int64_t n_iterations = 0;
  double predicted_step = 0; ///< [s]
};

Vec3 momentum_of(scene::Body& body) {
  const auto mass = body.physics->model().lumped_mass();
  Vec3 sum = body.physics->crumbs().momentum(body.state);
  for (std::size_t i = 0; i < mass.size(); ++i)
    sum += mass[i] * body.state.v[i];
  return sum;
}

double mass_of(scene::Body& body) {
  double sum = body.physics->crumbs().mass();
  for (const double m : body.physics->model().lumped_mass())
    sum += m;
  return sum;
}

/// A strain of 1e-4 all over: what is less passes for nothing [J].
double hardly_any_energy(const scene::Body& body, const StabilityCase& one) {
  const auto root = scene::parse_scene(one.scene, scene::grammar());
  const scene::Section* section = root.require("Body").find("Material");
  const double E = section ? section->read<material::Elastic>().youngs_modulus : material::Elastic().youngs_modulus;
  return 1e-8 * E * body.first_volume;
}

void see_start(scene::Body& body, const StabilityCase& one, const Vec3& momentum, Seen& seen) {
  seen.start = body.accounts->start_energy() + body.accounts->work_of_cut();
  seen.scale = std::max(seen.start, hardly_any_energy(body, one));
  seen.mass = mass_of(body);
  seen.momentum = (momentum_of(body) - momentum).norm();
}

/// Steps a body that is alone, and looks at it after each.
void step_through(scene::World& world, const StabilityCase& one, const int n_steps, Seen& seen) {
  scene::Body& body = world.bodies.front();
  const Vec3 momentum = momentum_of(body);
  Timings seconds;
  for (int step = 1; step <= n_steps; ++step) {
    if (const int signal = wish_to_end(); signal != 0)
      throw Interrupted(signal, ". --resume goes on with the row that was under way");
    scene::advance(world, step, seconds);
    if (step == 1)
      see_start(body, one, momentum, seen);
    seen.last = scene::total_energy(*body.physics, body.loads, body.state);
    seen.largest = std::max(seen.largest, seen.last);
    if (2 * step > n_steps)
      seen.late += seen.last / (n_steps - n_steps / 2);
    seen.momentum = std::max(seen.momentum, (momentum_of(body) - momentum).norm());
    seen.n_iterations += body.report.n_iterations;
    seen.predicted_step = body.report.stable_step;
    seen.n_steps = step;
  }
  seen.n_divided = body.n_divided;
  seen.is_back = world.watches.front().is_sound;
  seen.volume = surface::enclosed_volume(scene::positions(body), body.surface.triangles) /
                surface::enclosed_volume(body.surface.rest, body.surface.triangles);
}

/// Runs until it ends, however it does.
Seen run(const StabilityCase& one, const int n_steps) {
  Seen seen;
  const auto end = [&](const Seen::End how, const std::exception& error) {
    seen.end = how;
    seen.reason = in_one_line(error.what());
  };
  try {
    scene::World world = scene::compose(one.scene);
    scene::Body& body = world.bodies.front();
    body.accounts = std::make_unique<scene::Accounts>();
    body.accounts->open(*body.physics, body.loads, body.state);
    step_through(world, one, n_steps, seen);
  } catch (const Interrupted&) {
    throw;
  } catch (const ParameterError& error) {
    end(Seen::End::refused, error);
  } catch (const std::exception& error) {
    end(Seen::End::stopped, error);
  }
  return seen;
}

std::string per_cent(const double part) { return to_text(std::round(1e3 * part) / 10) + " %"; }

/// The word for what was seen; and the reason, where that is not told.
std::string outcome_of(Seen& seen, const bool is_equilibrium) {
  constexpr double doubled = 2, drift = 0.01, gone = 1e-3, off = 0.3;
  if (seen.end == Seen::End::refused)
    return "refused";
  if (seen.end == Seen::End::stopped)
    return "stopped";
  const double largest = seen.largest / seen.scale, last = seen.last / seen.scale, late = seen.late / seen.scale,
               momentum = seen.momentum / std::sqrt(2 * seen.mass * seen.scale);
  if (!(largest < doubled)) {
    seen.reason = "energy grew to " + per_cent(largest);
    return "failed";
  }
  if (!seen.is_back)
    return "not back";
  if (!(std::abs(seen.volume - 1) < off) && last < gone) {
    seen.reason = "volume is " + per_cent(seen.volume);
    return "failed";
  }
  if (!(late < 1 + drift) || !(momentum < drift)) {
    seen.reason = late < 1 + drift ? "momentum changed by " + per_cent(momentum) : "energy grew to " + per_cent(late);
    return "drifted";
  }
  return last < gone && seen.start == seen.scale && !is_equilibrium ? "damped out" : "stable";
}

/// Explicit integrators that go on beyond their stable step do not compute it: writes that they shall refuse to.
void refuse_beyond_stable_step(scene::WrittenSection& section) {
  if (scene::WrittenKey* const key = section.find_key("Beyond the stable step"))
    key->value = "refuse";
  for (scene::WrittenSection& inside : section.sections)
    refuse_beyond_stable_step(inside);
}

/// What the integrator says of itself at the start [s]; 0: nothing.
double predicted_step(const StabilityCase& one, double dt) {
  constexpr int most = 8;
  StabilityCase other = one;
  refuse_beyond_stable_step(other.scene.root);
  for (int n = 0; n < most; ++n, dt /= 10) {
    other.scene = with_step(other.scene, dt, 1);
    if (const Seen seen = run(other, 1); seen.predicted_step > 0)
      return seen.predicted_step;
  }
  return 0;
}

/// The longest step with which a run completes and its energy at most doubles, to 1 % [s].
double largest_step(const StabilityCase& one, const double first, const int n_steps) {
  const auto is_stable = [&](const double dt) {
    StabilityCase other = one;
    other.scene = with_step(one.scene, dt, n_steps);
    const Seen seen = run(other, n_steps);
    return seen.end == Seen::End::completed && seen.largest < 2 * seen.scale;
  };
  constexpr double factor = 1.5, precise = 1.01;
  constexpr int most = 40;
  double low = first, high = first;
  int n = 0;
  if (is_stable(first))
    for (; n < most && is_stable(high *= factor); ++n)
      low = high;
  else
    for (; n < most && !is_stable(low /= factor); ++n)
      high = low;
  if (n == most)
    return low < first ? 0 : std::numeric_limits<double>::infinity();
  while (high > precise * low) {
    const double middle = std::sqrt(low * high);
    (is_stable(middle) ? low : high) = middle;
  }
  return low;
}

/// Names, and what is known before the run.
output::StabilityRow described(const StabilityCase& one) {
  const auto root = scene::parse_scene(one.scene, scene::grammar());
  const auto body = root.require("Body").read<scene::BodyParameters>();
  output::StabilityRow row;
  row.sweep = one.sweep;
  row.variant = one.variant;
  row.cases = one.cases;
  row.changes = changes_in_one_line(one.overrides);
  row.backend = body.backend;
  row.integrator = body.backend == "lattice" ? "shape matching" : body.integrator;
  row.dt = root.require("Time").read<scene::TimeParameters>().time_step;
  row.predicted_step = row.largest_step = unknown;
  return row;
}

} // namespace

output::StabilityRow watch(const StabilityCase& one, const int n_steps) {
  output::StabilityRow row = described(one);
  const std::clock_t start = std::clock();
  Seen seen = run(one, n_steps);
  row.outcome = outcome_of(seen, row.integrator == "quasi-static");
  row.reason = seen.reason;
  row.start_energy = seen.start;
  row.largest_energy = seen.largest / seen.scale;
  row.last_energy = seen.last / seen.scale;
  row.momentum = seen.momentum / std::sqrt(2 * seen.mass * seen.scale);
  row.volume = seen.volume;
  row.n_steps = seen.n_steps;
  row.n_iterations = seen.n_iterations;
  row.n_divided = seen.n_divided;
  if (one.ask == Ask::largest_step) {
    row.predicted_step = predicted_step(one, row.dt);
    row.largest_step = largest_step(one, row.predicted_step > 0 ? row.predicted_step : row.dt, n_steps);
  }
  row.cpu_seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
  return row;
}

namespace {

std::vector<const scene::SceneText*> scenes_of(const StabilityPlan& plan) {
  std::vector<const scene::SceneText*> scenes;
  for (const StabilityCase& one : plan.cases)
    scenes.push_back(&one.scene);
  return scenes;
}

} // namespace

output::StabilityTable run_stability_study(const StabilityPlan& plan, const std::filesystem::path& folder,
                                           const output::RunInfo& info, const output::Earlier earlier,
                                           const std::function<void(const output::StabilityRow&)>& done) {
  using Clock = std::chrono::steady_clock;
  constexpr auto every = std::chrono::seconds(1); // at most so often the file is written
  const output::ResultsFolder claimed(folder, earlier, {file_name, output::name_beside(file_name).string()});
  output::StabilityTable table{plan.parameters.title, plan.text, {}, {}};
  const auto write = [&](const output::Outcome outcome) {
    table.outcome = outcome;
    output::write_stability_file(folder / file_name, table, info);
  };
  table.made_of = made_of(info, plan.text, scenes_of(plan));
  if (earlier == output::Earlier::resume)
    table.rows = earlier_rows(folder / file_name, output::read_stability_file, table.made_of);
  for (const output::StabilityRow& row : table.rows)
    done(row);
  auto next = Clock::now();
  for (std::size_t r = table.rows.size(); r < plan.cases.size(); ++r) {
    try {
      table.rows.push_back(watch(plan.cases[r], plan.parameters.n_steps));
    } catch (const Interrupted&) {
      write(output::Outcome::interrupted);
      throw;
    }
    if (Clock::now() >= next) {
      write(output::Outcome::running);
      next = Clock::now() + every;
    }
    done(table.rows.back());
  }
  write(output::Outcome::completed);
  return table;
}

} // namespace kerf::study
