#include "study/measure.h"

#include "base/interrupt.h"
#include "output/reader.h"
#include "scene/compose.h"
#include "scene/inputs.h"
#include "scene/run.h"
#include "study/memory.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <numeric>

namespace kerf::study {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
const std::string iterations = "solver iterations";

/// The body's section; the first when the study names none.
const scene::Section& find_body(const Plan& plan, const scene::Section& root) {
  const auto bodies = root.all("Body");
  const std::string& name = plan.parameters.body;
  for (const scene::Section* body : bodies)
    if (name.empty() || body->name() == name)
      return *body;
  throw plan.study.complaint("Body", "the scene has no such body", "Name one of its sections 'Body'");
}

scene::Body& find_body(const Plan& plan, scene::World& world) {
  for (scene::Body& body : world.bodies)
    if (plan.parameters.body.empty() || body.name == plan.parameters.body)
      return body;
  throw plan.study.complaint("Body", "the scene has no such body", "Name one of its sections 'Body'");
}

void require_series(const Plan& plan, const scene::Body& body, const std::string& key, const std::string& name) {
  std::string names;
  for (const scene::Observable& series : body.observables) {
    if (series.name == name && series.unit != plan.parameters.unit)
      throw plan.study.complaint("Unit", "the series '" + name + "' has the unit " + series.unit,
                                 "Write 'set Unit = " + series.unit + "', and references in it");
    if (series.name == name)
      return;
    names += (names.empty() ? "" : ", ") + series.name;
  }
  throw plan.study.complaint(
    key, "the scene records no such series of the body " + body.name,
    "Name what gives it in its section 'Observables'. It records " + (names.empty() ? "none" : names));
}

void require_answer(const Plan& plan, const scene::Body& body) {
  require_series(plan, body, "Answer", plan.parameters.answer);
  if (!plan.parameters.minus.empty())
    require_series(plan, body, "Minus", plan.parameters.minus);
}

void name_physics(const scene::Section& section, output::StudyRow& row) {
  const auto parameters = section.read<scene::BodyParameters>();
  row.backend = parameters.backend;
  row.integrator = parameters.backend == "lattice" ? "shape matching" : parameters.integrator;
  row.h = parameters.cube_edge;
}

std::int64_t count_dof(const scene::World& world) {
  std::size_t n = 0;
  for (const scene::Body& body : world.bodies)
    n += 3 * body.state.x.size();
  return static_cast<std::int64_t>(n);
}

/// What a run left behind, finished or not.
void read_run(const std::filesystem::path& file, const Plan& plan, const std::string& body, output::StudyRow& row) {
  const output::Reader reader(file);
  row.n_steps = static_cast<std::int64_t>(std::max<std::size_t>(reader.n_steps(), 1)) - 1;
  for (const std::string& stage : scene::stages())
    if (const auto seconds = reader.timing(stage); !seconds.empty() && stage != "output" && stage != "images")
      row.stepping_seconds += std::accumulate(seconds.begin() + 1, seconds.end(), 0.0);
  for (const double n : reader.observable(body + " " + iterations))
    row.n_iterations += std::llround(n);
  if (reader.outcome() != output::Outcome::completed)
    return;
  std::vector<double> series = reader.observable(body + " " + plan.parameters.answer);
  if (!plan.parameters.minus.empty()) {
    const auto minus = reader.observable(body + " " + plan.parameters.minus);
    std::transform(series.begin(), series.end(), minus.begin(), series.begin(), std::minus<>());
  }
  row.value = take(series, plan.parameters.take, plan.parameters.last_part);
}

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts)
    all += (all.empty() ? "" : " | ") + text;
  return all;
}

