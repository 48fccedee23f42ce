#include "scene/recorder.h"

#include "base/error.h"
#include "scene/drawing.h"
#include "scene/fields.h"

#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include <unistd.h>

namespace kerf::scene {

namespace {

[[noreturn]] void refuse_folder(const std::filesystem::path& folder, const std::error_code& error) {
  throw DataError(Complaint{.file = folder.string(),
                            .rule = "the results folder cannot be made: " + error.message(),
                            .remedy = "Choose another folder with --output, or change its permissions"});
}

/// Removes what an earlier run into the same folder has left of a kind.
void remove_old(const std::filesystem::path& folder, const std::string& prefix, const std::string& extension) {
  std::error_code ignored; // what cannot be removed is overwritten, or its writer says why not
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
    if (entry.path().extension() == extension && entry.path().filename().string().starts_with(prefix))
      std::filesystem::remove(entry.path(), ignored);
}

/// The folder itself, or what it would have to be made in.
std::filesystem::path nearest_existing(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::path place = std::filesystem::absolute(folder);
  while (!std::filesystem::exists(place, error) && place.has_relative_path())
    place = place.parent_path();
  return place;
}

/// Folder of the run, empty of an earlier one's surfaces and images.
std::filesystem::path make_folder(const std::filesystem::path& folder, const World& world) {
  std::error_code error;
  std::filesystem::create_directories(world.images ? folder / "frames" : folder, error);
  if (error)
    refuse_folder(folder, error);
  remove_old(folder, "surface_", ".vtkhdf");
  remove_old(folder / "frames", "", ".png");
  return folder;
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
    std::array<std::uint32_t, 8> corners;
    for (int v = 0; v < 8; ++v)
      corners[v] = copy.corners[v].value;
    record.corners.push_back(corners);
    record.cells.push_back(body.solid.grid.index(body.solid.grid.nodes(copy.cell)[0]));
    record.nodes.push_back(copy.nodes);
    record.rinds.push_back(copy.rinds);
  }
  record.rest_positions = grid::rest_positions(body.solid);
  return record;
}

output::Surface to_record(const surface::Surface& surface) {
  return {surface.triangles, surface.labels, surface.rest, surface.weights};
}

/// The samples from `first` on, which the file does not have yet.
output::Colours to_record(const texture::Atlas& atlas, const std::size_t first) {
  const auto from = [&](const auto& rows) {
    return std::decay_t<decltype(rows)>(rows.begin() + std::min(first, rows.size()), rows.end());
  };
  return {atlas.first(), atlas.parts(), from(atlas.colours()), from(atlas.slopes())};
}

/// What every step of a body's surface file brings.
std::vector<output::Field> announced_of(const Body& body, const std::vector<std::string>& names) {
  std::vector<output::Field> fields = announced(names);
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

bool is_due(const int step, const int every, const World& world) { return step % every == 0 || step == world.n_steps; }

} // namespace

const std::vector<std::string>& stages() {
  static const std::vector<std::string> names = {"cut",     "topology", "assemble", "visibility", "solve",
                                                 "surface", "colour",   "output",   "images"};
  return names;
}

void require_writable(const std::filesystem::path& folder) {
  const std::filesystem::path place = nearest_existing(folder);
  std::error_code error;
  if (!std::filesystem::is_directory(place, error))
    refuse_folder(folder, error ? error : std::make_error_code(std::errc::not_a_directory));
  if (access(place.c_str(), W_OK | X_OK) != 0)
    refuse_folder(folder, std::error_code(errno, std::generic_category()));
}

Recorder::Recorder(const std::filesystem::path& folder, const World& world, const output::RunInfo& info,
                   const std::string& scene_text)
  : folder_(make_folder(folder, world)),
    run_file_(folder / "run.h5", info, make_schema(world)),
    bodies_(world.bodies.size()) {
  run_file_.write_scene(scene_text);
  run_file_.write_composition(world.composition);
  if (world.surface_file)
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      bodies_[b].surface_file.emplace(folder_ / ("surface_" + world.bodies[b].name + ".vtkhdf"),
                                      announced_of(world.bodies[b], world.fields));
}

void Recorder::record(const World& world, const int step, Timings& seconds) {
  const Timings stepping = std::exchange(seconds, {});
  if (world.images && is_due(step, world.images->every, world)) {
    const ScopedTimer timer(seconds, "images");
    write_image(world, step);
  }
  const ScopedTimer timer(seconds, "output");
  const bool with_frames = is_due(step, world.output.frames_every, world);
  const bool with_surfaces = world.surface_file && is_due(step, world.surface_file->every, world);
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    if (with_frames || with_surfaces)
      bodies_[b].fields = fields_at_corners(world.bodies[b], world.fields);
  append_step(world, step, stepping, with_frames);
  if (with_surfaces)
    append_surfaces(world, step);
}

void Recorder::append_step(const World& world, const int step, const Timings& seconds, const bool with_frames) {
  std::vector<double> values;
  for (const Body& body : world.bodies)
    for (const Observable& o : body.observables)
      values.push_back(o.value(body));
  output::StepRecord record{step * world.time_step, step, seconds, values, {}};
  std::vector<output::Complex> complexes(world.bodies.size());
  std::vector<output::Surface> surfaces(world.bodies.size());
  std::vector<output::Colours> colours(world.bodies.size());
  if (with_frames)
    for (std::size_t b = 0; b < world.bodies.size(); ++b) {
      const Body& body = world.bodies[b];
      output::BodyStep body_step{body.name, corners(body), velocities(body), bodies_[b].fields};
      if (bodies_[b].complex_written != body.n_recuts) {
        complexes[b] = to_record(body);
        surfaces[b] = to_record(body.surface);
        body_step.complex = &complexes[b];
        body_step.surface = &surfaces[b];
        if (body.interior) {
          colours[b] = to_record(body.interior->atlas, bodies_[b].n_samples_written);
          body_step.colours = &colours[b];
          bodies_[b].n_samples_written = body.interior->atlas.colours().size();
        }
        bodies_[b].complex_written = body.n_recuts;
      }
      record.bodies.push_back(body_step);
    }
  run_file_.append(record);
}

void Recorder::append_surfaces(const World& world, const int step) {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Body& body = world.bodies[b];
    const bool changed = bodies_[b].surface_written != body.n_recuts;
    auto fields = at_vertices(body.surface, bodies_[b].fields);
    if (body.interior)
      fields.push_back({"colour", "1", 3, vertex_colours(body.interior->atlas, body.surface, render::Look().skin)});
    bodies_[b].surface_file->append({step * world.time_step, body.positions, body.surface.rest, body.surface.triangles,
                                     body.surface.labels,
                                     changed ? output::Topology::changed : output::Topology::unchanged, fields});
    bodies_[b].surface_written = body.n_recuts;
  }
}

void Recorder::write_image(const World& world, const int step) {
  std::array<char, 32> name;
  std::snprintf(name.data(), name.size(), "%06d.png", step);
  render::write_png(world.images->renderer->draw(drawing(world, step)), (folder_ / "frames" / name.data()).string());
}

} // namespace kerf::scene
