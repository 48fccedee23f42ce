#include "scene/recorder.h"

#include "base/error.h"
#include "base/parallel.h"
#include "base/parameters.h"
#include "output/checkpoint_file.h"
#include "output/reader.h"
#include "scene/drawing.h"
#include "scene/fields.h"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <list>
#include <sstream>
#include <system_error>
#include <utility>

namespace kerf::scene {

namespace {

const std::string run_name = "run.h5", frames_folder = "frames";

std::string surface_name(const Body& body) { return "surface_" + body.name + ".vtkhdf"; }

std::filesystem::path image_path(const std::filesystem::path& folder, const int step) {
  std::array<char, 32> name;
  std::snprintf(name.data(), name.size(), "%06d.png", step);
  return folder / frames_folder / name.data();
}

/// What a run of this world makes in its folder.
std::vector<std::string> names_of(const World& world) {
  const std::string checkpoint = checkpoint_file("").string();
  std::vector<std::string> names = {run_name, checkpoint, output::name_beside(checkpoint).string()};
  if (world.images)
    names.push_back(frames_folder + "/*.png");
  if (world.surface_file)
    for (const Body& body : world.bodies)
      names.push_back(surface_name(body));
  return names;
}

/// Whether a run's file is there and has begun: one that was killed while it was made has no scene.
bool has_begun(const std::filesystem::path& file) {
  std::error_code error;
  return std::filesystem::file_size(file, error) > 0 && !error && output::Reader(file).has_scene();
}

output::Schema make_schema(const World& world) {
  output::Schema schema{stages(), {}};
  for (const Body& body : world.bodies)
    for (const Observable& o : body.observables)
      schema.observables.push_back({body.name + " " + o.name, o.unit, o.source});
  return schema;
}

output::Complex to_record(const Body& body) {
  output::Complex record;
  for (const grid::Copy& copy : body.solid.complex.copies) {
    if (copy.is_lapsed())
      continue;
    std::array<std::uint32_t, 8> corners;
    for (int v = 0; v < 8; ++v)
      corners[v] = copy.corners[v].value;
    record.corners.push_back(corners);
    record.cells.push_back(body.solid.grid.index(body.solid.grid.nodes(copy.cell)[0]));
    record.nodes.push_back(copy.nodes);
    record.skin.push_back(copy.skin);
  }
  record.rest_positions = grid::rest_positions(body.solid);
  return record;
}

output::Surface to_record(const surface::Surface& surface) {
  return {surface.triangles, surface.labels, surface.rest, surface.weights};
}

/// What every step of a body's surface file brings.
std::vector<output::Field> announced_of(const Body& body, const std::vector<std::string>& names) {
  std::vector<output::Field> fields = announced(body, names);
  if (body.interior)
    fields.push_back({"colour", "1", 3, {}});
  return fields;
}

/// Of the corners, where they are the particles of the body's physics.
std::span<const Vec3> velocities(const Body& body) {
  return body.state.v.size() == body.solid.complex.n_corners() && &corners(body) == &body.state.x
           ? std::span<const Vec3>(body.state.v)
           : std::span<const Vec3>();
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines)
    text += line + "\n";
  return text;
}

/// Of the clock; no more than some years.
std::chrono::steady_clock::duration seconds_of(const double seconds) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
    std::chrono::duration<double>(std::min(seconds, 1e8)));
}

void require_file(const std::filesystem::path& file, const std::string& why) {
  if (std::error_code error; !std::filesystem::exists(file, error))
    throw DataError(Complaint{.file = file.string(),
                              .rule = "is not there, and " + why,
                              .remedy = "Bring it back, or start again with --force"});
}

/// Whether a folder's run can be gone on with. Throws as require_same(), and DataError where a file of it is lost.
bool can_go_on(const std::filesystem::path& folder, const World& world, const Source& source) {
  if (!has_begun(folder / run_name))
    return false;
  require_same(folder, source);
  if (!output::Reader(folder / run_name).has_checkpoint())
    return true;
  require_file(checkpoint_file(folder), "the run that is to be resumed has written it");
  if (world.surface_file)
    for (const Body& body : world.bodies)
      require_file(folder / surface_name(body), "the run that is to be resumed has written a part of it");
  return true;
}

/// What a step's record refers to, as it was then; where nothing is written beside the steps, no more than is made for
/// it.
struct BodyEntry {
  Points positions, velocities;
  std::vector<output::Field> fields;
  output::Complex complex;
  output::Surface surface;
  output::Colours colours;
};
struct StepEntry {
  std::vector<double> values;
  std::list<BodyEntry> bodies; // they stay where they are
  output::StepRecord record;
};
struct SurfaceEntry {
  Points positions, rest;
  std::vector<Triangle> triangles;
  std::vector<std::uint16_t> labels;
  std::vector<output::Field> fields;
};

