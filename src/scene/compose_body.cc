#include "scene/compose_body.h"

#include "cut/embed.h"
#include "dynamics/modal.h"
#include "geometry/shapes.h"
#include "geometry/solid.h"
#include "material/elastic.h"
#include "physics/phyxels.h"
#include "scene/compose_interior.h"
#include "scene/compose_loads.h"
#include "scene/compose_physics.h"
#include "scene/crack_report.h"
#include "scene/initial_state.h"
#include "scene/support_report.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <sys/resource.h>
#include <unistd.h>

namespace kerf::scene {

namespace {

geometry::TriangleMesh read_solid(const Section& section, const BodyShapeParameters& shape) {
  const std::string path = resolved(shape.mesh, section);
  try {
    return geometry::require_solid(geometry::read_mesh(path, shape.mesh_unit), path);
  } catch (const DataError& error) {
    throw DataError(section.complaint("Mesh", clause(error.what()), "").complaint());
  }
}

Mat3 turned_by(const Vec3& rotation) {
  const double angle = rotation.norm();
  return angle == 0 ? Mat3(Mat3::Identity())
                    : Eigen::AngleAxisd(angle * std::numbers::pi / 180, rotation / angle).toRotationMatrix();
}

} // namespace

geometry::TriangleMesh read_body_mesh(const Section& section, const BodyParameters& parameters) {
  BodyShapeParameters of_shape;
  of_shape.shape = parameters.shape;
  const BodyShapeParameters shape = read_of_choice(section, "the shape '" + parameters.shape + "'", of_shape);
  const double edge = 0.5 * parameters.cube_edge;
  if (shape.shape == "ball")
    return geometry::ball_mesh(shape.centre, shape.radius, edge);
  if (shape.shape == "cylinder") {
    if (shape.axis.isZero(0))
      throw section.complaint("Axis [1]", "must not be zero", "Write the direction from end face to end face");
    const auto turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), shape.axis.stableNormalized());
    return geometry::placed(geometry::cylinder_mesh(shape.radius, shape.height, edge), turn.toRotationMatrix(),
                            shape.centre);
  }
  if (shape.shape == "box") {
    if (!(shape.sides.minCoeff() > 0))
      throw section.complaint("Sides [m]", "must all be > 0", "Write the lengths of the three sides");
    return geometry::placed(geometry::box_mesh(-0.5 * shape.sides, 0.5 * shape.sides), turned_by(shape.rotation),
                            shape.centre);
  }
  return read_solid(section, shape);
}

