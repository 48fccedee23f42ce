#include "surface/closing.h"

#include "grid/cube.h"
#include "surface/below_skin.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <optional>

namespace kerf::surface {

namespace cube = grid::cube;
namespace skeleton = grid::skeleton;
using grid::CellId;
using grid::Front;
using grid::Solid;

namespace {

constexpr double inside = 0.02; // of a cube: the least distance from the sides, as triangles are to have an area
constexpr double beyond = 2;

/// What the plane of a front crosses of a face, from behind the front on.
struct Crossed {
  Vec3 behind, ahead;
  double end; ///< where the front ends, from one to the other; less than 0 or more than 1 beyond them [1]

  Vec3 at(const double t) const { return behind + t * (ahead - behind); }
};

std::optional<Crossed> crossed(const Solid& solid, const Front& front, const CellId c, const int face) {
  const auto nodes = solid.grid.nodes(c);
  std::array<Vec3, 2> ends;
  std::size_t n = 0;
  for (const int line : cube::face_lines[face]) {
    const Vec3 p = solid.grid.position(nodes[cube::line_vertices[line][0]]),
               q = solid.grid.position(nodes[cube::line_vertices[line][1]]);
    const double at_p = front.normal.dot(p - front.point), at_q = front.normal.dot(q - front.point);
    if ((at_p >= 0) != (at_q >= 0) && n < 2)
      ends[n++] = p + at_p / (at_p - at_q) * (q - p);
  }
  if (n < 2)
    return {};
  double first = front.onward.dot(ends[0]), second = front.onward.dot(ends[1]);
  if (second < first) {
    std::swap(first, second);
    std::swap(ends[0], ends[1]);
  }
  const double least = inside * solid.grid.h(); // along the end itself it crosses nowhere
  const double t = second - first > least ? (front.end - first) / (second - first) : front.end > first ? beyond : -beyond;
  return Crossed{ends[0], ends[1], t};
}

bool is_told(const Front* const front) { return front && front->onward != Vec3::Zero(); }

/// Is what is cut there part of the front's cut, and not of another one?
bool is_of(const Front& front, const Vec3& cut, const double h) {
  constexpr double near = 0.2; // cubes, as blades turn
  return std::abs(front.normal.dot(cut - front.point)) < near * h;
}

/// In a face of the cell into which one cut leads, where the front's plane and end cross it; the nearest point of the
/// plane there where the end lies beyond the face. None without a front of that cut in either cell of the face, or where
/// the plane does not cross it.
std::optional<Vec3> end_in_face(const Solid& solid, const CellId c, const int face, const Vec3& cut) {
  for (const CellId of : solid.grid.cells(solid.grid.faces(c)[face]))
    if (const Front* const front = of.valid() ? solid.cuts.front(of) : nullptr;
        is_told(front) && is_of(*front, cut, solid.grid.h()))
      if (const auto found = crossed(solid, *front, c, face))
        return found->at(std::clamp(found->end, inside, 1 - inside));
  return {};
}

/// In the middle of the front's end in the cell; without one there, where the plane comes nearest to it. None without a
/// front, or where some of these cuts are not its own.
std::optional<Vec3> end_in_cell(const Solid& solid, const CellId c, const Points& cuts) {
  const Front* const front = solid.cuts.front(c);
  if (!is_told(front) ||
      !std::ranges::all_of(cuts, [&](const Vec3& cut) { return is_of(*front, cut, solid.grid.h()); }))
    return {};
  Vec3 on_end = Vec3::Zero(), all = Vec3::Zero(), nearest = front->point;
  int n_on_end = 0, n = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int face = 0; face < cube::n_faces; ++face)
    if (const auto found = crossed(solid, *front, c, face)) {
      all += found->at(0.5);
      ++n;
      if (found->end >= 0 && found->end <= 1) {
        on_end += found->at(found->end);
        ++n_on_end;
      }
      for (const Vec3& p : {found->behind, found->ahead}) {
        const double far = std::abs(front->end - front->onward.dot(p));
        if (far < least) {
          least = far;
          nearest = p;
        }
      }
    }
  if (n == 0)
    return {};
  const Vec3 end = n_on_end > 0 ? Vec3(on_end / n_on_end) : nearest;
  return end + 2 * inside * (all / n - end);
}

/// As far as to leave a tenth of the way to the skin free, so that triangles have an area; part_before(point) says how
/// much of the way there lies below it.
template <class PartBefore>
Vec3 below_skin(const Vec3& from, const Vec3& to, const PartBefore& part_before) {
  const Vec3 further = (to - from) / 0.9;
  return from + 0.9 * part_before(Vec3(from + further)) * further;
}

/// Where these lines of a cell are cut.
Points cuts_of_lines(const Solid& solid, const CellId c, const unsigned lines) {
  Points cuts;
  const auto edges = solid.grid.edges(c);
  for (unsigned left = lines; left != 0; left &= left - 1)
    if (solid.cuts.find(edges[std::countr_zero(left)]))
      cuts.push_back(grid::edge_point(solid, edges[std::countr_zero(left)]));
  return cuts;
}

} // namespace

