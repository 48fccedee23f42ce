#include "scene/body.h"

#include "cut/add_cuts.h"
#include "cut/fit.h"
#include "cut/recut.h"

namespace kerf::scene {

namespace {

/// Particles whose rest position lies in a region.
void find_supports(Body& body) {
  body.loads.supports.clear();
  const Points& rest = body.physics->rest();
  for (const SupportRegion& region : body.regions) {
    dynamics::Support support{{}, {}, region.displacement, region.rotation, region.held};
    for (std::uint32_t i = 0; i < rest.size(); ++i)
      if (contains(region.region, rest[i])) {
        support.corners.push_back(i);
        support.rest.push_back(rest[i]);
      }
    body.loads.supports.push_back(std::move(support));
  }
  body.grips.clear();
}

void make_loads(Body& body) {
  find_supports(body);
  body.loads.acting.clear();
  body.first_load = {0};
  for (const LoadMaker& maker : body.load_makers) {
    maker.make(body, body.loads.acting);
    body.first_load.push_back(body.loads.acting.size());
  }
  for (Probe& probe : body.probes)
    probe.copy = physics::copy_at(seen(body), probe.rest);
}

void build_surface(Body& body) {
  body.surface = body.cutting ? surface::build_surface(body.grid, body.cuts, body.complex, body.cutting->surface_index)
                              : surface::build_surface(body.grid, body.cuts, body.complex);
}

/// Adds cuts to the body, and counts them; returns the edges at which something has changed.
std::vector<grid::EdgeId> add_cuts(Body& body, const std::vector<grid::EdgeCut>& cuts, const cut::Front front) {
  const std::size_t n_before = body.cuts.all().size();
  const cut::AddedCuts added = cut::add_cuts(body.grid, body.cuts, body.complex, corners(body), cuts, front);
  body.cutting->n_tips += added.n_tips;
  for (const grid::EdgeCut& cut : body.cuts.all().subspan(n_before)) {
    ++body.cutting->n_cut_edges[cut.label - 1];
    body.cutting->passed[cut.label - 1].remove_around(body.grid, cut.edge);
  }
  return added.edges;
}

/// Returns what has changed, for the physics.
grid::ComplexChange update_topology(Body& body, const std::vector<grid::EdgeId>& edges, Timings& timings) {
  const ScopedTimer timer(timings, "topology");
  const auto placed = surface::place(body.grid, body.cuts, body.placement);
  body.placed.n_placed += placed.n_placed;
  body.placed.n_clamped += placed.n_clamped;
  grid::ComplexChange change = grid::update_complex(body.grid, body.cuts, edges, body.complex);
  grid::inherit(change, body.cutting->x_before);
  surface::update_surface(body.grid, body.cuts, body.complex, edges, change, body.surface, body.cutting->surface_index);
  ++body.n_recuts;
  return change;
}

/// Puts what a blade cuts between two times to what waits, and counts what the grid cannot resolve of it.
void meet(Body& body, const cut::Blade& blade, const double t0, const double t1) {
  Cutting& cutting = *body.cutting;
  std::vector<grid::EdgeCut> cuts;
  for (const cut::BladePath& path : cut::paths(blade, t0, t1)) {
    const auto found = cut::cut_edges(path, body.grid, body.cuts, body.complex, cutting.x_before, corners(body),
                                      blade.label, &*cutting.boxes);
    cuts.insert(cuts.end(), found.cuts.begin(), found.cuts.end());
    cutting.n_double_crossings += found.n_double_crossings;
  }
  cutting.pending.push(cuts);
  cutting.passed[blade.label - 1].pass(cut::sweep(blade, t0, t1), cuts, body.grid, body.cuts, body.complex,
                                       corners(body), *cutting.boxes, blade.label);
}

/// Ends the cuts of a blade where it has gone. Returns edges at faces whose skin is parted so.
std::vector<grid::EdgeId> end_cuts(Body& body, const cut::Blade& blade, const double t0, const double t1) {
  Cutting& cutting = *body.cutting;
  return cutting.open_ends[blade.label - 1].close(cut::whereabouts(blade, t0, t1), cutting.pending, body.grid,
                                                  body.cuts, body.complex, corners(body), blade.label);
}

/// `ended` are edges that were cut before, around which the skin is parted now. Returns all edges at which something is
/// cut.
std::vector<grid::EdgeId> make_cuts(Body& body, const std::vector<grid::EdgeCut>& cuts,
                                    const std::vector<grid::EdgeId>& ended, const cut::Front front, Timings& timings) {
  std::vector<grid::EdgeId> edges = add_cuts(body, cuts, front);
  edges.insert(edges.end(), ended.begin(), ended.end());
  if (edges.empty())
    return {};
  const grid::ComplexChange change = update_topology(body, edges, timings);
  const ScopedTimer timer(timings, "assemble");
  body.physics->follow_cut(seen(body), {edges, change}, body.state);
  make_loads(body);
  return edges;
}

} // namespace

void start(Body& body, const geometry::TriangleMesh& mesh, const PhysicsMaker& make_physics, Timings& timings) {
  {
    const ScopedTimer timer(timings, "topology");
    body.placed = surface::place(body.grid, body.cuts, body.placement);
    cut::fit_skin(mesh, body.grid, body.cuts);
    body.complex = grid::build_complex(body.grid, body.cuts);
    build_surface(body);
  }
  body.first_volume = surface::enclosed_volume(body.surface.rest, body.surface.triangles);
  {
    const ScopedTimer timer(timings, "assemble");
    body.physics = make_physics(seen(body));
    body.state = physics::state_at_rest(*body.physics);
    make_loads(body);
  }
  follow(body);
  if (body.cutting) {
    body.cutting->x_before = corners(body);
    body.cutting->boxes.emplace(body.grid, body.complex);
    body.cutting->passed.resize(body.cutting->n_cut_edges.size());
    body.cutting->open_ends.resize(body.cutting->n_cut_edges.size());
  }
}

void recut(Body& body, const std::span<const cut::Blade> blades, const double t0, const double t1, Timings& timings) {
  std::vector<grid::EdgeCut> released;
  std::vector<grid::EdgeId> ended;
  {
    const ScopedTimer timer(timings, "cut");
    Cutting& cutting = *body.cutting;
    if (!blades.empty())
      cutting.boxes->fit(cutting.x_before, corners(body));
    for (const cut::Blade& blade : blades)
      meet(body, blade, t0, t1);
    for (const cut::Blade& blade : blades)
      for (const grid::EdgeId e : end_cuts(body, blade, t0, t1))
        ended.push_back(e);
    released = cutting.pending.release(body.grid, body.cuts);
    cutting.x_before = corners(body); // not after the cut: where corners jump then, the blade meets them on their way
  }
  const auto edges = make_cuts(body, released, ended, cut::Front::possible, timings);
  for (const cut::Blade& blade : blades)
    body.cutting->open_ends[blade.label - 1].note(body.grid, body.cuts, edges, blade.label);
}

void cut_at_once(Body& body, const cut::CutSurface& surface, Timings& timings) {
  cut::SweepCuts found;
  {
    const ScopedTimer timer(timings, "cut");
    body.cutting->boxes->fit(corners(body));
    found = cut::cut_edges(surface, body.grid, body.cuts, body.complex, corners(body), &*body.cutting->boxes);
  }
  body.cutting->n_double_crossings += found.n_double_crossings;
  const auto rim = cut::rim(surface);
  const auto edges = make_cuts(body, found.cuts, {}, rim.empty() ? cut::Front::none : cut::Front::possible, timings);
  if (rim.empty())
    return;
  cut::OpenEnds ends;
  ends.note(body.grid, body.cuts, edges, surface.label);
  const auto ended =
    ends.close(rim, body.cutting->pending, body.grid, body.cuts, body.complex, corners(body), surface.label);
  make_cuts(body, {}, ended, cut::Front::possible, timings);
}

void follow(Body& body) {
  body.physics->follow(body.state);
  surface::follow(body.surface, corners(body), body.positions);
}

} // namespace kerf::scene
