#include "scene/observables.h"

#include "dynamics/forces.h"
#include "geometry/box_tree.h"
#include "grid/in_use.h"
#include "grid/opening.h"
#include "grid/shape.h"
#include "physics/phyxels.h"
#include "scene/soundness.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf::scene {

namespace {

const dynamics::ForceModel& model(const Body& body) { return body.physics->model(); }

double mass(const Body& body) {
  double sum = 0;
  for (const double m : model(body).lumped_mass())
    sum += m;
  return sum + body.physics->crumbs().mass();
}

/// A number that accounts book in the state; 0 before the first step.
double booked(const Body& body, const std::string& name) {
  const auto it = body.state.numbers.find(name);
  return it == body.state.numbers.end() ? 0 : it->second;
}

double energy_missing(const Body& body) {
  if (!body.accounts)
    return 0;
  return body.accounts->start_energy() + body.accounts->work_of_cut() + booked(body, "work of supports [J]") +
         booked(body, "work of loads [J]") - booked(body, "dissipated energy [J]") -
         total_energy(*body.physics, body.loads, body.state);
}

double largest_displacement(const Body& body) {
  const Points& x = positions(body);
  double largest = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    largest = std::max(largest, (x[i] - body.surface.rest[i]).norm());
  return largest;
}

double rest_volume(const Body& body) { return surface::enclosed_volume(body.surface.rest, body.surface.triangles); }

double count(const std::size_t n) { return static_cast<double>(n); }

constexpr std::array axes = {"x", "y", "z"};

/// Three series of one vector.
template <class Value>
void add_vector(std::vector<Observable>& series, const std::string& name, const std::string& unit,
                const std::string& source, const Value& value) {
  for (int axis = 0; axis < 3; ++axis)
    series.push_back(
      {name + " " + axes[axis], unit, source, [value, axis](const Body& body) { return Vec3(value(body))[axis]; }});
}

Vec3 reaction(const Body& body, const std::size_t support) {
  if (!body.accounts || support >= body.accounts->reactions().size())
    return Vec3::Zero();
  return body.accounts->reactions()[support].force;
}

std::vector<Observable> reactions(const Body& body, const ToolNames&) {
  std::vector<Observable> series;
  for (std::size_t i = 0; i < body.regions.size(); ++i)
    add_vector(series, "reaction " + body.regions[i].name, "N", "force of the support on the body (quantities.h)",
               [i](const Body& b) { return reaction(b, i); });
  return series;
}

std::vector<Observable> tool_forces(const Body&, const ToolNames& tools) {
  std::vector<Observable> series;
  for (const std::string& name : tools.forceps)
    add_vector(series, "tool force " + name, "N", "force of the forceps on the body, 0 while they hold nothing of it",
               [name](const Body& b) {
                 const auto it = std::find(b.grips.begin(), b.grips.end(), name);
                 const auto i = static_cast<std::size_t>(it - b.grips.begin());
                 return it == b.grips.end() ? Vec3(Vec3::Zero()) : reaction(b, b.regions.size() + i);
               });
  return series;
}

std::vector<Observable> load_forces(const Body& body, const ToolNames&) {
  std::vector<Observable> series;
  for (std::size_t i = 0; i < body.load_makers.size(); ++i)
    add_vector(series, "force of " + body.load_makers[i].name, "N", "sum of the load's forces on the body",
               [i](const Body& b) {
                 Vec3 sum = Vec3::Zero();
                 for (std::size_t k = b.first_load[i]; k < b.first_load[i + 1]; ++k)
                   sum += dynamics::load_force(*b.loads.acting[k], b.state);
                 return sum;
               });
  return series;
}

Vec3 cube_coordinates(const Body& body, const Probe& probe) {
  const grid::CellId cell = body.solid.complex.copies[probe.copy].cell;
  return (probe.rest - body.solid.grid.position(body.solid.grid.nodes(cell)[0])) / body.solid.grid.h();
}

Vec3 displacement(const Body& body, const Probe& probe) {
  const Vec3 xi = cube_coordinates(body, probe);
  Vec3 x = Vec3::Zero();
  for (int v = 0; v < 8; ++v)
    x += grid::shape(v, xi) * corners(body)[body.solid.complex.copies[probe.copy].corners[v].value];
  return x - probe.rest;
}

/// Green's strain of the trilinear motion of the probe's copy.
Mat3 strain(const Body& body, const Probe& probe) {
  const Vec3 xi = cube_coordinates(body, probe);
  Mat3 F = Mat3::Zero();
  for (int v = 0; v < 8; ++v)
    F += corners(body)[body.solid.complex.copies[probe.copy].corners[v].value] *
         (grid::shape_gradient(v, xi) / body.solid.grid.h()).transpose();
  return 0.5 * (F.transpose() * F - Mat3::Identity());
}

std::vector<Observable> probes(const Body& body, const ToolNames&) {
  std::vector<Observable> series;
  for (std::size_t i = 0; i < body.probes.size(); ++i)
    add_vector(series, "probe " + body.probes[i].name, "m", "displacement of the rest point, by its copy's corners",
               [i](const Body& b) { return displacement(b, b.probes[i]); });
  return series;
}

std::vector<Observable> probe_strains(const Body& body, const ToolNames&) {
  constexpr std::array<std::array<int, 2>, 6> components = {{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}}};
  std::vector<Observable> series;
  for (std::size_t i = 0; i < body.probes.size(); ++i)
    for (const auto& [row, column] : components)
      series.push_back(
        {"strain " + body.probes[i].name + " " + axes[row] + axes[column], "1",
         "Green's strain at the rest point, by its copy's corners",
         [i, row = row, column = column](const Body& b) { return strain(b, b.probes[i])(row, column); }});
  return series;
}

