#include "scene/compose.h"

#include "cut/embed.h"
#include "dynamics/implicit_euler.h"
#include "dynamics/symplectic_euler.h"
#include "fem/corotational.h"
#include "geometry/box_tree.h"
#include "geometry/solid.h"
#include "scene/expression.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

namespace kerf::scene {

namespace {

struct Settings {
  material::Elastic material;
  DampingParameters damping;
  ImplicitEulerParameters implicit_euler;
};

template <class Fields>
Fields read_if_written(const Section& parent, const std::string& kind) {
  const Section* section = parent.find(kind);
  return section ? section->read<Fields>() : Fields();
}

/// What another room says, to stand inside a sentence.
std::string clause(const std::string& sentence) { return sentence.substr(0, sentence.find_last_not_of(" .") + 1); }

/// A room below knows the rule, the scene knows the place: the complaint of a room about a key, at the key's line.
ParameterError placed(const Section& section, const std::string& key, const ParameterError& error) {
  const Complaint& complaint = error.complaint();
  const std::string detail = complaint.value.empty() ? "" : " (here " + complaint.value + ")";
  return section.complaint(key, complaint.rule + detail, clause(complaint.remedy));
}

/// Relative paths start at the scene file.
std::string resolved(const std::filesystem::path& path, const Section& section) {
  const auto folder = std::filesystem::path(section.origin().file).parent_path();
  return (path.is_relative() ? folder / path : path).string();
}

geometry::TriangleMesh read_body_mesh(const Section& section, const BodyParameters& parameters) {
  const std::string path = resolved(parameters.mesh, section);
  try {
    return geometry::require_solid(geometry::read_mesh(path, parameters.mesh_unit), path);
  } catch (const DataError& error) {
    throw DataError(section.complaint("Mesh", clause(error.what()), "").complaint());
  }
}

/// A line of the composition, from anything that prints.
template <class... Parts>
std::string line(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

cut::Embedding embed_mesh(const Section& section, const BodyParameters& parameters,
                          const geometry::TriangleMesh& mesh) {
  constexpr double most_cells = 1e8;
  const double n_cells = geometry::volume(mesh) / std::pow(parameters.cube_edge, 3);
  if (n_cells > most_cells)
    throw section.complaint("Cube edge [m]",
                            line("would fill the mesh with ", n_cells, " cells, more than ", most_cells),
                            "Use larger cubes, or check Mesh unit [m]");
  try {
    return cut::embed(mesh, parameters.cube_edge, parameters.lattice_offset);
  } catch (const ParameterError& error) { // about one of the last two, which embed calls as the scene does
    throw section.complaint(error.complaint().path, error.complaint().rule, error.complaint().remedy);
  } catch (const DataError&) {
    throw section.complaint("Cube edge [m]", "no grid node is inside the mesh, it is smaller than a cube",
                            "Use smaller cubes, or check Mesh unit [m]");
  }
}

std::function<Physics(const Body&)> physics_maker(const Section& section, const BodyParameters& parameters,
                                                  const material::Elastic& material) {
  fem::CorotationalOptions fem_options{.material = material};
  if (parameters.integration == "full cube")
    fem_options.integration = fem::Integration::full_cube;
  if (parameters.integrator == "symplectic Euler") {
    fem_options.sliver_floor = 0; // nothing is solved
    fem_options.mass_spread = read_if_written<SymplecticEulerParameters>(section, "Symplectic Euler").mass_spread;
    return [fem_options](const Body& body) {
      Physics physics{std::make_unique<fem::Corotational>(body.grid, body.cuts, body.complex, fem_options), nullptr};
      physics.stepper = std::make_unique<dynamics::SymplecticEuler>(*physics.model);
      return physics;
    };
  }
  const auto settings = read_if_written<ImplicitEulerParameters>(section, "Implicit Euler");
  fem_options.sliver_floor = settings.sliver_floor;
  const dynamics::ImplicitEulerOptions options{settings.n_newton, settings.cg_tolerance, settings.max_cg_iterations};
  return [fem_options, options](const Body& body) {
    Physics physics{std::make_unique<fem::Corotational>(body.grid, body.cuts, body.complex, fem_options), nullptr};
    physics.stepper = std::make_unique<dynamics::ImplicitEuler>(*physics.model, options);
    return physics;
  };
}

SupportRegion compose_support(const Section& section) {
  const auto parameters = section.read<SupportParameters>();
  if ((parameters.lower.array() > parameters.upper.array()).any())
    throw section.complaint("Upper [m]", "must not be below Lower [m] in any direction", "Swap the two");
  return {{parameters.lower, parameters.upper}, displacement_of_time(section, parameters.displacement)};
}

void require_held_nodes(const Section& section, const Body& body, const SupportRegion& region) {
  for (const auto n : ids<grid::NodeId>(body.grid.n_nodes()))
    if (region.box.contains(body.grid.position(n)))
      return;
  throw section.complaint("the box holds no grid node of the body",
                          "Move or enlarge the box: it is meant in the rest configuration, in metres");
}

Body compose_body(const Section& section, const GravityParameters* gravity, World& world) {
  const auto parameters = section.read<BodyParameters>();
  const auto material = read_if_written<material::Elastic>(section, "Material");
  const geometry::TriangleMesh mesh = read_body_mesh(section, parameters);
  cut::Embedding embedding = [&] {
    const ScopedTimer timer(world.setup_seconds, "cut");
    return embed_mesh(section, parameters, mesh);
  }();
  Body body{section.name(), std::move(embedding.grid), std::move(embedding.cuts)};
  body.placement.sharp_angle = parameters.sharp_angle;
  body.mesh_volume = geometry::volume(mesh);
  body.n_unresolved_edges = embedding.n_double_crossings + embedding.n_triple_crossings;
  body.n_lost_shells = embedding.n_lost_components;
  body.make_physics = physics_maker(section, parameters, material);
  const auto damping = read_if_written<DampingParameters>(section, "Damping");
  body.loads.gravity = gravity ? gravity->acceleration : Vec3(Vec3::Zero());
  body.loads.mass_damping = damping.mass;
  body.loads.stiffness_damping = damping.stiffness;
  for (const Section* support : section.all("Support")) {
    body.regions.push_back(compose_support(*support));
    require_held_nodes(*support, body, body.regions.back());
  }
  if (const std::size_t n_cuts = world.blades.size() + world.cut_surfaces.size(); n_cuts > 0) {
    body.cutting = std::make_unique<Cutting>();
    body.cutting->n_cut_edges.assign(n_cuts, 0);
  }
  start(body, mesh, world.setup_seconds);
  world.composition.push_back(line("body ", body.name, ": ", mesh.triangles.size(), " mesh triangles in ",
                                   body.grid.n_cells(), " cells of ", parameters.cube_edge, " m, ",
                                   body.complex.n_corners(), " corners, ", body.surface.triangles.size(),
                                   " surface triangles"));
  world.composition.push_back(line("body ", body.name, ": corotational trilinear hexahedra, integration over ",
                                   parameters.integration, ", ", parameters.integrator, ", ", body.regions.size(),
                                   " supports"));
  return body;
}

cut::Blade compose_blade(const Section& section, const std::size_t index) {
  const auto parameters = section.read<BladeParameters>();
  if (parameters.positions.size() != parameters.times.size())
    throw section.complaint("Positions [m]", line("must be as many as Times [s], which are ", parameters.times.size()),
                            "Write one position for each time, separated by semicolons");
  if (!parameters.rotations.empty() && parameters.rotations.size() != parameters.times.size())
    throw section.complaint("Rotations [degrees]",
                            line("must be as many as Times [s], which are ", parameters.times.size(), ", or none"),
                            "Write one rotation vector for each time, separated by semicolons");
  cut::Blade blade;
  blade.name = section.name();
  blade.edge = parameters.edge;
  blade.spine = parameters.spine;
  blade.label = static_cast<grid::CutLabel>(index + 1);
  for (std::size_t i = 0; i < parameters.times.size(); ++i)
    blade.key_frames.push_back({parameters.times[i], parameters.positions[i],
                                parameters.rotations.empty() ? Vec3(Vec3::Zero()) : parameters.rotations[i]});
  try {
    cut::check(blade);
  } catch (const ParameterError& error) {
    const bool is_about_edge = error.complaint().path.ends_with("Edge [m]");
    throw placed(section, is_about_edge ? "Edge [m]" : "Times [s]", error);
  }
  return blade;
}

/// Each shape needs keys of its own and reads no others.
void require_keys_of_shape(const Section& section, ShapeParameters parameters) {
  Parameters mine, all;
  parameters.describe(mine);
  ShapeParameters().describe(all);
  std::string names;
  for (const Parameter& key : mine.list())
    names += (names.empty() ? "" : ", ") + key.name;
  for (const Parameter& key : mine.list())
    if (key.required && !section.writes(key.name))
      throw section.complaint("the shape '" + parameters.shape + "' must have the key '" + key.name + "'",
                              "Write 'set " + key.name + " = ...'. " + key.text);
  for (const Parameter& key : all.list()) {
    const auto is_it = [&](const Parameter& p) { return p.name == key.name; };
    if (section.writes(key.name) && std::none_of(mine.list().begin(), mine.list().end(), is_it))
      throw section.complaint(key.name, "the shape '" + parameters.shape + "' does not read this key",
                              "Remove it: the keys of this shape are " + names);
  }
}

cut::Shape make_shape(const ShapeParameters& p, const Section& section) {
  if (p.shape == "plane")
    return cut::Plane{p.point, p.normal.stableNormalized()};
  if (p.shape == "sphere")
    return cut::Sphere{p.point, p.radius};
  if (p.shape == "cylinder")
    return cut::Cylinder{p.point, p.axis.stableNormalized(), p.radius, p.height};
  if (p.shape == "disc")
    return cut::Disc{p.point, p.normal.stableNormalized(), p.radius};
  try {
    return geometry::read_mesh(resolved(p.mesh, section), p.mesh_unit);
  } catch (const DataError& error) {
    throw DataError(section.complaint("Mesh", clause(error.what()), "").complaint());
  }
}

TimedSurface compose_cut_surface(const Section& section, const World& world) {
  const auto parameters = section.read<CutSurfaceParameters>();
  ShapeParameters shape;
  shape.shape = parameters.shape;
  require_keys_of_shape(section, shape);
  section.read(shape);
  cut::CutSurface surface{section.name(), make_shape(shape, section),
                          static_cast<grid::CutLabel>(world.blades.size() + world.cut_surfaces.size() + 1)};
  try {
    cut::check(surface);
  } catch (const ParameterError& error) {
    throw placed(section, error.complaint().path, error); // check() calls the keys as the scene does
  }
  constexpr double rounding = 1e-6; // of a step: a time that is a multiple of it is meant to be one
  const double steps_before = std::ceil(parameters.time / world.time_step - rounding);
  if (steps_before >= world.n_steps)
    throw section.complaint(
      "Time [s]", line("must be before the last step, which begins at ", (world.n_steps - 1) * world.time_step, " s"),
      "Cut earlier, or let the run end later");
  return {std::move(surface), static_cast<int>(steps_before) + 1};
}

/// A blade whose key frames stay away from the box of every body, grown by half its size for what the body may move,
/// is a mistake.
void require_meeting(const Section& section, const cut::Blade& blade, const World& world) {
  const double first = blade.key_frames.front().time, last = blade.key_frames.back().time;
  Points path = cut::world_points(blade, first);
  for (const auto& triangle : cut::sweep(blade, first, last))
    path.insert(path.end(), triangle.begin(), triangle.end());
  const Box swept = geometry::box_around(path);
  for (const Body& body : world.bodies) {
    const Box box = geometry::box_around(body.positions);
    const Vec3 slack = Vec3::Constant(0.5 * (box.upper - box.lower).norm());
    if ((swept.lower.array() <= (box.upper + slack).array()).all() &&
        (swept.upper.array() >= (box.lower - slack).array()).all())
      return;
  }
  throw section.complaint("the blade never comes near a body",
                          "Check units and key frames: positions are in metres, in the world frame");
}

Images compose_images(const Section& section) {
  const auto parameters = section.read<ImageParameters>();
  const render::Camera camera{parameters.eye,           parameters.target, parameters.up,
                              parameters.field_of_view, parameters.width,  parameters.height};
  try {
    render::check(camera);
  } catch (const ParameterError& error) {
    throw placed(section, error.complaint().path.ends_with("up") ? "Up [1]" : "Eye [m]", error);
  }
  return {parameters.every, std::make_unique<render::Renderer>(camera, render::Look())};
}

std::vector<const BodyObservable*> compose_observables(const Section& section) {
  const auto parameters = section.read<ObservableParameters>();
  std::vector<const BodyObservable*> chosen;
  std::istringstream names(parameters.names);
  for (std::string name; std::getline(names, name, ',');) {
    const auto first = name.find_first_not_of(" \t"), last = name.find_last_not_of(" \t");
    const std::string word = first == std::string::npos ? "" : name.substr(first, last - first + 1);
    const BodyObservable* observable = find_observable(word);
    if (!observable)
      throw section.complaint("Names", "'" + word + "' is not an observable",
                              "The observables and their units are listed by: kerf params");
    if (std::find(chosen.begin(), chosen.end(), observable) != chosen.end())
      throw section.complaint("Names", "'" + word + "' is named twice", "Name it once");
    chosen.push_back(observable);
  }
  return chosen;
}

void compose_time(const Section& section, World& world) {
  const auto parameters = section.read<TimeParameters>();
  const double steps = std::round(parameters.end_time / parameters.time_step);
  if (steps < 1)
    throw section.complaint("End time [s]", "must be at least one time step", "Use a later end or a smaller time step");
  if (steps > 1e9)
    throw section.complaint("Time step [s]", "must lead to the end within 1e9 steps", "Use a larger time step");
  world.time_step = parameters.time_step;
  world.n_steps = static_cast<int>(steps);
}

/// A line for each section that can be left out: there, or not there and what that means.
void say_what_there_is(const Section& root, World& world) {
  const auto say = [&](const std::string& kind, const std::string& present, const std::string& absent) {
    if (root.find(kind) && !present.empty())
      world.composition.push_back(present);
    if (!root.find(kind))
      world.composition.push_back("left out: " + kind + " (" + absent + ")");
  };
  say("Gravity", "gravity", "no field");
  say("Blade", "", root.find("Cut surface") ? "nothing is swept" : "no cut machinery in memory");
  say("Cut surface", "", "nothing is cut at once");
  say("Observables", line(world.observables.size(), " observables a body"), "no series but time");
  say("Surface file", "surface files for ParaView", "no file for ParaView");
  say("Images", "images: off-screen OpenGL", "no GL context");
}

} // namespace

World compose(const SceneText& text) {
  const Section root = parse_scene(text, grammar());
  World world;
  compose_time(root.require("Time"), world);
  const Section* gravity_section = root.find("Gravity");
  const auto gravity = read_if_written<GravityParameters>(root, "Gravity");
  root.require("Body");

  const auto blades = root.all("Blade");
  for (std::size_t i = 0; i < blades.size(); ++i) {
    world.blades.push_back(compose_blade(*blades[i], i));
    world.composition.push_back("blade " + world.blades[i].name);
  }
  for (const Section* section : root.all("Cut surface")) {
    world.cut_surfaces.push_back(compose_cut_surface(*section, world));
    const TimedSurface& timed = world.cut_surfaces.back();
    world.composition.push_back(
      line("cut surface ", timed.surface.name, ": cuts at ", (timed.step - 1) * world.time_step, " s"));
  }
  for (const Section* body : root.all("Body"))
    world.bodies.push_back(compose_body(*body, gravity_section ? &gravity : nullptr, world));
  for (std::size_t i = 0; i < blades.size(); ++i)
    require_meeting(*blades[i], world.blades[i], world);

  world.output = read_if_written<OutputParameters>(root, "Output");
  if (const Section* section = root.find("Surface file"))
    world.surface_file = section->read<SurfaceFileParameters>();
  if (const Section* section = root.find("Observables"))
    world.observables = compose_observables(*section);
  if (const Section* section = root.find("Images")) {
    world.images = compose_images(*section);
  }
  say_what_there_is(root, world);
  root.require_all_read();
  return world;
}

} // namespace kerf::scene