/// One line: outcomes stand in tables.
std::string in_one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// Runs it, or what is left of it. However it ends, the row tells what all of its processes have cost.
void run_world(scene::World& world, const std::filesystem::path& folder, const output::RunInfo& info,
               const PlannedRow& planned, const output::Earlier earlier, const PeakMemory& memory,
               output::StudyRow& row) {
  world.output.frames_every = std::max(world.n_steps, 1);
  const scene::Source source{info, scene::standalone_text(planned.scene, scene::grammar()),
                             scene::hashes_of_inputs(planned.scene, scene::grammar())};
  const std::clock_t start = std::clock();
  scene::Recorder recorder(folder, world, source, earlier);
  recorder.measure([&] {
    return scene::Cost{double(std::clock() - start) / CLOCKS_PER_SEC, memory.beyond_start()};
  });
  scene::Progress progress(world.n_steps, world.n_steps * world.time_step, scene::ProgressStyle::silent, stdout);
  const auto tell_cost = [&] {
    const scene::Cost cost = recorder.total_cost();
    row.cpu_seconds = cost.cpu_seconds;
    row.peak_memory = cost.peak_memory;
  };
  try {
    scene::run(world, recorder, progress);
  } catch (...) {
    tell_cost();
    throw;
  }
  tell_cost();
}

/// Composes; what is wrong with the scene becomes the row's outcome, and then there is no world.
std::optional<scene::World> compose(const PlannedRow& planned, output::StudyRow& row) {
  const auto start = std::chrono::steady_clock::now();
  try {
    scene::World world = scene::compose(planned.scene);
    row.setup_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return world;
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    row.outcome = "failed: " + in_one_line(error.what());
    return std::nullopt;
  }
}

} // namespace

double take(const std::vector<double>& series, const std::string& how, const double last_part) {
  if (series.empty())
    return unknown;
  if (how == "maximum")
    return *std::max_element(series.begin(), series.end());
  if (how == "minimum")
    return *std::min_element(series.begin(), series.end());
  if (how == "end")
    return series.back();
  const auto n = std::clamp<std::ptrdiff_t>(std::llround(last_part * double(series.size())), 1, std::ssize(series));
  return std::accumulate(series.end() - n, series.end(), 0.0) / double(n);
}

output::StudyRow failed_row(const PlannedRow& planned, const std::string& why) {
  output::StudyRow row;
  row.name = planned.name;
  row.family = planned.family;
  row.changes = joined(planned.overrides);
  row.reference = planned.reference.value != 0 ? planned.reference.value : unknown;
  row.reference_source = planned.reference.source;
  row.value = row.error = row.order = row.peak_memory = unknown;
  if (!why.empty())
    row.outcome = "failed: " + in_one_line(why);
  return row;
}

output::StudyRow measure(const Plan& plan, const PlannedRow& planned, const std::filesystem::path& folder,
                         const output::RunInfo& info, const output::Earlier earlier) {
  output::StudyRow row = failed_row(planned, "");
  name_physics(find_body(plan, scene::parse_scene(planned.scene, scene::grammar())), row);

  const PeakMemory memory;
  std::optional<scene::World> world = compose(planned, row);
  if (!world)
    return row;
  scene::Body& body = find_body(plan, *world);
  require_answer(plan, body);
  const auto is_iterations = [](const scene::Observable& series) { return series.name == iterations; };
  if (std::none_of(body.observables.begin(), body.observables.end(), is_iterations))
    body.observables.push_back(*scene::find_observable(iterations));
  output::require_claimable(folder, earlier);
  row.dt = world->time_step;
  row.outcome = "completed";
  try {
    run_world(*world, folder, info, planned, earlier, memory, row);
  } catch (const DataError&) {
    throw;
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    row.outcome = "failed: " + in_one_line(error.what());
  }
  row.n_dof = count_dof(*world);
  read_run(folder / "run.h5", plan, body.name, row);
  row.error = row.value / row.reference - 1;
  if (plan.parameters.times == "do not count")
    row.setup_seconds = row.stepping_seconds = row.cpu_seconds = unknown;
  return row;
}

} // namespace kerf::study