/// A series for each cut of a scene.
template <class Value>
std::vector<Observable> of_cuts(const ToolNames& tools, const std::string& what, const std::string& unit,
                                const std::string& source, const Value& value) {
  std::vector<Observable> series;
  for (std::size_t i = 0; i < tools.cuts.size(); ++i)
    series.push_back({what + " " + tools.cuts[i], unit, source,
                      [=](const Body& body) { return value(body, static_cast<grid::CutLabel>(i + 1)); }});
  return series;
}

/// Half the rest area of the faces that a cut has revealed.
double cut_area(const Body& body, const grid::CutLabel label) {
  double sum = 0;
  const auto& [rest, triangles, labels, copies, weights] = body.surface;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (labels[t] == label) {
      const auto [a, b, c] = triangles[t];
      sum += 0.25 * (rest[b] - rest[a]).cross(rest[c] - rest[a]).norm();
    }
  return sum;
}

/// The box around them, at rest.
Vec3 cut_extent(const Body& body, const grid::CutLabel label) {
  Points points;
  for (std::size_t t = 0; t < body.surface.triangles.size(); ++t)
    if (body.surface.labels[t] == label)
      for (const auto v : body.surface.triangles[t])
        points.push_back(body.surface.rest[v]);
  if (points.empty())
    return Vec3::Zero();
  const Box box = geometry::box_around(points);
  return box.upper - box.lower;
}

double largest_opening(const Body& body, const grid::CutLabel label) {
  double largest = 0;
  for (const grid::Gap& gap : grid::gaps(body.solid, label, corners(body)))
    largest = std::max(largest, gap.way.norm());
  return largest;
}

std::vector<Observable> cut_areas(const Body&, const ToolNames& tools) {
  return of_cuts(tools, "cut area", "m^2", "half the rest area of the faces that the cut has revealed", cut_area);
}

std::vector<Observable> cut_extents(const Body&, const ToolNames& tools) {
  std::vector<Observable> series;
  for (std::size_t i = 0; i < tools.cuts.size(); ++i)
    add_vector(series, "cut extent " + tools.cuts[i], "m", "sides of the box around the revealed faces, at rest",
               [i](const Body& b) { return cut_extent(b, static_cast<grid::CutLabel>(i + 1)); });
  return series;
}

std::vector<Observable> cut_openings(const Body&, const ToolNames& tools) {
  return of_cuts(tools, "cut opening", "m", "largest way between the two sides of a cut edge (grid/opening.h)",
                 largest_opening);
}

