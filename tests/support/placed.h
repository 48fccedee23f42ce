#pragma once

/// Embedded bodies with their skin placed, cuts with their vertices placed, and what tests ask of them.

#include "cut/cutter.h"
#include "cut/embed.h"
#include "cut/fit.h"
#include "geometry/solid.h"
#include "grid/material.h"
#include "surface/placement.h"
#include "surface/surface.h"
#include "tests/geometry/meshes.h"
#include "tests/support/bodies.h"
#include "tests/support/checkout.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace kerf::support {

/// The liver of the example scenes [m].
inline geometry::TriangleMesh liver_mesh() {
  const std::string path = support::checkout() + "/params/meshes/liver_25k.off";
  return geometry::require_solid(geometry::read_mesh(path, 1e-3), path);
}

inline Body with_placed_skin(Body body) {
  surface::place(body, {});
  return body;
}

/// As a scene embeds a body: cut by its mesh, placed, and fitted to it.
inline Body embedded(const geometry::TriangleMesh& mesh, const double h, const Vec3& offset) {
  Body body = with_placed_skin(cut::embed(mesh, h, offset).solid);
  cut::fit_skin(mesh, body);
  return body;
}

/// All these edges, and the skin above them.
inline cut::SweepCuts with_skin(Body body, const std::span<const grid::EdgeCut> cuts) {
  for (const auto& cut : cuts)
    body.cuts.add(body.grid, cut);
  return {{cuts.begin(), cuts.end()}, skin_cuts_above(body, cuts.empty() ? 1 : cuts.front().label), 0};
}

/// The same in one step.
inline surface::PlacementCounts cut(Body& body, const std::span<const grid::EdgeCut> cuts) {
  const cut::SweepCuts all = with_skin(body, cuts);
  for (const auto& cut : all.cuts)
    body.cuts.add(body.grid, cut);
  for (const auto& cut : all.of_skin)
    body.cuts.add(cut);
  return surface::place(body, {});
}

/// All that a plane cuts.
inline cut::SweepCuts cuts_of_plane(const Body& body, const Plane& plane, const grid::CutLabel label = 1) {
  return {plane_cuts(body, plane, label), plane_skin_cuts(body, plane, label), 0};
}

/// Cuts that are known.
inline surface::PlacementCounts cut_through(Body& body, const cut::SweepCuts& cuts) {
  body.complex = grid::build_complex(body);
  cut::Cutter cutter(9);
  cutter.begin(body, grid::rest_positions(body));
  return surface::place(body, cutter.cut(body, cuts), {});
}

using grid::volume;

/// Volume of each piece [m^3], from the octants.
inline std::vector<double> octant_volumes(const Body& body) {
  const grid::CellComplex& complex = body.complex;
  const grid::Pieces pieces = grid::pieces(complex);
  std::vector<double> volumes(pieces.n_pieces, 0.0);
  const double h = body.grid.h();
  for (const auto c : ids<grid::CopyId>(complex.n_copies()))
    grid::for_each_tetrahedron(body, complex.copies[c], [&](const grid::Tetrahedron& t, int) {
      volumes[pieces.piece[c]] += h * h * h * volume(t);
    });
  return volumes;
}

/// Rest volume of the whole body [m^3], from the triangles.
inline double surface_volume(const Body& body) {
  const auto s = surface::build_surface(with_copies(body));
  return surface::enclosed_volume(s.rest, s.triangles);
}

/// Cells around these edges that hold an empty node.
inline std::size_t n_skin_cells(const Body& body, const std::span<const grid::EdgeCut> cuts) {
  std::vector<grid::CellId> cells;
  for (const auto& cut : cuts)
    for (const auto c : body.grid.cells(cut.edge))
      if (c.valid() && is_skin_cell(body.grid, c))
        cells.push_back(c);
  std::sort(cells.begin(), cells.end());
  return std::unique(cells.begin(), cells.end()) - cells.begin();
}

} // namespace kerf::support
