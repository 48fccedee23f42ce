#include "scene/body.h"

#include "cut/fit.h"
#include "cut/recut.h"

namespace kerf::scene {

namespace {

/// Corners whose rest position lies in a region, real or virtual.
void find_supports(Body& body) {
  body.loads.supports.clear();
  for (const SupportRegion& region : body.regions) {
    dynamics::Support support{{}, {}, region.displacement};
    for (const auto corner : ids<grid::CornerId>(body.complex.n_corners())) {
      const Vec3 X = body.grid.position(body.complex.node[corner]);
      if (region.box.contains(X)) {
        support.corners.push_back(corner.value);
        support.rest.push_back(X);
      }
    }
    body.loads.supports.push_back(std::move(support));
  }
}

void build_surface(Body& body) { body.surface = surface::build_surface(body.grid, body.cuts, body.complex); }

void build_physics(Body& body, Timings& timings) {
  const ScopedTimer timer(timings, "assemble");
  find_supports(body);
  body.physics = body.make_physics(body);
}

Points inherited(const Points& of_corners, const Table<grid::CornerId, grid::CornerId>& parents) {
  Points values;
  values.reserve(parents.size());
  for (const auto parent : parents)
    values.push_back(of_corners[parent.value]);
  return values;
}

void inherit_state(Body& body, const Table<grid::CornerId, grid::CornerId>& parents) {
  body.state.x = inherited(body.state.x, parents);
  body.state.v = inherited(body.state.v, parents);
  body.cutting->x_before = inherited(body.cutting->x_before, parents);
}

/// Adds cuts to the body; returns the edges.
std::vector<grid::EdgeId> add_cuts(Body& body, const std::vector<grid::EdgeCut>& cuts) {
  std::vector<grid::EdgeId> edges;
  for (const grid::EdgeCut& cut : cuts) {
    body.cuts.add(cut);
    edges.push_back(cut.edge);
    ++body.cutting->n_cut_edges[cut.label - 1];
  }
  return edges;
}

void rebuild_topology(Body& body, const std::vector<grid::EdgeId>& edges, Timings& timings) {
  const ScopedTimer timer(timings, "topology");
  const auto placed = surface::place(body.grid, body.cuts, edges, body.placement);
  body.placed.n_placed += placed.n_placed;
  body.placed.n_clamped += placed.n_clamped;
  grid::CellComplex complex = grid::build_complex(body.grid, body.cuts);
  inherit_state(body, grid::parents(body.complex, complex));
  body.complex = std::move(complex);
  build_surface(body);
  ++body.n_recuts;
}

void make_cuts(Body& body, const std::vector<grid::EdgeCut>& cuts, Timings& timings) {
  if (cuts.empty())
    return;
  rebuild_topology(body, add_cuts(body, cuts), timings);
  build_physics(body, timings);
}

} // namespace

void start(Body& body, const geometry::TriangleMesh& mesh, Timings& timings) {
  {
    const ScopedTimer timer(timings, "topology");
    std::vector<grid::EdgeId> skin;
    for (const grid::EdgeCut& cut : body.cuts.all())
      skin.push_back(cut.edge);
    body.placed = surface::place(body.grid, body.cuts, skin, body.placement);
    cut::fit_skin(mesh, body.grid, body.cuts);
    body.complex = grid::build_complex(body.grid, body.cuts);
    build_surface(body);
  }
  body.first_volume = surface::enclosed_volume(body.surface.rest, body.surface.triangles);
  body.state.x = grid::rest_positions(body.grid, body.complex);
  body.state.v.assign(body.complex.n_corners(), Vec3::Zero());
  build_physics(body, timings);
  follow(body);
  if (body.cutting)
    body.cutting->x_before = body.state.x;
}

void recut(Body& body, const std::span<const cut::Blade> blades, const double t0, const double t1, Timings& timings) {
  std::vector<grid::EdgeCut> released;
  {
    const ScopedTimer timer(timings, "cut");
    Cutting& cutting = *body.cutting;
    for (const cut::Blade& blade : blades) {
      const auto found = cut::cut_edges(cut::path(blade, t0, t1), body.grid, body.cuts, body.complex, cutting.x_before,
                                        body.state.x, blade.label);
      cutting.pending.push(found.cuts);
      cutting.n_double_crossings += found.n_double_crossings;
    }
    released = cutting.pending.release(body.grid, body.cuts);
  }
  make_cuts(body, released, timings);
  body.cutting->x_before = body.state.x;
}

void cut_at_once(Body& body, const cut::CutSurface& surface, Timings& timings) {
  cut::SweepCuts found;
  {
    const ScopedTimer timer(timings, "cut");
    found = cut::cut_edges(surface, body.grid, body.cuts, body.complex, body.state.x);
  }
  body.cutting->n_double_crossings += found.n_double_crossings;
  make_cuts(body, found.cuts, timings);
}

void follow(Body& body) { surface::follow(body.surface, body.state.x, body.positions); }

} // namespace kerf::scene