namespace {

/// The keys that make a body another size.
std::string size_keys(const BodyParameters& parameters) {
  return parameters.shape == "mesh"   ? "Mesh unit [m]"
         : parameters.shape == "box"  ? "Sides [m]"
         : parameters.shape == "ball" ? "Radius [m]"
                                      : "Radius [m] and Height [m]";
}

/// Of a slab that lies between two layers of nodes: the offset that puts one into its middle.
std::string how_to_reach(const geometry::TriangleMesh& mesh, const double cube_edge) {
  const Box box = geometry::bounding_box(mesh);
  const Vec3 sides = (box.upper - box.lower) / cube_edge;
  if (sides.minCoeff() >= 1)
    return "";
  const Vec3 offset = (sides / 2).cwiseMin(0.5);
  return line(". It is thinner than a cube: a layer of nodes lies in its middle with 'set Lattice offset [1] = ",
              offset[0], ", ", offset[1], ", ", offset[2], "'");
}

/// What this machine has, or what `ulimit -v` leaves of it [B].
double memory() {
  const double all = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  rlimit limit{};
  const bool is_limited = getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
  return is_limited ? std::min(all, static_cast<double>(limit.rlim_cur)) : all;
}

cut::Embedding embed_mesh(const Section& section, const BodyParameters& parameters,
                          const geometry::TriangleMesh& mesh) {
  constexpr double most_cells = 1e8, bytes_a_cell = 500; // at least, with the cheapest physics
  const double n_cells = geometry::volume(mesh) / std::pow(parameters.cube_edge, 3);
  if (n_cells > most_cells)
    throw section.complaint("Cube edge [m]",
                            line("would fill the body with ", n_cells, " cells, more than ", most_cells),
                            "Use larger cubes, or check " + size_keys(parameters));
  if (n_cells * bytes_a_cell > memory())
    throw section.complaint("Cube edge [m]",
                            line("would fill the body with ", n_cells, " cells, which take at least ",
                                 1e-9 * n_cells * bytes_a_cell, " GB of memory, and there are ", 1e-9 * memory()),
                            "Use larger cubes, or check " + size_keys(parameters));
  try {
    return cut::embed(mesh, parameters.cube_edge, parameters.lattice_offset);
  } catch (const ParameterError& error) { // about one of the last two, which embed calls as the scene does
    throw section.complaint(error.complaint().path, error.complaint().rule, error.complaint().remedy);
  } catch (const DataError&) {
    throw section.complaint(
      "Cube edge [m]", "no grid node is inside the body, it is smaller than a cube",
      "Use smaller cubes, or check " + size_keys(parameters) + how_to_reach(mesh, parameters.cube_edge));
  }
}

/// "left out: Element, Law"
std::string left_out(const BodyParameters& parameters) {
  std::string text;
  for (const std::string& key : keys_left_out(parameters)) {
    const std::string name = key.substr(key.find('/') + 1); // all of it where there is none
    text += (text.empty() ? "left out: " : ", ") + name.substr(0, name.find(" ["));
  }
  return text;
}

std::string describe_physics(const Section& section, const BodyParameters& parameters, const Body& body) {
  const auto material = read_if_written<material::Elastic>(section, "Material");
  if (parameters.backend == "pba") {
    const auto visibility = read_if_written<physics::VisibilityOptions>(section, "Visibility");
    const std::string masks =
      visibility.choice.criterion == "extended visibility" ? ", masks by " + visibility.choice.masks_by : "";
    const std::string sight = body.cutter ? visibility.choice.criterion + masks : "no visibility: nothing cuts";
    return line("point-based animation, ", body.physics->rest().size(), " phyxels, ", sight, ", ",
                parameters.integrator, "; ", left_out(parameters));
  }
  if (parameters.backend == "lattice")
    return line("lattice shape matching, its own integrator; ", left_out(parameters), " (it is 0)");
  if (parameters.backend == "mass-spring")
    return line("masses and springs, ", parameters.integrator, "; ", left_out(parameters), " (it is 1/4)");
  const std::string mass = parameters.mass == "consistent" ? "consistent mass, " : "";
  return line(material.law, " ", parameters.element, " hexahedra, integration over ", parameters.integration, ", ",
              mass, parameters.integrator);
}

/// Which parts of the mesh the grid takes for pieces of their own, too thin to be deformed.
std::string describe_crumbs(const Body& body) {
  constexpr std::size_t most = 5;
  const physics::Crumbs& crumbs = body.physics->crumbs();
  std::string text = line("body ", body.name, ": ", crumbs.size(),
                          " thin parts are pieces of their own on this grid, and move as rigid bodies:");
  for (std::size_t i = 0; i < std::min(most, crumbs.size()); ++i) {
    const Vec3& p = crumbs.body(i).centre;
    text += line(i == 0 ? " around (" : ", (", p[0], ", ", p[1], ", ", p[2], ") m");
  }
  return text + (crumbs.size() > most ? " and elsewhere" : "") + "; a smaller cube edge may join them";
}

/// Which parts of an uncut mesh the grid has for pieces of their own, though elastic ones; empty where there are no
/// more than the mesh has shells, voids and what becomes a crumb among these.
std::string describe_pieces(const Body& body, const std::size_t n_shells) {
  constexpr std::size_t most = 5;
  struct Piece {
    std::size_t n_cells = 0;
    Vec3 sum = Vec3::Zero(); // of their centres [m]
  };
  std::vector<Piece> pieces(body.pieces.n_pieces);
  for (const auto c : ids<grid::CopyId>(body.solid.complex.n_copies()))
    if (!body.solid.crumbs.holds(c)) {
      Piece& piece = pieces[body.pieces.piece[c]];
      ++piece.n_cells;
      piece.sum += grid::centre(body.solid.grid, body.solid.complex.copies[c].cell);
    }
  std::erase_if(pieces, [](const Piece& piece) { return piece.n_cells == 0; });
  if (pieces.size() <= n_shells)
    return "";
  std::ranges::sort(pieces, std::greater<>(), &Piece::n_cells);
  std::string text = line("warning: body ", body.name, ": ", pieces.size(), " pieces on this grid, of a mesh of ",
                          n_shells, n_shells == 1 ? " shell" : " shells", "; beside the largest:");
  for (std::size_t i = 1; i < std::min(most + 1, pieces.size()); ++i) {
    const Vec3 p = pieces[i].sum / double(pieces[i].n_cells);
    text += line(i == 1 ? " " : ", ", pieces[i].n_cells, " cubes around (", p[0], ", ", p[1], ", ", p[2], ") m");
  }
  return text + (pieces.size() > most + 1 ? " and others" : "") +
         ". A smaller cube edge, or another Lattice offset, may join them";
}

/// In statics, what the scene says of motion.
std::string describe_statics(const Body& body) {
  if (body.physics->motion() != dynamics::MotionKind::quasi_static)
    return "";
  const bool is_damped = body.loads.mass_damping > 0 || body.loads.stiffness_damping > 0;
  const bool moves = std::ranges::any_of(body.state.v, [](const Vec3& v) { return !v.isZero(0); });
  const std::string what = is_damped && moves ? "damping and initial velocity"
                           : is_damped        ? "damping"
                           : moves            ? "initial velocity"
                                              : "";
  return what.empty() ? "" : line("body ", body.name, ": statics has no motion; left out: ", what);
}

std::string describe_start(const Body& body) {
  const std::string what = body.initial ? unsound_volume(body).what : "";
  return what.empty() ? "" : line("warning: body ", body.name, " starts where nothing elastic comes: ", what);
}

std::string describe_severed(const Body& body, const geometry::TriangleMesh& mesh) {
  const std::size_t n = cut::n_severed_cells(mesh, body.solid);
  return n == 0 ? ""
                : line("warning: body ", body.name, ": in ", n,
                       " cells the grid parts walls of the mesh that are whole, as they are thinner than 1.4 cubes; smaller "
                       "cubes keep them, or another 'Lattice offset [1]' may");
}

/// Of a grid that holds much less or more than the mesh.
std::string describe_volume(const Body& body) {
  constexpr double much = 0.03;
  const double more = body.first_volume / body.mesh_volume - 1;
  if (std::abs(more) < much)
    return "";
  const std::string by_how_much = line("warning: body ", body.name, ": the grid has ",
                                       std::round(1000 * std::abs(more)) / 10, " % ", more < 0 ? "less" : "more",
                                       " volume than the mesh");
  if (body.n_thin_walls + body.n_thin_gaps == 0)
    return by_how_much + ", which bends too much for its cubes. Smaller ones follow it";
  return line(by_how_much, ": ", body.n_thin_walls,
              " of its edges pass through walls or crests between nodes, which are lost, ", body.n_thin_gaps,
              " through gaps or grooves, which are filled. Smaller cubes keep them");
}

} // namespace