bool is_due(const int step, const int every, const World& world) { return step % every == 0 || step == world.n_steps; }

} // namespace

const std::vector<std::string>& stages() {
  static const std::vector<std::string> names = {"cut",     "topology", "assemble", "visibility", "solve",
                                                 "surface", "colour",   "output",   "images"};
  return names;
}

std::filesystem::path checkpoint_file(const std::filesystem::path& folder) { return folder / "checkpoint.kerf"; }

bool is_complete(const std::filesystem::path& folder) {
  return has_begun(folder / run_name) && output::Reader(folder / run_name).outcome() == output::Outcome::completed;
}

namespace {

/// The first line in which two texts differ, as each has it.
std::string first_difference(const std::string& there, const std::string& here) {
  const std::string nothing = "nothing";
  const auto next = [&](std::istringstream& text) {
    std::string line;
    if (!std::getline(text, line))
      return nothing;
    const auto first = std::min(line.find_first_not_of(' '), line.size());
    return "'" + line.substr(first) + "'";
  };
  std::istringstream of_there(there), of_here(here);
  std::string a, b;
  do {
    a = next(of_there);
    b = next(of_here);
  } while (a == b && a != nothing);
  return a + " there, " + b + " here";
}

} // namespace

void require_same(const std::filesystem::path& folder, const Source& source) {
  const std::filesystem::path file = folder / run_name;
  const output::Reader reader(file);
  const bool same_scene = reader.scene() == source.scene;
  if (!same_scene || reader.inputs() != source.inputs)
    throw ParameterError(Complaint{
      .file = file.string(),
      .rule = "cannot be resumed: it is a run of " +
              (same_scene ? "other meshes or pictures"
                          : "another scene (" + first_difference(reader.scene(), source.scene) + ")"),
      .remedy = "Give the scene, its --set and its files as they were, or start again with --force"});
}

Recorder::Recorder(const std::filesystem::path& folder, const World& world, const Source& source,
                   const output::Earlier earlier)
  : folder_(folder, earlier, names_of(world)),
    earlier_(earlier),
    goes_on_(earlier == output::Earlier::resume && can_go_on(folder, world, source)),
    run_file_(goes_on_ ? output::RunFile(folder / run_name)
                       : output::RunFile(folder / run_name, source.info, make_schema(world))),
    bodies_(world.bodies.size()),
    program_(source.info.version + " " + source.info.git_commit),
    inputs_(joined(source.inputs)) {
  if (world.images) {
    std::filesystem::create_directories(folder / frames_folder);
    if (n_threads() > 1)
      image_thread_ = std::make_unique<WorkThread>();
  }
  if (n_threads() > 1)
    file_thread_ = std::make_unique<WorkThread>();
  if (goes_on_) {
    if (const auto steps = run_file_.steps(); !steps.empty())
      ends_ = steps.back();
    for (const output::Observable& o : run_file_.schema().observables)
      recorded_.push_back(run_file_.observable(o.name));
  } else {
    std::error_code ignored;
    std::filesystem::remove(checkpoint_file(folder), ignored);
    run_file_.write_inputs(source.inputs);
    run_file_.write_composition(world.composition);
    run_file_.write_scene(source.scene); // last: with it, the file has begun
  }
  if (world.surface_file)
    open_surface_files(world);
}

void Recorder::open_surface_files(const World& world) {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const auto path = folder() / surface_name(world.bodies[b]);
    const auto fields = announced_of(world.bodies[b], world.fields);
    std::error_code error;
    const bool is_there = goes_on_ && std::filesystem::file_size(path, error) > 0 && !error;
    bodies_[b].surface_file = is_there ? output::SurfaceFile::go_on(path, fields) : output::SurfaceFile(path, fields);
    bodies_[b].surface_ends = bodies_[b].surface_file->last_time();
  }
}

/// What this process has cost, but for the threads that record beside the steps.
Cost Recorder::cost() const {
  Cost now = cost_ ? cost_() : Cost();
  for (const auto* thread : {&image_thread_, &file_thread_})
    now.cpu_seconds -= *thread ? (*thread)->cpu_seconds() : 0;
  return now;
}

Cost Recorder::total_cost() const {
  const Cost now = cost();
  return {earlier_cost_.cpu_seconds + now.cpu_seconds - recording_cpu_,
          std::max(now.peak_memory, earlier_cost_.peak_memory)};
}

