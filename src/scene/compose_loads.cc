#include "scene/compose_loads.h"

#include "base/union_find.h"
#include "dynamics/floor.h"
#include "dynamics/handle.h"
#include "dynamics/newton_parameters.h"
#include "dynamics/rigid_modes.h"
#include "dynamics/skin_support.h"
#include "dynamics/sound_steps.h"
#include "dynamics/surface_load.h"
#include "geometry/box_tree.h"
#include "grid/material.h"
#include "grid/shape.h"
#include "material/elastic.h"
#include "scene/expression.h"
#include "scene/grammar_body.h"
#include "scene/grammar_physics.h"
#include "scene/support_report.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <ranges>
#include <set>

namespace kerf::scene {

namespace {

using LoadList = std::vector<std::unique_ptr<dynamics::Load>>;

/// Rotation vectors [degrees] as matrices.
std::function<Mat3(double)> rotation_of_time(const Section& section, const std::string& expressions) {
  const auto vector = vector_of_time(section, "Rotation [degrees]", expressions);
  return [vector](const double t) -> Mat3 {
    const Vec3 w = vector(t) * (std::acos(-1.0) / 180);
    const double angle = w.norm();
    return angle == 0 ? Mat3(Mat3::Identity()) : Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
  };
}

SupportRegion compose_support(const Section& section) {
  const auto parameters = section.read<SupportParameters>();
  SupportRegion support{.name = section.name(), .region = read_region(section, parameters.region), .displacement = {}};
  const auto displacement = vector_of_time(section, "Displacement [m]", parameters.displacement);
  support.displacement = displacement;
  if (section.writes("Rotation [degrees]")) {
    const auto rotation = rotation_of_time(section, parameters.rotation);
    const Vec3 pivot = parameters.pivot;
    support.rotation = rotation;
    support.displacement = [=](const double t) { return Vec3(displacement(t) + pivot - rotation(t) * pivot); };
  }
  const bool has_direction = !parameters.direction.isZero(0);
  if (has_direction && section.writes("Hold"))
    throw section.complaint("Held direction [1]", "cannot stand beside the key Hold", "Remove one of the two");
  support.held = has_direction ? dynamics::held_along(parameters.direction) : dynamics::held_axes(parameters.hold);
  return support;
}

std::vector<double> volumes(const Body& body) {
  std::vector<double> volumes;
  for (const double m : body.physics->model().lumped_mass())
    volumes.push_back(m / body.density);
  const std::vector<double>& of_crumbs = body.physics->crumbs().carried_mass();
  for (std::size_t i = 0; i < of_crumbs.size(); ++i)
    volumes[i] += of_crumbs[i] / body.density;
  return volumes;
}

/// Calls f(triangle) for those of the faces ("skin", "revealed", "all") whose rest centres are in a region.
template <class Function>
void for_each_triangle(const Body& body, const std::string& faces, const Region& region, const Function& f) {
  const surface::Surface& surface = body.surface;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const bool is_skin = surface.labels[t] == 0;
    if ((faces == "skin" && !is_skin) || (faces == "revealed" && is_skin))
      continue;
    const auto& [a, b, c] = surface.triangles[t];
    if (contains(region, (surface.rest[a] + surface.rest[b] + surface.rest[c]) / 3))
      f(t);
  }
}

dynamics::SurfacePatch patch_of(const Body& body, const std::string& faces, const Region& region) {
  dynamics::SurfacePatch patch{body.physics->carry(body.surface.weights), body.surface.rest, {}};
  for_each_triangle(body, faces, region,
                    [&](const std::size_t t) { patch.triangles.push_back(body.surface.triangles[t]); });
  return patch;
}

/// The copies that carry these triangles.
dynamics::TriangleCarriers carriers_of(const Body& body, const std::span<const std::size_t> triangles) {
  const grid::Grid& grid = body.solid.grid;
  const grid::CellComplex& complex = body.solid.complex;
  constexpr std::uint32_t none = 0xffffffff;
  dynamics::TriangleCarriers carriers;
  Interpolation corners;
  std::vector<std::uint32_t> number(complex.n_corners(), none); // among those that carry
  for (const std::size_t triangle : triangles) {
    const grid::Copy& copy = complex.copies[body.surface.copies[triangle]];
    const Vec3 lower = grid.position(grid.nodes(copy.cell)[0]);
    auto& of_triangle = carriers.of_triangle.emplace_back();
    for (int v = 0; v < 8; ++v) {
      const std::uint32_t corner = copy.corners[v].value;
      if (number[corner] == none) {
        number[corner] = static_cast<std::uint32_t>(corners.n_points());
        corners.add_entry(corner, 1);
        corners.end_row();
      }
      of_triangle[v] = number[corner];
    }
    const auto& [a, b, c] = body.surface.triangles[triangle];
    const Points& rest = body.surface.rest;
    auto& shapes = carriers.shape_at_nodes.emplace_back();
    for (int i = 0; i < dynamics::n_triangle_nodes; ++i) {
      const Vec3 L = dynamics::triangle_node(i),
                 xi = (L[0] * rest[a] + L[1] * rest[b] + L[2] * rest[c] - lower) / grid.h();
      for (int v = 0; v < 8; ++v)
        shapes(i, v) = grid::shape(v, xi);
    }
  }
  carriers.corners = body.physics->bear(seen(body), corners);
  return carriers;
}

/// The names of crumbs of less material than a copy that holds its corners by itself. Ascending.
std::vector<std::uint32_t> names_of_dust(const grid::Solid& solid) {
  std::vector<std::uint32_t> names;
  for (const grid::Crumb& crumb : solid.crumbs.all) {
    double cubes = 0;
    for (const grid::CopyId copy : crumb.copies)
      cubes += grid::fill(solid, solid.complex.copies[copy]);
    if (cubes < grid::well_filled)
      names.push_back(crumb.name);
  }
  return names;
}

/// Dust gets nothing of what acts on surfaces: it would fly and spin faster than steps resolve.
dynamics::SurfacePatch carried_patch_of(const Body& body, const dynamics::PatchParameters& parameters) {
  dynamics::SurfacePatch patch{body.physics->bear(seen(body), body.surface.weights), body.surface.rest, {}};
  const std::vector<std::uint32_t> dust = names_of_dust(body.solid);
  std::vector<std::size_t> triangles;
  for_each_triangle(body, parameters.faces, Box{parameters.lower, parameters.upper}, [&](const std::size_t t) {
    if (std::ranges::binary_search(dust, body.solid.crumbs.of(body.surface.copies[t])))
      return;
    triangles.push_back(t);
    patch.triangles.push_back(body.surface.triangles[t]);
  });
  patch.carriers = carriers_of(body, triangles);
  return patch;
}

bool holds_skin(const Section& support) { return support.read<SupportParameters>().hold_at == "skin"; }

/// A support that holds the skin: a load, as stiff as the key and the material say, [N/m^3].
void compose_skin_support(const Section& section, const Section& body_section, Body& body) {
  if (body_section.read<BodyParameters>().backend == "lattice")
    throw section.complaint("Hold at", "lattice shape matching takes loads explicitly, and the skin's are too stiff",
                            "Write 'set Hold at = corners', or choose another backend");
  const double stiffness = section.read<SupportParameters>().skin_stiffness *
                           read_if_written<material::Elastic>(body_section, "Material").youngs_modulus /
                           body.solid.grid.h();
  const SupportRegion support = compose_support(section);
  body.load_makers.push_back({support.name, [=](const Body& b, LoadList& loads) {
                                loads.push_back(std::make_unique<dynamics::SkinSupport>(
                                  patch_of(b, "skin", support.region), stiffness,
                                  dynamics::Support{{}, {}, support.displacement, support.rotation, support.held}));
                              }});
}

void compose_support(const Section& section, const Section& body_section, Body& body) {
  if (holds_skin(section))
    return compose_skin_support(section, body_section, body);
  if (section.writes("Skin stiffness [1]"))
    throw section.complaint("Skin stiffness [1]", "is of supports that hold at the skin, this one holds corners",
                            "Write 'set Hold at = skin', or remove the key");
  body.regions.push_back(compose_support(section));
}

/// Vertices of the surface, each with a third of the rest area of its triangles.
dynamics::ContactPoints contact_points(const Body& body) {
  const surface::Surface& surface = body.surface;
  dynamics::ContactPoints contact{body.physics->carry(surface.weights), std::vector<double>(surface.rest.size(), 0.0)};
  for (const auto& triangle : surface.triangles) {
    const auto& [a, b, c] = triangle;
    const double area = 0.5 * (surface.rest[b] - surface.rest[a]).cross(surface.rest[c] - surface.rest[a]).norm();
    for (const auto vertex : triangle)
      contact.areas[vertex] += area / 3;
  }
  return contact;
}

void compose_body_force(const Section& section, Body& body) {
  const auto parameters = section.read<dynamics::BodyForceParameters>();
  const auto density = vector_of_place(section, "Force density [N/m^3]", parameters.density);
  body.load_makers.push_back({section.name(), [=](const Body& b, LoadList& loads) {
                                loads.push_back(
                                  std::make_unique<dynamics::BodyForce>(volumes(b), b.physics->rest(), density));
                              }});
}

void compose_traction(const Section& section, Body& body) {
  const auto parameters = section.read<dynamics::TractionParameters>();
  const auto traction = vector_of_place(section, "Traction [N/m^2]", parameters.traction);
  body.load_makers.push_back({section.name(), [=](const Body& b, LoadList& loads) {
                                loads.push_back(std::make_unique<dynamics::Traction>(
                                  carried_patch_of(b, parameters.patch), traction));
                              }});
}

void compose_pressure(const Section& section, Body& body) {
  const auto parameters = section.read<dynamics::PressureParameters>();
  const auto pressure = number_of_place(section, "Pressure [Pa]", parameters.pressure);
  body.load_makers.push_back({section.name(), [=](const Body& b, LoadList& loads) {
                                loads.push_back(std::make_unique<dynamics::Pressure>(
                                  carried_patch_of(b, parameters.patch), pressure));
                              }});
}

ParameterError no_material(const Section& section) {
  return section.complaint("Point [m]", "the body has no material there at rest",
                           "Choose a point inside the body: rest configuration, in metres");
}

void compose_handle(const Section& section, Body& body) {
  const auto parameters = section.read<dynamics::HandleParameters>();
  const auto displacement = vector_of_time(section, "Displacement [m]", parameters.displacement);
  const auto path = [=](const double t) { return Vec3(parameters.point + displacement(t)); };
  const ParameterError missing = no_material(section);
  body.load_makers.push_back(
    {section.name(), [=](const Body& b, LoadList& loads) {
       const auto point = physics::body_point(seen(b), parameters.point);
       if (point.n_points() == 0)
         throw missing;
       const auto carried = b.physics->carry(point);
       loads.push_back(std::make_unique<dynamics::HandleSpring>(carried, parameters.stiffness, path));
       if (parameters.damping > 0)
         loads.push_back(std::make_unique<dynamics::HandleDamper>(carried, parameters.damping, path));
     }});
}

void compose_floor(const Section& section, Body& body) {
  const auto parameters = section.read<dynamics::FloorParameters>();
  if (parameters.normal.isZero(0))
    throw section.complaint("Normal [1]", "must not be zero", "Write the direction away from the floor");
  body.load_makers.push_back({section.name(), [=](const Body& b, LoadList& loads) {
                                auto floor = std::make_unique<dynamics::Floor>(contact_points(b), parameters);
                                const dynamics::Floor& touched = *floor;
                                loads.push_back(std::move(floor));
                                if (parameters.friction > 0)
                                  loads.push_back(std::make_unique<dynamics::FloorFriction>(touched));
                              }});
}

/// One linearisation a step starts at rest, where friction is a stiff brake: what should slide would stick.
void require_resolved_friction(const Section& section, const std::vector<const Section*>& floors) {
  constexpr int enough = 3;
  const auto parameters = section.read<BodyParameters>();
  const auto& names = implicit_integrator_names();
  const bool rubs = std::any_of(floors.begin(), floors.end(), [](const Section* floor) {
    return floor->read<dynamics::FloorParameters>().friction > 0;
  });
  if (!rubs || parameters.backend == "lattice" ||
      std::find(names.begin(), names.end(), parameters.integrator) == names.end())
    return;
  std::string kind = parameters.integrator;
  kind[0] = static_cast<char>(std::toupper(kind[0]));
  const auto by_default = kind == "Implicit Euler" ? dynamics::NewtonParameters() : dynamics::converged_newton();
  const Section* const of_kind = section.find(kind);
  if ((of_kind ? of_kind->read<dynamics::NewtonParameters>() : by_default).n_newton >= enough)
    return;
  const std::string key = "Newton iterations [1]", rule = line("friction of a floor needs ", enough, " or more"),
                    set = line("set ", key, " = 6");
  if (of_kind)
    throw of_kind->complaint(key, rule, "Write '" + set + "', or 'set Friction [1] = 0' in the Floor");
  throw section.complaint(key + " of '" + kind + "': " + rule,
                          "Write 'subsection " + kind + "' with '" + set + "', or 'set Friction [1] = 0' in the Floor");
}

/// Skin must be there from the start; what cuts will reveal may not be there yet.
void require_loaded_triangles(const Section& section, const dynamics::PatchParameters& parameters, const Body& body) {
  if (parameters.faces == "revealed") {
    if (!body.cutter)
      throw section.complaint("Faces", "nothing in the scene cuts, so no face is ever revealed",
                              "Add a blade, scissors or a cut surface, or load the skin");
    return;
  }
  try {
    dynamics::require_triangles(carried_patch_of(body, parameters));
  } catch (const ParameterError& error) {
    throw section.complaint(error.complaint().rule, clause(error.complaint().remedy));
  }
}

void require_held_triangles(const Section& section, const Body& body) {
  const auto region = read_region(section, section.read<SupportParameters>().region);
  if (patch_of(body, "skin", region).triangles.empty())
    throw section.complaint("the region holds no triangle of the body's skin by its centre",
                            "Move or enlarge it: it is meant in the rest configuration, in metres");
}

/// "0.04 m^2 of skin from (0, 0, 0) to (0, .2, .2) m, in 1 piece"
std::string describe(const dynamics::SurfacePatch& patch) {
  UnionFind sets(patch.rest.size());
  std::set<std::uint32_t> roots;
  Points points;
  double area = 0;
  for (const auto& [a, b, c] : patch.triangles) {
    sets.unite(a, b);
    sets.unite(b, c);
    area += 0.5 * (patch.rest[b] - patch.rest[a]).cross(patch.rest[c] - patch.rest[a]).norm();
  }
  for (const auto& triangle : patch.triangles)
    for (const auto vertex : triangle) {
      roots.insert(sets.root(vertex));
      points.push_back(patch.rest[vertex]);
    }
  return line(area, " m^2 of skin ", extent(points), ", in ", roots.size(), roots.size() == 1 ? " piece" : " pieces");
}

/// Those behind body.regions, in their order.
std::vector<const Section*> corner_supports(const Section& section) {
  std::vector<const Section*> supports;
  for (const Section* support : section.all("Support"))
    if (!holds_skin(*support))
      supports.push_back(support);
  return supports;
}

void require_no_contradiction(const Section& section, const double time, const Body& body) {
  const double tolerance = 1e-6 * body.solid.grid.h();
  const auto found = dynamics::find_contradiction(body.loads, time, tolerance);
  if (!found)
    return;
  const auto supports = corner_supports(section);
  const Vec3 X = body.physics->rest()[found->corner];
  throw supports[found->second]->complaint(
    line("at ", time, " s it wants a point (at rest at ", X[0], ", ", X[1], ", ", X[2], ") ", found->distance,
         " m away from where 'Support ", supports[found->first]->name(), "' wants it"),
    "Let the regions not overlap, or move alike where they do");
}

} // namespace

