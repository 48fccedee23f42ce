#include "study/measure.h"

#include "base/error.h"
#include "base/interrupt.h"
#include "output/reader.h"
#include "scene/compose.h"
#include "scene/compose_physics.h"
#include "scene/inputs.h"
#include "scene/run.h"
#include "study/memory.h"
#include "study/rows.h"
#include "study/units.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <numeric>

namespace kerf::study {

namespace {

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

void require_series(const scene::Section& section, const AnswerParameters& asked, const scene::Body& body,
                    const std::string& key, const std::string& name) {
  std::string names;
  const std::string unit = asked.take == "frequency" ? "1/s" : asked.unit;
  for (const scene::Observable& series : body.observables) {
    if (series.name == name && asked.take != "frequency" && !is_same_unit(series.unit, asked.unit))
      throw section.complaint("Unit", "the series '" + name + "' has the unit " + series.unit,
                              "Write 'set Unit = " + series.unit + "', and references in it");
    if (series.name == name)
      return;
    names += (names.empty() ? "" : ", ") + series.name;
  }
  throw section.complaint(
    key, "the scene records no such series of the body " + body.name,
    "Name what gives it in its section 'Observables'. It records " + (names.empty() ? "none" : names));
}

void require_answer(const scene::Section& section, const AnswerParameters& asked, const scene::Body& body) {
  if (asked.take == "frequency" && !is_same_unit(asked.unit, "1/s"))
    throw section.complaint("Unit", "a frequency has the unit 1/s", "Write 'set Unit = 1/s', and references in it");
  require_series(section, asked, body, "Answer", asked.answer);
  if (!asked.minus.empty())
    require_series(section, asked, body, "Minus", asked.minus);
}

/// The points become probes of the body. Throws ParameterError for one outside of the material.
std::size_t add_points(const Plan& plan, scene::Body& body) {
  const std::size_t first = body.probes.size();
  for (const Vec3& X : plan.points)
    body.probes.push_back({"point", X});
  scene::find_probes(body);
  for (const scene::Probe& probe : body.probes)
    if (!probe.copy.valid())
      throw plan.at.complaint(scene::line("the point ", probe.rest[0], ", ", probe.rest[1], ", ", probe.rest[2],
                                          " lies in no material of the body ", body.name),
                              "Move it into the body, as it is at rest on the coarsest grid");
  return first;
}

/// Of the probes from `first` on, x, y, z each [m].
std::vector<double> displacements_of(const scene::Body& body, const std::size_t first) {
  const auto series = scene::observables_named("probes", body, {});
  std::vector<double> all;
  for (std::size_t i = 3 * first; i < series.size(); ++i)
    all.push_back(series[i].value(body));
  return all;
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
  const auto found = [&](const AnswerParameters& asked) {
    std::vector<double> series = reader.observable(body + " " + asked.answer);
    if (!asked.minus.empty()) {
      const auto minus = reader.observable(body + " " + asked.minus);
      std::transform(series.begin(), series.end(), minus.begin(), series.begin(), std::minus<>());
    }
    return take(series, asked, row.dt);
  };
  row.value = found(plan.parameters);
  for (std::size_t k = 0; k < plan.norms.size(); ++k)
    row.norms[k].value = found(plan.norms[k].parameters);
}

double cpu_seconds_since(const std::clock_t start) { return double(std::clock() - start) / CLOCKS_PER_SEC; }

/// Runs it, or what is left of it. However it ends, the row tells what all of its processes have cost.
void run_world(scene::World& world, const std::filesystem::path& folder, const output::RunInfo& info,
               const PlannedRow& planned, const output::Earlier earlier, const PeakMemory& memory,
               output::StudyRow& row) {
  world.output.frames_every = std::max(world.n_steps, 1);
  const scene::Source source{info, scene::standalone_text(planned.scene, scene::grammar()),
                             scene::hashes_of_inputs(planned.scene, scene::grammar())};
  const std::clock_t start = std::clock();
  scene::Recorder recorder(folder, world, source, earlier);
  recorder.measure([&] { return scene::Cost{cpu_seconds_since(start), memory.beyond_start()}; });
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
  const std::clock_t cpu_start = std::clock();
  try {
    scene::World world = scene::compose(planned.scene);
    row.setup_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    row.setup_cpu_seconds = cpu_seconds_since(cpu_start);
    return world;
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    row.outcome = "failed: " + in_one_line(error.what());
    return std::nullopt;
  }
}

/// Of passages upwards through the mean; between entries the series is a line.
double frequency(const std::vector<double>& series, const double dt) {
  const double mean = std::accumulate(series.begin(), series.end(), 0.0) / double(series.size());
  std::vector<double> passages;
  for (std::size_t i = 1; i < series.size(); ++i)
    if (series[i - 1] < mean && series[i] >= mean)
      passages.push_back((double(i) - (series[i] - mean) / (series[i] - series[i - 1])) * dt);
  return passages.size() < 2 ? unknown : double(passages.size() - 1) / (passages.back() - passages.front());
}

/// One of the repetitions of a row.
output::StudyRow measure_once(const Plan& plan, const PlannedRow& planned, const std::filesystem::path& folder,
                              const output::RunInfo& info, const output::Earlier earlier) {
  output::StudyRow row = failed_row(planned, "");
  name_physics(find_body(plan, scene::parse_scene(planned.scene, scene::grammar())), row);

  const PeakMemory memory;
  std::optional<scene::World> world = compose(planned, row);
  if (!world)
    return row;
  scene::Body& body = find_body(plan, *world);
  require_answer(plan.study, plan.parameters, body);
  for (const Norm& norm : plan.norms)
    require_answer(norm.section, norm.parameters, body);
  const std::size_t first_point = add_points(plan, body);
  const auto is_iterations = [](const scene::Observable& series) { return series.name == iterations; };
  if (std::none_of(body.observables.begin(), body.observables.end(), is_iterations))
    body.observables.push_back(*scene::find_observable(iterations));
  output::require_claimable(folder, earlier);
  row.dt = world->time_step;
  row.outcome = "completed";
  try {
    run_world(*world, folder, info, planned, earlier, memory, row);
    row.displacements = displacements_of(body, first_point);
  } catch (const DataError&) {
    throw;
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    row.outcome = "failed: " + in_one_line(error.what());
  }
  row.n_dof = count_dof(*world);
  read_run(folder / "run.h5", plan, body.name, row);
  if (plan.parameters.times == "do not count")
    row.setup_seconds = row.setup_cpu_seconds = row.stepping_seconds = row.cpu_seconds = unknown;
  return row;
}

/// Median into the one, largest less smallest into the other, if there is one.
void gather(const std::vector<output::StudyRow>& runs, double output::StudyRow::*median,
            double output::StudyRow::*spread, output::StudyRow& row) {
  std::vector<double> all;
  for (const output::StudyRow& run : runs)
    all.push_back(run.*median);
  std::sort(all.begin(), all.end());
  const std::size_t n = all.size();
  row.*median = (all[(n - 1) / 2] + all[n / 2]) / 2;
  if (spread)
    row.*spread = all.back() - all.front();
}

std::vector<double> numbers_of(const output::StudyRow& row) {
  std::vector<double> all = {row.value, double(row.n_dof), double(row.n_steps), double(row.n_iterations)};
  for (const output::NormValue& norm : row.norms)
    all.push_back(norm.value);
  all.insert(all.end(), row.displacements.begin(), row.displacements.end());
  return all;
}

/// Bit by bit: two that are not known are the same.
bool are_same(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const double x, const double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

/// Relative, in the L2 norm and at most.
void compare_displacements(output::StudyRow& row) {
  double difference = 0, reference = 0, largest_difference = 0, largest = 0;
  for (std::size_t i = 0; i + 2 < row.displacements.size(); i += 3) {
    const Eigen::Map<const Vec3> u(&row.displacements[i]), v(&row.reference_displacements[i]);
    difference += (u - v).squaredNorm();
    reference += v.squaredNorm();
    largest_difference = std::max(largest_difference, (u - v).norm());
    largest = std::max(largest, v.norm());
  }
  row.error_l2 = std::sqrt(difference / reference);
  row.error_max = largest_difference / largest;
}

/// Whether the backend of the body that a key belongs to does not look at it.
bool is_left_out(const PlannedRow& row, const std::string& path) {
  const scene::Section root = scene::parse_scene(row.scene, scene::grammar());
  for (const scene::Section* const body : root.all("Body"))
    for (const std::string& key : scene::keys_left_out(body->read<scene::BodyParameters>()))
      if (path == "Body " + body->name() + "/" + key)
        return true;
  return false;
}

/// Whether a key that the case sets is read in the row's scene; told so too where the scene has another fault, which
/// the row tells.
bool reads(const PlannedRow& row, const PlannedCase& one) {
  try {
    scene::compose(row.scene);
    return std::any_of(one.paths.begin(), one.paths.end(),
                       [&](const std::string& path) { return !is_left_out(row, path); });
  } catch (const ParameterError& error) {
    const Complaint& complaint = error.complaint();
    const auto is_it = [&](const std::string& key) {
      return key == complaint.path || key.starts_with(complaint.path + "/");
    };
    return complaint.rule.find("nothing reads this") == std::string::npos ||
           std::none_of(one.paths.begin(), one.paths.end(), is_it);
  } catch (const DataError&) {
  }
  return true;
}

} // namespace

double take(const std::vector<double>& series, const AnswerParameters& how, const double dt) {
  if (series.empty())
    return unknown;
  if (how.take == "maximum")
    return *std::max_element(series.begin(), series.end());
  if (how.take == "minimum")
    return *std::min_element(series.begin(), series.end());
  if (how.take == "end")
    return series.back();
  if (how.take == "frequency")
    return frequency(series, dt);
  const auto n = std::clamp<std::ptrdiff_t>(std::llround(how.last_part * double(series.size())), 1, std::ssize(series));
  return std::accumulate(series.end() - n, series.end(), 0.0) / double(n);
}

output::StudyRow failed_row(const PlannedRow& planned, const std::string& why) {
  output::StudyRow row;
  row.name = planned.name;
  row.family = planned.family;
  row.changes = changes_in_one_line(planned.overrides);
  row.reference = planned.reference.value != 0 ? planned.reference.value : unknown;
  row.reference_source = planned.reference.source;
  for (const double reference : planned.norm_references)
    row.norms.push_back({unknown, reference != 0 ? reference : unknown, unknown});
  for (const Vec3& u : planned.reference.displacements)
    row.reference_displacements.insert(row.reference_displacements.end(), u.begin(), u.end());
  row.value = row.error = row.order = row.peak_memory = row.error_l2 = row.error_max = unknown;
  row.setup_spread = row.stepping_spread = row.cpu_spread = unknown;
  if (!why.empty())
    row.outcome = "failed: " + in_one_line(why);
  return row;
}

output::StudyRow together(const std::vector<output::StudyRow>& runs) {
  output::StudyRow row = runs.front();
  row.n_repetitions = std::ssize(runs);
  gather(runs, &output::StudyRow::setup_seconds, &output::StudyRow::setup_spread, row);
  gather(runs, &output::StudyRow::stepping_seconds, &output::StudyRow::stepping_spread, row);
  gather(runs, &output::StudyRow::setup_cpu_seconds, nullptr, row);
  gather(runs, &output::StudyRow::cpu_seconds, &output::StudyRow::cpu_spread, row);
  for (std::size_t i = 1; i < runs.size(); ++i) {
    row.peak_memory = std::max(row.peak_memory, runs[i].peak_memory);
    if (row.outcome == "completed" && runs[i].outcome != "completed")
      row.outcome = "failed: repetition " + std::to_string(i + 1) + " has " + runs[i].outcome;
    else if (row.outcome == "completed" && !are_same(numbers_of(row), numbers_of(runs[i])))
      row.outcome = "failed: repetition " + std::to_string(i + 1) + " has other numbers: the value is " +
                    to_text(runs[i].value) + " and was " + to_text(row.value);
  }
  return row;
}

void tell_errors(output::StudyRow& row) {
  row.error = row.value / row.reference - 1;
  for (output::NormValue& norm : row.norms)
    norm.error = norm.value / norm.reference - 1;
  row.error_l2 = row.error_max = unknown;
  if (!row.displacements.empty() && row.displacements.size() == row.reference_displacements.size())
    compare_displacements(row);
}

void require_changes_read(const Plan& plan) {
  for (const PlannedCase& one : plan.cases)
    if (std::none_of(one.rows.begin(), one.rows.end(), [&](const std::size_t k) { return reads(plan.rows[k], one); }))
      throw one.section.complaint(one.key,
                                  "no row reads what this case changes: its keys belong to another backend, "
                                  "integrator or material than any row has",
                                  "Remove it, or add a variant that reads it");
}

output::StudyRow measure(const Plan& plan, const PlannedRow& planned, const std::filesystem::path& folder,
                         const output::RunInfo& info, const output::Earlier earlier) {
  std::vector<output::StudyRow> runs;
  for (int i = 1; i <= plan.parameters.repetitions; ++i) {
    runs.push_back(measure_once(plan, planned, i == 1 ? folder : folder / std::to_string(i), info, earlier));
    if (runs.back().outcome != "completed")
      break;
  }
  output::StudyRow row = together(runs);
  tell_errors(row);
  return row;
}

} // namespace kerf::study
