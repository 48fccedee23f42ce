#include "surface/surface.h"

#include "base/parallel.h"
#include "base/sort_unique.h"
#include "base/union_find.h"
#include "surface/writer.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace kerf::surface {

namespace {

/// Room for a closed surface with so many cut edges, and for some cuts, so that the first ones do not move whole
/// tables. It has half as many vertices as triangles, by Euler; of four, one is on an edge, two are in faces and one in
/// a cell.
void reserve(Surface& surface, const std::size_t n_cut_edges) {
  constexpr double entries_per_vertex = (2 + 2 * 4 + 8) / 4.0, spare = 1.125;
  const auto n_triangles =
    static_cast<std::size_t>(spare * static_cast<double>(triangles_per_end) * static_cast<double>(n_cut_edges));
  surface.triangles.reserve(n_triangles);
  surface.labels.reserve(n_triangles);
  surface.copies.reserve(n_triangles);
  const std::size_t n = n_triangles / 2;
  surface.rest.reserve(n);
  surface.weights.start.reserve(n + 1);
  surface.weights.columns.reserve(static_cast<std::size_t>(entries_per_vertex * static_cast<double>(n)));
  surface.weights.values.reserve(static_cast<std::size_t>(entries_per_vertex * static_cast<double>(n)));
}

/// The cells whose part of the surface an update writes: those whose material, corners or front are others.
std::vector<CellId> cells_of(const grid::CutChange& change, const CellComplex& complex) {
  std::vector<CellId> cells;
  for (const CopyId c : change.reshaped)
    cells.push_back(complex.copies[c].cell);
  sort_unique(cells);
  return cells;
}

template <class T>
std::size_t bytes(const std::vector<T>& items) {
  return items.capacity() * sizeof(T);
}

} // namespace

std::size_t Surface::n_bytes() const {
  return bytes(rest) + bytes(triangles) + bytes(labels) + bytes(copies) + bytes(weights.start) +
         bytes(weights.columns) + bytes(weights.values);
}

std::size_t SurfaceIndex::n_bytes() const {
  return first_face_vertex.n_bytes() + first_inner_vertex.n_bytes() + first_skin_centre.n_bytes() +
         (in_skin.size() + pieces_of_skin.size() + centres_of_joined.size() + centres_of_borders.size()) * 2 *
           sizeof(std::uint64_t) +
         bytes(face_vertices) + bytes(edge_vertices) + bytes(segment_vertices) + bytes(first_triangle) +
         bytes(first_triangle_of_segment) + bytes(skin_centres) + bytes(centres.items());
}

Surface build_surface(const Solid& solid) {
  SurfaceIndex index;
  return build_surface(solid, index);
}

Surface build_surface(const Solid& solid, SurfaceIndex& index) {
  Surface surface;
  index = {};
  index.first_face_vertex = index.first_inner_vertex = grid::SparseIndex<FaceId>(solid.grid.n_faces());
  index.first_skin_centre = grid::SparseIndex<CellId>(solid.grid.n_cells());
  index.centres.reserve(solid.complex.copies.items().capacity());
  reserve(surface, solid.cuts.all().size());
  Writer(solid, surface, index, Known::kept).write_all();
  return surface;
}

void update_surface(const Solid& solid, const grid::CutChange& change, Surface& surface, SurfaceIndex& index) {
  Writer writer(solid, surface, index, Known::renewed);
  for (const CellId cell : cells_of(change, solid.complex))
    writer.write(cell);
}

void follow(const Surface& surface, const Points& corners, Points& positions) {
  positions.resize(surface.weights.n_points());
  parallel_for(positions.size(), [&](const std::size_t i) { positions[i] = surface.weights.at(i, corners); });
}

double enclosed_volume(const Points& positions, const std::vector<Triangle>& triangles) {
  if (triangles.empty())
    return 0;
  const Vec3 reference = positions[triangles[0][0]]; // near the body: less cancellation
  double six_volumes = 0;
  for (const auto& [a, b, c] : triangles)
    six_volumes += (positions[a] - reference).dot((positions[b] - reference).cross(positions[c] - reference));
  return six_volumes / 6;
}

std::size_t n_bodies(const Surface& surface) {
  UnionFind parts(surface.rest.size());
  for (const auto& [a, b, c] : surface.triangles)
    parts.unite(parts.unite(a, b), c);
  std::vector<std::uint32_t> part;
  std::vector<double> volumes(parts.number(part), 0.0);
  for (const auto& [a, b, c] : surface.triangles) {
    const Vec3& near = surface.rest[parts.root(a)];
    volumes[part[a]] += (surface.rest[a] - near).dot((surface.rest[b] - near).cross(surface.rest[c] - near));
  }
  return static_cast<std::size_t>(std::ranges::count_if(volumes, [](const double volume) { return volume > 0; }));
}

std::vector<double> piece_volumes(const Surface& surface, const CellComplex& complex) {
  const grid::Pieces pieces = grid::pieces(complex);
  std::vector<double> volumes(pieces.n_pieces, 0.0);
  if (surface.triangles.empty())
    return volumes;
  const Vec3 reference = surface.rest[surface.triangles[0][0]];
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const auto& [a, b, c] = surface.triangles[i];
    const Vec3 &p = surface.rest[a], &q = surface.rest[b], &r = surface.rest[c];
    volumes[pieces.piece[surface.copies[i]]] += (p - reference).dot((q - reference).cross(r - reference)) / 6;
  }
  return volumes;
}

} // namespace kerf::surface
