#include "scene/body.h"

#include "cut/fit.h"
#include "dynamics/forces.h"
#include "grid/locate.h"
#include "scene/held.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace kerf::scene {

namespace {

/// The corners that a support held before a cut, or that come from such ones [ascending].
std::vector<std::uint32_t> held_before(const dynamics::Support& support, const grid::CutChange& change) {
  std::vector<std::uint8_t> is_held(change.n_corners_before, 0);
  for (const auto i : support.corners)
    is_held[i] = 1;
  grid::inherit(change, is_held);
  for (const grid::Lapse& lapse : change.lapsed)
    is_held[lapse.heir.value] |= is_held[lapse.corner.value];
  std::vector<std::uint32_t> held;
  for (std::uint32_t i = 0; i < is_held.size(); ++i)
    if (is_held[i] != 0)
      held.push_back(i);
  return held;
}

/// Of corners that a support held before a cut, or that come from such ones, those that it holds now. Only those at
/// nodes of copies that the cut has reshaped are asked.
std::vector<std::uint32_t> still_held(const Body& body, const Region& region, const dynamics::Support& before,
                                      const grid::CutChange& change) {
  const grid::CellComplex& complex = body.solid.complex;
  Table<grid::NodeId, std::uint8_t> is_met(body.solid.grid.n_nodes(), 0);
  for (const grid::CopyId c : change.reshaped)
    for (const grid::CornerId corner : complex.copies[c].corners)
      is_met[complex.node[corner]] = 1;
  std::vector<std::uint32_t> held, asked;
  for (const auto i : held_before(before, change))
    (is_met[complex.node[grid::CornerId(i)]] != 0 ? asked : held).push_back(i);
  const auto middle = static_cast<std::ptrdiff_t>(held.size());
  std::ranges::copy(particles_in(body, region, std::move(asked)), std::back_inserter(held));
  std::inplace_merge(held.begin(), held.begin() + middle, held.end());
  return held;
}

/// A cut gives supports nothing that they did not hold: it shapes material anew, by less than a cube, and a piece that
/// moved on long ago may have some in a region then.
void find_supports(Body& body, const grid::CutChange* const change) {
  const std::vector<dynamics::Support> before = std::exchange(body.loads.supports, {});
  const Points& rest = body.physics->rest();
  for (std::size_t r = 0; r < body.regions.size(); ++r) {
    const SupportRegion& region = body.regions[r];
    dynamics::Support support{{}, {}, region.displacement, region.rotation, region.held};
    support.corners = change && body.physics->particles_are_corners()
                        ? still_held(body, region.region, before[r], *change)
                        : particles_in(body, region.region);
    for (const auto i : support.corners)
      support.rest.push_back(rest[i]);
    body.loads.supports.push_back(std::move(support));
  }
  body.grips.clear();
}

/// Takes a cut into placement, surface, physics and loads.
void follow_cut(Body& body, grid::CutChange change, Timings& timings) {
  if (!change.any())
    return;
  {
    const ScopedTimer timer(timings, "topology");
    body.placed += surface::place(body.solid, change, body.placement);
    surface::update_surface(body.solid, change, body.surface, body.surface_index);
    grid::update_pieces(body.solid, change, body.pieces);
    grid::update_crumbs(body.solid, change, body.physics->particles_are_corners() ? nullptr : &body.physics->rest());
    ++body.n_recuts;
  }
  const ScopedTimer timer(timings, "assemble");
  const physics::EnergyBefore had{body.physics->model().energy(body.state.x),
                                  dynamics::load_energy(body.loads, body.state.time, body.state.x)};
  body.physics->follow_cut(seen(body), change, body.state);
  make_loads(body, &change);
  body.physics->let_out(seen(body), change, had, body.loads, body.state);
  follow(body);
}

/// Cuts, and lets all of the body follow.
template <class Cut>
void cut_and_follow(Body& body, Timings& timings, const Cut& cut) {
  grid::CutChange change = [&] {
    const ScopedTimer timer(timings, "cut");
    return cut();
  }();
  follow_cut(body, std::move(change), timings);
}

} // namespace

const Points& positions(const Body& body) {
  if (std::exchange(body.has_moved, false))
    surface::follow(body.surface, corners(body), body.positions_);
  return body.positions_;
}

void make_loads(Body& body, const grid::CutChange* const change) {
  find_supports(body, change);
  body.loads.acting.clear();
  body.loads.carried = body.physics->crumbs().carried();
  body.first_load = {0};
  for (const LoadMaker& maker : body.load_makers) {
    maker.make(body, body.loads.acting);
    body.first_load.push_back(body.loads.acting.size());
  }
  find_probes(body);
}

void find_probes(Body& body) {
  for (Probe& probe : body.probes)
    probe.copy = grid::copy_at(body.solid, probe.rest);
}

void archive(Archive& a, Body& body) {
  a.name(body.name);
  a(body.solid, body.placed, body.surface, body.surface_index, body.n_recuts);
  if (body.cutter)
    a(*body.cutter);
  if (a.reads())
    body.pieces = grid::pieces(body.solid.complex);
  body.physics->archive(a, seen(body));
  a(body.state, body.report, body.n_divided);
  if (body.initial)
    a(body.initial->energy);
  if (body.accounts)
    a(*body.accounts);
  if (body.interior)
    a(body.interior->atlas);
  if (a.reads())
    make_loads(body);
  for (std::size_t r = 0; r < body.regions.size(); ++r)
    a(body.loads.supports[r].corners, body.loads.supports[r].rest);
  if (a.reads())
    follow(body);
}

void start(Body& body, const geometry::TriangleMesh& mesh, const PhysicsMaker& make_physics, Timings& timings) {
  {
    const ScopedTimer timer(timings, "topology");
    grid::Solid& solid = body.solid;
    body.placed = surface::place(solid, body.placement);
    cut::fit_skin(mesh, solid);
    solid.complex = grid::build_complex(solid);
    grid::find_crumbs(solid);
    body.pieces = grid::pieces(solid.complex);
    body.surface = body.cutter ? surface::build_surface(solid, body.surface_index) : surface::build_surface(solid);
  }
  body.first_volume = surface::enclosed_volume(body.surface.rest, body.surface.triangles);
  {
    const ScopedTimer timer(timings, "assemble");
    body.physics = make_physics(seen(body));
    body.state = physics::state_at_rest(*body.physics);
    make_loads(body);
  }
  follow(body);
  if (body.cutter)
    body.cutter->begin(body.solid, corners(body));
}

void recut(Body& body, const std::span<const cut::Blade> blades, const double t0, const double t1, Timings& timings) {
  cut_and_follow(body, timings, [&] { return body.cutter->step(body.solid, blades, t0, t1, corners(body)); });
}

void cut_at_once(Body& body, const cut::CutSurface& surface, Timings& timings) {
  cut_and_follow(body, timings, [&] { return body.cutter->at_once(body.solid, surface, corners(body)); });
}

void follow(Body& body) {
  body.physics->follow(body.state);
  body.has_moved = true;
}

} // namespace kerf::scene