Start Recorder::resume(World& world) {
  next_checkpoint_ = Clock::now() + seconds_of(world.output.checkpoint_interval);
  const auto checkpoint = goes_on_ ? output::read_checkpoint(checkpoint_file(folder())) : std::nullopt;
  if (!checkpoint && earlier_ != output::Earlier::resume)
    return {};
  if (!checkpoint)
    return {-1,
            {ends_ < 0 ? "nothing is there to resume: starts from step 0"
                       : "no checkpoint had been written: starts from step 0, and compares with the " +
                           std::to_string(ends_) + " steps that are recorded"}};
  if (checkpoint->inputs != inputs_ || checkpoint->program != program_)
    throw DataError(Complaint{.file = checkpoint_file(folder()).string(),
                              .rule = "was written by " + checkpoint->program + ", and this is " + program_,
                              .remedy = "Resume with the same program, or start again with --force"});
  if (checkpoint->step > ends_)
    throw DataError(Complaint{.file = (folder() / run_name).string(),
                              .rule = "ends before its checkpoint, after step " + std::to_string(ends_),
                              .remedy = "The disk has lost something of it: start again with --force"});
  Archive state(checkpoint->state, checkpoint_file(folder()).string());
  for (Body& body : world.bodies)
    archive(state, body);
  state(bodies_, world.watches, earlier_cost_.cpu_seconds, earlier_cost_.peak_memory);
  const int step = static_cast<int>(checkpoint->step);
  Start start{step,
              {"goes on from step " + std::to_string(step) + " of " + std::to_string(world.n_steps) +
               " (t = " + to_text(step * world.time_step) + " s)"}};
  for (const std::string& line : warn_of_lost_images(world, step))
    start.lines.push_back(line);
  return start;
}

std::vector<std::string> Recorder::warn_of_lost_images(const World& world, const int step) const {
  std::vector<std::filesystem::path> lost;
  for (int i = 0; world.images && i <= step; i += world.images->every)
    if (const auto path = image_path(folder(), i); !std::filesystem::exists(path))
      lost.push_back(path);
  if (lost.empty())
    return {};
  return {"warning: " + std::to_string(lost.size()) + " images up to there are lost, " + lost.front().string() +
          " first, and are not drawn again. Start again with --force to have them"};
}

void Recorder::keep(World& world, const int step, Timings& seconds) {
  const int every = world.output.checkpoint_every;
  const double interval = world.output.checkpoint_interval;
  if (every > 0 ? step % every != 0 : interval == 0 || Clock::now() < next_checkpoint_)
    return;
  constexpr double most = 0.01; // of the time
  const auto start = Clock::now();
  {
    const ScopedTimer timer(seconds, "output");
    keep_now(world, step);
  }
  const std::chrono::duration<double> took = Clock::now() - start;
  next_checkpoint_ = Clock::now() + seconds_of(std::max(interval, took.count() / most));
}

void Recorder::keep_now(World& world, const int step) {
  wait(); // a run that goes on from here does not make them again
  Archive state;
  for (Body& body : world.bodies)
    archive(state, body);
  Cost cost = total_cost();
  state(bodies_, world.watches, cost.cpu_seconds, cost.peak_memory);
  output::write_checkpoint(checkpoint_file(folder()), {program_, inputs_, step, state.bytes()});
  if (!std::exchange(has_noted_checkpoint_, true))
    run_file_.note_checkpoint();
}

void Recorder::fail(const std::string& text, const int step, const double time) {
  try {
    wait();
  } catch (const std::exception&) { // one reason is enough
  }
  run_file_.fail({text, step, time});
}

void Recorder::interrupt(const std::string& text, const int step, const double time) {
  wait();
  run_file_.interrupt({text, step, time});
}

void Recorder::wait() {
  for (const auto* thread : {&image_thread_, &file_thread_})
    if (*thread)
      (*thread)->wait();
}

void Recorder::write(const std::unique_ptr<WorkThread>& thread, std::function<void()> work) {
  if (thread)
    thread->give(std::move(work));
  else
    work();
}

void Recorder::complete() {
  wait();
  run_file_.complete();
  std::error_code ignored; // one that stays is refused or replaced by whoever comes next
  std::filesystem::remove(checkpoint_file(folder()), ignored);
}

void Recorder::compare(const int step, const std::span<const double> values) const {
  const auto at = static_cast<std::size_t>(step); // every step has an entry, from 0 on
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::bit_cast<std::uint64_t>(recorded_[i].at(at)) != std::bit_cast<std::uint64_t>(values[i]))
      throw NumericalError("the resumed run is not the one that was recorded: in step " + std::to_string(step) + ", '" +
                           run_file_.schema().observables[i].name + "' is " + to_text(values[i]) + " and was " +
                           to_text(recorded_[i][at]) +
                           ". Another machine or library computes other bits: start again with --force");
}