std::vector<Observable> cut_volumes(const Body&, const ToolNames& tools) {
  return of_cuts(tools, "cut volume", "m^3", "between the two sides of the cut edges (grid/opening.h)",
                 [](const Body& body, const grid::CutLabel label) {
                   return grid::opened_volume(grid::gaps(body.solid, label, corners(body)));
                 });
}

std::vector<Observable> energy_release_rates(const Body& body, const ToolNames&) {
  std::vector<Observable> series;
  for (std::size_t i = 0; i < body.fronts.size(); ++i)
    series.push_back({"energy release rate " + body.fronts[i].name, "J/m^2",
                      "domain integral around the front (fem/energy_release.h)",
                      [i](const Body& b) { return energy_release_rate(b, b.fronts[i]); }});
  return series;
}

std::vector<Observable> stress_intensities(const Body& body, const ToolNames&) {
  std::vector<Observable> series;
  for (std::size_t i = 0; i < body.fronts.size(); ++i)
    series.push_back({"stress intensity " + body.fronts[i].name, "Pa m^(1/2)",
                      "sqrt(G E / (1 - nu^2)) of the energy release rate G",
                      [i](const Body& b) { return stress_intensity(b, b.fronts[i]); }});
  return series;
}

std::vector<Observable> frequencies(const Body& body, const ToolNames&) {
  std::vector<Observable> series;
  for (std::size_t i = 0; i < static_cast<std::size_t>(body.n_modes); ++i)
    series.push_back({"frequency " + std::to_string(i + 1), "Hz",
                      "of the mode, by ascending frequency (dynamics/modal.h)", [i](const Body& b) {
                        const auto& found = b.report.modes.frequencies;
                        return i < found.size() ? found[i] : 0.0;
                      }});
  return series;
}

Vec3 momentum(const Body& body) {
  return dynamics::momentum(model(body), body.state) + body.physics->crumbs().momentum(body.state);
}
Vec3 angular_momentum(const Body& body) {
  return dynamics::angular_momentum(model(body), body.state, Vec3::Zero()) +
         body.physics->crumbs().angular_momentum(body.state, Vec3::Zero());
}

} // namespace

