#include "surface/fold.h"

#include "grid/material.h"
#include "grid/shape.h"

#include <Eigen/Geometry>

namespace kerf::surface {

namespace cube = grid::cube;

namespace {

constexpr double negligible = 1e-13; // of h^3

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

} // namespace

bool is_folded(const grid::Solid& solid, const View& view) {
  bool may_be = false;
  for_each_bit(view.now.skin, [&](const int line) {
    for (const auto& t : grid::under_skin(solid, view.cell, line))
      may_be |= grid::volume(t) < -negligible;
  });
  if (!may_be)
    return false;
  for (const grid::Part& part : parts_of(view.now)) {
    std::array<double, 8> integrals{};
    const grid::Copy copy{view.cell, part.nodes, part.rinds, {}, {}};
    grid::for_each_tetrahedron(solid, copy, [&](const grid::Tetrahedron& t, int) { add(integrals, t); });
    for (const double integral : integrals)
      if (integral < -negligible)
        return true;
  }
  return false;
}

bool is_folded(const View& view, const int face, const Vec3& p, const grid::SkinPoint& skin, const double little) {
  const int normal = cube::face_axis(face), u = (normal + 1) % 3, v = (normal + 2) % 3;
  const double negative = -(little + negligible) * (view.upper - view.lower).squaredNorm();
  for (const grid::SkinArc& arc : grid::skin_arcs(face, view.now.material))
    for (const int end : {0, 1}) {
      const int line = arc.lines[end], axis = cube::line_axis(line);
      if (!(skin.lines >> cube::place_in_face(face, line) & 1))
        continue;
      const Vec3 &from = view.planes[line].point, to_skin = skin.p - from, to_cut = p - from;
      // Outward along the line, the skin's vertex lies ahead of the cut's: turned to it from the side of the face.
      const bool upward = arc.vertices[end] == cube::line_vertices[line][0];
      const bool at_lower_side = from[axis == u ? v : u] < 0.5 * (view.lower + view.upper)[axis == u ? v : u];
      const double turn = to_cut[u] * to_skin[v] - to_cut[v] * to_skin[u];
      const bool is_left = (axis == v) == (upward == at_lower_side);
      if ((is_left ? turn : -turn) < negative)
        return true;
    }
  return false;
}

} // namespace kerf::surface