void Recorder::record(const World& world, const int step, Timings& seconds) {
  const double before = cost().cpu_seconds;
  record_all(world, step, seconds);
  recording_cpu_ += cost().cpu_seconds - before;
}

void Recorder::record_all(const World& world, const int step, Timings& seconds) {
  const Timings stepping = std::exchange(seconds, {});
  const bool with_surfaces = world.surface_file && is_due(step, world.surface_file->every, world);
  const bool with_image = world.images && is_due(step, world.images->every, world);
  if (with_surfaces || with_image) {
    const ScopedTimer timer(seconds, "surface");
    for (const Body& body : world.bodies)
      positions(body);
  }
  if (with_image) {
    const ScopedTimer timer(seconds, "images");
    write_image(world, step);
  }
  const ScopedTimer timer(seconds, "output");
  const bool with_frames = is_due(step, world.output.frames_every, world);
  Fields fields;
  for (const Body& body : world.bodies)
    if (with_frames || with_surfaces)
      fields.push_back(fields_at_corners(body, world.fields));
  append_step(world, step, stepping, with_frames ? &fields : nullptr);
  if (with_surfaces)
    append_surfaces(world, step, fields);
  if (step == world.n_steps)
    wait();
}

void Recorder::append_step(const World& world, const int step, const Timings& seconds, const Fields* const fields) {
  const auto entry = std::make_shared<StepEntry>();
  for (const Body& body : world.bodies)
    for (const Observable& o : body.observables)
      entry->values.push_back(o.value(body));
  entry->record = {step * world.time_step, step, seconds, entry->values, {}};
  for (std::size_t b = 0; b < world.bodies.size() && fields; ++b) {
    const Body& body = world.bodies[b];
    BodyEntry& of_body = entry->bodies.emplace_back();
    output::BodyStep body_step{body.name, corners(body), velocities(body), (*fields)[b]};
    if (file_thread_) { // the body moves on meanwhile
      of_body.positions.assign(body_step.positions.begin(), body_step.positions.end());
      of_body.velocities.assign(body_step.velocities.begin(), body_step.velocities.end());
      of_body.fields = (*fields)[b];
      body_step = {body.name, of_body.positions, of_body.velocities, of_body.fields};
    }
    if (bodies_[b].complex_written != body.n_recuts) {
      of_body.complex = to_record(body);
      of_body.surface = to_record(body.surface);
      body_step.complex = &of_body.complex;
      body_step.surface = &of_body.surface;
      if (body.interior) {
        of_body.colours = bodies_[b].samples.append(body.interior->atlas);
        body_step.colours = &of_body.colours;
      }
      bodies_[b].complex_written = body.n_recuts;
    }
    entry->record.bodies.push_back(body_step);
  }
  if (step > ends_)
    write(file_thread_, [this, entry] { run_file_.append(entry->record); });
  else
    compare(step, entry->values);
}

void Recorder::append_surfaces(const World& world, const int step, const Fields& of_corners) {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Body& body = world.bodies[b];
    const auto topology =
      bodies_[b].surface_written != body.n_recuts ? output::Topology::changed : output::Topology::unchanged;
    bodies_[b].surface_written = body.n_recuts;
    const double time = step * world.time_step;
    if (bodies_[b].surface_ends && time <= *bodies_[b].surface_ends)
      continue;
    SurfaceEntry entry{positions(body), {}, {}, {}, at_vertices(body.surface, of_corners[b])};
    if (topology == output::Topology::changed) {
      entry.rest = body.surface.rest;
      entry.triangles = body.surface.triangles;
      entry.labels = body.surface.labels;
    }
    if (body.interior)
      entry.fields.push_back(
        {"colour", "1", 3, vertex_colours(body.interior->atlas, body.surface, render::Look().skin)});
    write(file_thread_, [&file = *bodies_[b].surface_file, time, topology, entry = std::move(entry)] {
      file.append({time, entry.positions, entry.rest, entry.triangles, entry.labels, topology, entry.fields});
    });
  }
}

void Recorder::write_image(const World& world, const int step) {
  const render::Renderer& renderer = *world.images->renderer;
  write(image_thread_,
        [&renderer, path = image_path(folder(), step).string(), batch = renderer.prepare(drawing(world, step))] {
          render::write_png(renderer.draw_batch(batch), path);
        });
}

} // namespace kerf::scene