const std::vector<Observable>& body_observables() {
  static const std::vector<Observable> all = {
    {"kinetic energy", "J", "sum of m v.v / 2 over the particles, lumped mass; of crumbs as rigid bodies",
     [](const Body& b) { return kinetic_energy(*b.physics, b.state); }},
    {"elastic energy", "J", "of the force model at the current positions",
     [](const Body& b) { return model(b).energy(b.state.x); }},
    {"gravity energy", "J", "-sum of m g.x over the particles, and over crumbs",
     [](const Body& b) { return gravity_energy(*b.physics, b.loads, b.state); }},
    {"energy of loads", "J", "of the loads that have a potential",
     [](const Body& b) { return dynamics::load_energy(b.loads, b.state.time, b.state.x); }},
    {"dissipated energy", "J", "by damping and friction, so far",
     [](const Body& b) { return booked(b, "dissipated energy [J]"); }},
    {"work of supports", "J", "of the reactions, those of forceps too, so far",
     [](const Body& b) { return booked(b, "work of supports [J]"); }},
    {"work of loads", "J", "of loads without a potential, and of potentials that change with time, so far",
     [](const Body& b) { return booked(b, "work of loads [J]"); }},
    {"work of the cut", "J", "what the energies changed by at the instants of cutting, so far",
     [](const Body& b) { return b.accounts ? b.accounts->work_of_cut() : 0.0; }},
    {"missing energy", "J",
     "energy at the start and all work since, less what was dissipated and what is there: what the integrator lost; in "
     "statics what a growing cut released, and what a load did that was put on within one step (accounts.h)",
     energy_missing},
    {"momentum x", "kg m/s", "sum of m v over the particles", [](const Body& b) { return momentum(b)[0]; }},
    {"momentum y", "kg m/s", "sum of m v over the particles", [](const Body& b) { return momentum(b)[1]; }},
    {"momentum z", "kg m/s", "sum of m v over the particles", [](const Body& b) { return momentum(b)[2]; }},
    {"angular momentum x", "kg m^2/s", "sum of x x m v over the particles, about the origin",
     [](const Body& b) { return angular_momentum(b)[0]; }},
    {"angular momentum y", "kg m^2/s", "sum of x x m v over the particles, about the origin",
     [](const Body& b) { return angular_momentum(b)[1]; }},
    {"angular momentum z", "kg m^2/s", "sum of x x m v over the particles, about the origin",
     [](const Body& b) { return angular_momentum(b)[2]; }},
    {"mass", "kg", "sum of the lumped mass", mass},
    {"volume", "m^3", "enclosed by the surface now, divergence theorem over its triangles",
     [](const Body& b) { return surface::enclosed_volume(positions(b), b.surface.triangles); }},
    {"rest volume", "m^3", "enclosed by the surface at rest", rest_volume},
    {"rest volume change", "m^3",
     "rest volume now less that before any cut: what placing cut vertices on a curved "
     "skin gained or lost",
     [](const Body& b) { return rest_volume(b) - b.first_volume; }},
    {"largest displacement", "m", "of a surface vertex from its rest position", largest_displacement},
    {"largest stretch", "1", "longest edge of a copy's cube over that at rest",
     [](const Body& b) { return largest_stretch(b).factor; }},
    {"pieces", "1", "connected components of the copies",
     [](const Body& b) { return count(b.pieces.n_pieces); }},
    {"crumbs", "1", "pieces too small for the grid to deform, which move as rigid bodies (grid/crumbs.h)",
     [](const Body& b) { return count(b.physics->crumbs().size()); }},
    {"copies", "1", "cells, once per connected component",
     [](const Body& b) { return count(grid::n_copies_in_use(b.solid.complex)); }},
    {"surface triangles", "1", "of the closed surface",
     [](const Body& b) { return count(b.surface.triangles.size()); }},
    {"cut edges", "1", "grid edges cut by blades and cut surfaces",
     [](const Body& b) {
       std::size_t n = 0;
       if (b.cutter)
         for (const std::size_t m : b.cutter->counts().n_cut_edges)
           n += m;
       return count(n);
     }},
    {"waiting cuts", "1", "cut edges that wait: at most two edges of a cell are cut in a step (thesis §2.4.3)",
     [](const Body& b) { return b.cutter ? count(b.cutter->n_waiting()) : 0.0; }},
    {"double crossings", "1", "grid edges that one sweep or cut surface crossed an even number of times, left uncut",
     [](const Body& b) { return b.cutter ? count(b.cutter->counts().n_double_crossings) : 0.0; }},
    {"thin walls", "1", "grid edges through walls of the mesh between two empty nodes, which are lost",
     [](const Body& b) { return count(b.n_thin_walls); }},
    {"thin gaps", "1", "grid edges through gaps of the mesh between two material nodes, which are filled",
     [](const Body& b) { return count(b.n_thin_gaps); }},
    {"left whole", "1",
     "grid edges and segments of the skin that were crossed and left uncut: behind them are shavings of one blade with "
     "less material than a cube, or no material (cut/shreds.h)",
     [](const Body& b) { return count(b.solid.cuts.n_left_whole()); }},
    {"material between cuts", "m^3",
     "an estimate of what a neighbour has of what it belongs to, as it lies between two cuts of the same grid edges, "
     "of which each is cut once (cut/cutter.h)",
     [](const Body& b) {
       double cells = 0;
       if (b.cutter)
         for (const double of_label : b.cutter->counts().between)
           cells += of_label;
       return cells * std::pow(b.solid.grid.h(), 3);
     }},
    {"drawn bodies", "1",
     "closed parts of the surface: more than pieces where what joins a piece is thinner than the grid resolves",
     [](const Body& b) { return count(surface::n_bodies(b.surface)); }},
    {"cells passed uncut", "1",
     "cells whose material a blade passed through without cutting anything in them, so far (cut/passed.h)",
     [](const Body& b) { return b.cutter ? count(b.cutter->n_passed_cells()) : 0.0; }},
    {"solver iterations", "1", "of the linear solver in the step",
     [](const Body& b) { return count(b.report.n_iterations); }},
    {"Newton iterations", "1", "in the step", [](const Body& b) { return count(b.report.n_newton); }},
    {"substeps", "1", "kept, of an adaptive or quasi-static step, or of one that had to be divided",
     [](const Body& b) { return count(b.report.n_substeps); }},
    {"rejected steps", "1", "tried and thrown away in the step: substeps, load steps, or steps that gained energy",
     [](const Body& b) { return count(b.report.n_rejected); }},
    {"energy gained", "J", "that no load and no support gave, by the steps so far (dynamics/sound_steps.h)",
     [](const Body& b) { return booked(b, "energy gained [J]"); }},
    {"residual", "1",
     "forces out of balance over those that balance at the end of the step, where it was measured: each over the "
     "stiffness of its corner, so that what stands at stiff supports counts less",
     [](const Body& b) { return b.report.residual; }},
    {"stable step", "s",
     "longest time step that the explicit integrator bears, as of the first step after the start or a cut, or up to 200 "
     "steps before where steps are shorter than .75 of it; 0 where it was not computed",
     [](const Body& b) { return b.report.stable_step; }},
    {"waiting pairs", "1", "of phyxels or corners that wait for a look at a new cut (backend pba)",
     [](const Body& b) {
       const auto* phyxels = dynamic_cast<const physics::Phyxels*>(b.physics.get());
       return phyxels ? count(phyxels->n_waiting()) : 0.0;
     }},
    {"clamped vertices", "1", "placements that were held at the side of their face or cell",
     [](const Body& b) { return count(b.placed.n_clamped); }},
    {"folded cells", "1", "cells in which a cut left some part with less than nothing, counted at each cut in them",
     [](const Body& b) { return count(b.placed.n_folded); }},
  };
  return all;
}