Body compose_body(const Section& section, const GravityParameters* gravity, const std::vector<const Section*>& floors,
                  World& world) {
  const auto parameters = section.read<BodyParameters>();
  const geometry::TriangleMesh mesh = read_body_mesh(section, parameters);
  const Section* const interior = section.find("Interior");
  if (interior)
    require_affordable_colours(*interior, mesh, parameters.cube_edge);
  cut::Embedding embedding = [&] {
    const ScopedTimer timer(world.setup_seconds, "cut");
    return embed_mesh(section, parameters, mesh);
  }();
  Body body{section.name(), std::move(embedding.solid)};
  body.placement.sharp_angle = parameters.sharp_angle;
  body.mesh_volume = geometry::volume(mesh);
  body.n_thin_walls = embedding.n_thin_walls;
  body.n_thin_gaps = embedding.n_thin_gaps;
  body.n_triple_crossings = embedding.n_triple_crossings;
  body.n_lost_shells = embedding.n_lost_components;
  body.density = read_if_written<material::Elastic>(section, "Material").density;
  const auto damping = read_if_written<DampingParameters>(section, "Damping");
  body.loads.gravity = gravity ? gravity->acceleration : Vec3(Vec3::Zero());
  body.loads.mass_damping = damping.mass;
  body.loads.stiffness_damping = damping.stiffness;
  compose_loads(section, floors, body);
  if (parameters.integrator == "modal")
    body.n_modes = read_if_written<dynamics::ModalParameters>(section, "Modal").n_modes;
  body.fronts = compose_crack_fronts(section, parameters.cube_edge, parameters.backend);
  if (const std::size_t n_cuts = world.blades.size() + world.cut_surfaces.size(); n_cuts > 0) {
    const auto fronts = parameters.backend == "fem"   ? cut::Fronts::of_elements
                        : parameters.backend == "pba" ? cut::Fronts::of_points
                                                      : cut::Fronts::of_springs;
    body.cutter = std::make_unique<cut::Cutter>(n_cuts, cut::Release::queued, fronts);
  }
  start(body, mesh, physics_maker(section, parameters, world.time_step), world.setup_seconds);
  if (const Section* initial = section.find("Initial state")) {
    body.initial = compose_initial_state(*initial);
    put_in_initial_state(body, world.time_step);
  }
  if (interior) {
    {
      const ScopedTimer timer(world.setup_seconds, "colour");
      body.interior = compose_interior(*interior, body.name, mesh, world.composition);
    }
    paint(*body.interior, body.surface, world.setup_seconds);
  }
  require_sound_loads(section, world.n_steps * world.time_step, body);
  world.composition.push_back(line("body ", body.name, ": ", mesh.triangles.size(), " mesh triangles in ",
                                   body.solid.grid.n_cells(), " cells of ", parameters.cube_edge, " m, ",
                                   body.solid.complex.n_corners(), " corners, ", body.surface.triangles.size(),
                                   " surface triangles"));
  const std::size_t n_supports = section.all("Support").size(); // those that hold the skin are loads
  world.composition.push_back(line("body ", body.name, ": ", describe_physics(section, parameters, body), ", ",
                                   n_supports, " supports, ",
                                   body.regions.size() + body.load_makers.size() - n_supports, " loads"));
  for (const std::string& said : {describe_statics(body), describe_start(body), describe_volume(body)})
    if (!said.empty())
      world.composition.push_back(said);
  for (const std::string& said : describe_supports(body))
    world.composition.push_back(said);
  for (const std::string& said : describe_skin_supports(section, body))
    world.composition.push_back(said);
  for (const std::string& warning : warn_of_friction(section, floors, body, world.time_step))
    world.composition.push_back(warning);
  for (const std::string& warning : check_crack_fronts(section, body))
    world.composition.push_back(warning);
  for (const std::string& warning : warn_of_fronts(body, world))
    world.composition.push_back(warning);
  if (const std::string said = describe_severed(body, mesh); !said.empty())
    world.composition.push_back(said);
  if (body.physics->crumbs().any())
    world.composition.push_back(describe_crumbs(body));
  if (const std::string said = describe_pieces(body, embedding.n_components - embedding.n_lost_components);
      !said.empty())
    world.composition.push_back(said);
  return body;
}

} // namespace kerf::scene