Vec3 vertex_in_face(const Solid& solid, const CellId c, const int face, const bool closes) {
  const Points cuts = closes ? cuts_of_lines(solid, c, cube::lines_of_face[face]) : Points();
  const std::optional<Vec3> end = cuts.size() == 1 ? end_in_face(solid, c, face, cuts[0]) : std::nullopt;
  return end ? *end : grid::face_point(solid, solid.grid.faces(c)[face]);
}

Vec3 vertex_in_cell(const Solid& solid, const CellId c, const bool closes) {
  const bool ends = closes && is_told(solid.cuts.front(c));
  const std::optional<Vec3> end = ends ? end_in_cell(solid, c, cuts_of_lines(solid, c, 0xfff)) : std::nullopt;
  return end ? *end : grid::cell_point(solid, c);
}

bool CutAtSkin::closes_in(const int side) const {
  const auto& [n, items, segments] = skeleton.side[side];
  return std::count_if(segments.begin(), segments.begin() + n, [&](const int segment) { return is_cut(segment); }) == 1;
}

int CutAtSkin::cut_of(const int side) const {
  const auto& [n, items, segments] = skeleton.side[side];
  return *std::find_if(segments.begin(), segments.begin() + n, [&](const int segment) { return is_cut(segment); });
}

Vec3 vertex_in_polygon(const CutAtSkin& at, const int side) {
  const int face = side / 2, arc = side % 2;
  const Vec3 p = *at.solid.cuts.inner_point(at.solid.grid.faces(at.cell)[face], arc);
  const std::optional<Vec3> end =
    at.closes_in(side) ? end_in_face(at.solid, at.cell, face, at.point(at.cut_of(side))) : std::nullopt;
  if (!end)
    return p;
  const grid::SkinArc& of_skin = grid::skin_arcs(face, grid::material_of(at.solid.grid, at.cell)).arcs[arc];
  const auto point = [&](const int item) { return grid::item_point(at.solid, at.cell, item); };
  return below_skin(p, *end, [&](const Vec3& to) {
    return part_before_line(p, to, point(skeleton::on_line(of_skin.lines[0])), point(skeleton::on_arc(face, arc)),
                            point(skeleton::on_line(of_skin.lines[1])), cube::face_axis(face));
  });
}

Vec3 vertex_below_skin(const CutAtSkin& at) {
  const Vec3 p = *at.solid.cuts.inner_point(at.cell);
  const grid::Items all = at.skeleton.items;
  const bool closes = at.skeleton.reachable(all & -all, at.blades) == all;
  Points cuts;
  for (grid::Segments left = closes ? at.blades : 0; left != 0; left &= left - 1)
    cuts.push_back(at.point(std::countr_zero(left)));
  const std::optional<Vec3> end = closes ? end_in_cell(at.solid, at.cell, cuts) : std::nullopt;
  if (!end)
    return p;
  return below_skin(p, *end, [&](const Vec3& to) {
    double part = 1;
    for (grid::Sides left = at.skeleton.sides >> skeleton::first_triangle; left != 0; left &= left - 1) {
      const auto& items = at.skeleton.side[skeleton::first_triangle + std::countr_zero(left)].items;
      const auto point = [&](const int k) { return grid::item_point(at.solid, at.cell, items[k]); };
      part = std::min(part, part_before(p, to, {point(0), point(1), point(2)}));
    }
    return part;
  });
}

/// One cut alone has its vertex halfway through.
Vec3 vertex_in_skin(const CutAtSkin& at, const int triangle) {
  const Vec3 p = *at.solid.cuts.inner_point(at.cell, triangle);
  const Front* const front = at.solid.cuts.front(at.cell);
  const int side = skeleton::first_triangle + triangle;
  if (!is_told(front) || !at.closes_in(side))
    return p;
  const Vec3 from = at.point(at.cut_of(side)), way = 2 * (p - from);
  if (!is_of(*front, from, at.solid.grid.h()))
    return p;
  const double along = front->onward.dot(way);
  if (along <= 0)
    return p;
  return from + std::clamp((front->end - front->onward.dot(from)) / along, inside, 1 - inside) * way;
}

} // namespace kerf::surface