void compose_loads(const Section& section, const std::vector<const Section*>& floors, Body& body) {
  require_resolved_friction(section, floors);
  for (const Section* support : section.all("Support"))
    compose_support(*support, section, body);
  for (const Section* load : section.all("Body force"))
    compose_body_force(*load, body);
  for (const Section* load : section.all("Traction"))
    compose_traction(*load, body);
  for (const Section* load : section.all("Pressure"))
    compose_pressure(*load, body);
  for (const Section* load : section.all("Handle"))
    compose_handle(*load, body);
  for (const Section* floor : floors)
    compose_floor(*floor, body);
  for (const Section* probe : section.all("Probe"))
    body.probes.push_back({probe->name(), probe->read<ProbeParameters>().point});
}

std::vector<std::string> warn_of_friction(const Section& section, const std::vector<const Section*>& floors,
                                          const Body& body, const double time_step) {
  const auto parameters = section.read<BodyParameters>();
  std::vector<std::string> lines;
  if (!is_explicit(parameters.integrator) && parameters.backend != "lattice")
    return lines;
  const Points rest = grid::rest_positions(body.solid);
  for (const Section* const floor : floors) {
    const auto of = floor->read<dynamics::FloorParameters>();
    const Vec3 up = of.normal.normalized();
    const auto [lowest, highest] =
      std::ranges::minmax(rest | std::views::transform([&](const Vec3& p) { return up.dot(p); }));
    const double pressed = of.friction * std::max(0.0, -up.dot(body.loads.gravity)) * (highest - lowest) /
                           body.solid.grid.h(), // by what a corner below carries, over its mass [m/s^2]
                 longest = of.creep / pressed;
    if (time_step > longest)
      lines.push_back(line("warning: body ", body.name, ": steps of ", time_step, " s are too long for the friction of ",
                           "floor ", floor->name(), ": what rests there quivers, creeps faster than the 'Creep velocity "
                           "[m/s]', and 'dissipated energy' counts the quivering. Steps of some ",
                           dynamics::in_short(longest), " s or an implicit integrator resolve it"));
  }
  return lines;
}

