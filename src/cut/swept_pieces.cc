#include "cut/swept_pieces.h"

#include "cut/openings.h"
#include "grid/fronts.h"

#include <algorithm>

namespace kerf::cut {

namespace {

using grid::CellId;
using grid::Solid;

std::vector<std::array<double, 2>> fractions_of(const BladePath& path) {
  std::vector<std::array<double, 2>> fractions;
  for (std::size_t k = 1; k < path.lines.size(); ++k)
    fractions.insert(fractions.end(), path.lines[k].size() - 1, {path.fractions[k - 1], path.fractions[k]});
  return fractions;
}

std::vector<Patch> patches_of(const geometry::TriangleMesh& mesh) {
  std::vector<std::array<Vec3, 3>> triangles(mesh.triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i)
    triangles[i] = corners(mesh, i);
  return patches(triangles);
}

bool is_in(const Box& box, const Patch& patch) {
  const Box around = geometry::box_around(patch);
  return (around.lower.array() <= box.upper.array()).all() && (box.lower.array() <= around.upper.array()).all();
}

} // namespace

Box around(const Solid& solid, const CellId c, const double more) {
  const Vec3 origin = solid.grid.origin(c);
  return {origin - Vec3::Constant(more), origin + Vec3::Constant(solid.grid.h() + more)};
}

Polygon clipped(Polygon polygon, const Box& box) {
  for (int axis = 0; axis < 3; ++axis) {
    polygon = clipped(polygon, HalfSpace{-Vec3::Unit(axis), -box.lower[axis]});
    polygon = clipped(polygon, HalfSpace{Vec3::Unit(axis), box.upper[axis]});
  }
  return polygon;
}

SweptPieces::SweptPieces(const BladePath& path, const Solid& solid, const Points& x_before, const Points& x,
                         const double lag)
  : solid_(solid),
    x_before_(x_before),
    x_(x),
    patches_(patches(path)),
    fractions_(fractions_of(path)),
    near_(patches_),
    lag_(lag) {}

SweptPieces::SweptPieces(const geometry::TriangleMesh& mesh, const Solid& solid, const Points& x, const double lag)
  : solid_(solid),
    x_before_(x),
    x_(x),
    patches_(patches_of(mesh)),
    fractions_(mesh.triangles.size(), {0, 0}),
    near_(patches_),
    lag_(lag) {}

std::vector<Polygon> SweptPieces::in(const CellId c) const {
  const ToRest before(solid_, c, x_before_), now(solid_, c, x_);
  const Box reach = around(solid_, c, lag_ * solid_.grid.h());
  std::vector<std::size_t> near;
  near_.for_each(box_of(c), [&](const std::size_t i) { near.push_back(i); });
  std::ranges::sort(near);
  std::vector<Polygon> pieces;
  for (const std::size_t i : near) {
    Patch at_rest;
    for (std::size_t k = 0; k < at_rest.size(); ++k) {
      const double t = fractions_[i][k / 2];
      at_rest[k] = (1 - t) * before(patches_[i][k]) + t * now(patches_[i][k]);
    }
    if (!is_in(reach, at_rest))
      continue;
    Polygon piece = clipped({at_rest.begin(), at_rest.end()}, reach);
    if (area(piece) > 0)
      pieces.push_back(std::move(piece));
  }
  return pieces;
}

/// Around a cell on its way, with the lag of fronts.
Box SweptPieces::box_of(const CellId c) const {
  const grid::Copy& copy = solid_.complex.copies[solid_.complex.first_copy[c]];
  std::array<Vec3, 16> corners;
  for (int v = 0; v < 8; ++v) {
    corners[v] = x_[copy.corners[v].value];
    corners[8 + v] = x_before_[copy.corners[v].value];
  }
  const Box box = geometry::box_around(corners);
  const Vec3 lag = Vec3::Constant(lag_ * (box.upper - box.lower).maxCoeff());
  return {box.lower - lag, box.upper + lag};
}

} // namespace kerf::cut