const Observable* find_observable(const std::string& name) {
  for (const Observable& observable : body_observables())
    if (observable.name == name)
      return &observable;
  return nullptr;
}

const std::vector<ObservableGroup>& observable_groups() {
  static const std::vector<ObservableGroup> all = {
    {"reactions", "N", "force of each support on the body, x, y, z", reactions},
    {"tool forces", "N", "force of each forceps on the body, x, y, z", tool_forces},
    {"load forces", "N", "force of each load, each floor and each support that holds at the skin, x, y, z",
     load_forces},
    {"probes", "m", "displacement of each probe, x, y, z", probes},
    {"cut areas", "m^2", "half the rest area of the faces that each blade or cut surface has revealed", cut_areas},
    {"cut extents", "m", "sides of the box around those faces, at rest, x, y, z: how far each cut has come",
     cut_extents},
    {"cut openings", "m", "largest way between the two sides of each cut", cut_openings},
    {"cut volumes", "m^3", "volume between the two sides of each cut, first order in the cube's edge", cut_volumes},
    {"energy release rates", "J/m^2",
     "energy that each crack front would release by growing, per area, in statics (fem/energy_release.h)",
     energy_release_rates},
    {"stress intensities", "Pa m^(1/2)",
     "sqrt(G E / (1 - nu^2)) of each crack front: K of a crack that opens in plane strain", stress_intensities},
    {"frequencies", "Hz", "of the lowest modes, one each, with the integrator modal; 0 before the first step",
     frequencies},
    {"probe strains", "1", "Green's strain at each probe, six components", probe_strains},
  };
  return all;
}

std::string observable_names() {
  std::string names;
  for (const Observable& observable : body_observables())
    names += (names.empty() ? "" : ", ") + observable.name;
  for (const ObservableGroup& group : observable_groups())
    names += ", " + group.name;
  return names;
}

std::vector<Observable> observables_named(const std::string& name, const Body& body, const ToolNames& tools) {
  if (const Observable* one = find_observable(name))
    return {*one};
  for (const ObservableGroup& group : observable_groups())
    if (group.name == name)
      return group.of(body, tools);
  return {};
}

bool needs_accounts(const std::string& name) {
  static const std::array names = {"dissipated energy", "work of supports", "work of loads", "work of the cut",
                                   "missing energy",    "reactions",        "tool forces"};
  return std::find(names.begin(), names.end(), name) != names.end();
}

} // namespace kerf::scene
