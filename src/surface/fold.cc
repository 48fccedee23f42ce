#include "surface/fold.h"

#include "grid/material.h"
#include "grid/shape.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <numeric>

namespace kerf::surface {

namespace cube = grid::cube;
namespace skeleton = grid::skeleton;

namespace {

constexpr double negligible = 1e-13, little = 0.02; // of h^2, h^3

/// Adds the integrals of the shape functions over a tetrahedron, by a rule that is exact for them.
void add(std::array<double, 8>& integrals, const grid::Tetrahedron& t) {
  const double volume = grid::volume(t);
  if (volume == 0)
    return;
  const Vec3 centre = 0.25 * (t[0] + t[1] + t[2] + t[3]);
  const auto add_at = [&](const Vec3& p, const double weight) {
    for (int v = 0; v < cube::n_vertices; ++v)
      integrals[v] += weight * volume * grid::shape(v, p);
  };
  add_at(centre, -0.8);
  for (const Vec3& p : t)
    add_at(centre + (p - centre) / 3, 0.45);
}

/// Does the cell's vertex see all of its skin from below? Then nothing is folded.
bool sees_skin(const grid::Solid& solid, const View& view) {
  const Vec3 p = *solid.cuts.inner_point(view.cell);
  bool result = true;
  for_each_bit(view.now.skeleton().sides >> skeleton::first_triangle, [&](const int triangle) {
    const auto& items = view.now.skeleton().side[skeleton::first_triangle + triangle].items;
    const Vec3 a = grid::item_point(solid, view.cell, items[0]) - p,
               b = grid::item_point(solid, view.cell, items[1]) - p,
               c = grid::item_point(solid, view.cell, items[2]) - p;
    result = result && a.dot(b.cross(c)) >= 0;
  });
  return result;
}

} // namespace

bool is_folded(const grid::Solid& solid, const View& view) {
  if (sees_skin(solid, view))
    return false;
  for (const grid::Part& part : parts_of(view.now)) {
    std::array<double, 8> integrals{};
    for (const auto& [t, vertex] : grid::pieces_of(solid, view.cell, part.items()))
      add(integrals, t);
    const double least = *std::min_element(integrals.begin(), integrals.end());
    const double volume = std::accumulate(integrals.begin(), integrals.end(), 0.0);
    if (part.nodes != 0 ? least < -negligible : volume < -little)
      return true;
  }
  return false;
}

bool is_folded(const grid::Solid& solid, const View& view, const int side, const Vec3& p) {
  const auto& [n, items, segments] = view.now.skeleton().side[side];
  const int axis = cube::face_axis(side / 2);
  const double outward = side / 2 % 2 == 1 ? 1 : -1,
               unit = (view.upper - view.lower)[axis] * (view.upper - view.lower)[axis];
  double area = 0, first = 0; // of the part that an item ends, of the one that the side begins in
  bool has_node = false, first_has_node = false, is_first = true;
  const auto is_negative = [&](const double of, const bool with_node) {
    return of < -(with_node ? negligible : little) * unit;
  };
  for (int i = 0; i < n; ++i) {
    const Vec3 a = grid::item_point(solid, view.cell, items[i]) - p,
               b = grid::item_point(solid, view.cell, items[(i + 1) % n]) - p;
    has_node |= items[i] < cube::n_vertices;
    if ((view.now.blades >> segments[i] & 1) == 0) {
      area += 0.5 * outward * a.cross(b)[axis];
      continue;
    }
    const Vec3 at = grid::segment_point(solid, view.cell, view.now.skeleton(), segments[i]) - p;
    area += 0.5 * outward * a.cross(at)[axis];
    if (is_first) {
      first = area;
      first_has_node = has_node;
    } else if (is_negative(area, has_node))
      return true;
    is_first = has_node = false;
    area = 0.5 * outward * at.cross(b)[axis];
  }
  return is_negative(first + area, first_has_node || has_node);
}

} // namespace kerf::surface