std::vector<std::string> describe_skin_supports(const Section& section, const Body& body) {
  std::vector<std::string> lines;
  for (const Section* support : section.all("Support"))
    if (holds_skin(*support)) {
      const Region region = read_region(*support, support->read<SupportParameters>().region);
      lines.push_back(
        line("body ", body.name, ": support ", support->name(), " holds ", describe(patch_of(body, "skin", region))));
    }
  return lines;
}

void require_sound_loads(const Section& section, const double end_time, const Body& body) {
  for (const Section* support : section.all("Support"))
    if (holds_skin(*support))
      require_held_triangles(*support, body);
  const auto supports = corner_supports(section);
  for (std::size_t i = 0; i < supports.size(); ++i)
    if (body.loads.supports[i].corners.empty())
      throw supports[i]->complaint("the region holds no corner or phyxel of the body",
                                   "Move or enlarge it: it is meant in the rest configuration, in metres");
  for (const Section* load : section.all("Traction"))
    require_loaded_triangles(*load, load->read<dynamics::TractionParameters>().patch, body);
  for (const Section* load : section.all("Pressure"))
    require_loaded_triangles(*load, load->read<dynamics::PressureParameters>().patch, body);
  const auto probes = section.all("Probe");
  for (std::size_t i = 0; i < probes.size(); ++i)
    if (!body.probes[i].copy.valid())
      throw no_material(*probes[i]);
  for (const double time : {0.0, 0.5 * end_time, end_time})
    require_no_contradiction(section, time, body);
}

void require_static_answer(const Section& section, const Body& body) {
  const auto parameters = read_if_written<QuasiStaticSceneParameters>(section, "Quasi-static");
  if (parameters.free_modes == "allow")
    return;
  const auto pieces =
    body.physics->particles_are_corners() ? grid::corner_pieces(body.solid.complex) : std::vector<std::uint32_t>();
  try {
    dynamics::require_supported(dynamics::free_rigid_modes(body.physics->model(), body.loads, 0, body.state.x, pieces));
  } catch (const ParameterError& error) {
    throw section.complaint("Integrator", error.complaint().rule, clause(error.complaint().remedy));
  }
}

} // namespace kerf::scene
