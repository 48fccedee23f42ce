#include "cut/fronts.h"

#include "cut/course.h"
#include "grid/fronts.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace kerf::cut {

namespace {

using grid::CellId;
using grid::Front;
using grid::Solid;

/// A flat, convex shape.
struct Outline {
  Vec3 point, normal;
  double reach; ///< from the point, of all of it [m]
  std::vector<HalfSpace> sides;
};

/// The shape, larger by `more` [m] all around.
Outline outline_of(const Disc& disc, const double more) {
  constexpr int n = 256;
  Outline outline{disc.centre, disc.normal, disc.radius + more, {}};
  const Vec3 u = disc.normal.unitOrthogonal(), v = disc.normal.cross(u);
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    const Vec3 out = std::cos(angle) * u + std::sin(angle) * v;
    outline.sides.push_back({out, out.dot(disc.centre) + disc.radius + more});
  }
  return outline;
}

Outline outline_of(const Rectangle& rectangle, const double more) {
  const Vec3 &a = rectangle.first_side, &b = rectangle.second_side;
  Outline outline{rectangle.centre, a.cross(b).normalized(), 0.5 * (a + b).norm() + 2 * more, {}};
  for (const Vec3& side : {a, Vec3(-a), b, Vec3(-b)})
    outline.sides.push_back({side.normalized(), side.normalized().dot(rectangle.centre) + 0.5 * side.norm() + more});
  return outline;
}

/// Of a shape, and with the lag of its front.
struct Outlines {
  Outline own, with_lag;
};
template <class Flat>
std::optional<Outlines> outlines_of(const Flat& shape, const double h) {
  const Outline own = outline_of(shape, 0);
  return Outlines{own, outline_of(shape, grid::front_lag(own.normal) * h)};
}
template <class Shape>
requires(!std::is_same_v<Shape, Disc> && !std::is_same_v<Shape, Rectangle>) std::optional<Outlines>
  outlines_of(const Shape&, double) {
  return std::nullopt;
}

/// What of the section lies in the shape, at rest. The section is taken a little larger, so that what neighbours have
/// of the cut has no seam.
Points come_in(const CellAtPlane::Section& section, const Outline& shape) {
  constexpr double larger = 1.02;
  const Vec3 middle = mean(section.there), middle_at_rest = mean(section.rest);
  struct Place {
    Vec3 there, rest;
  };
  std::vector<Place> places;
  for (std::size_t i = 0; i < section.rest.size(); ++i)
    places.push_back({middle + larger * (section.there[i] - middle),
                      middle_at_rest + larger * (section.rest[i] - middle_at_rest)});
  for (const HalfSpace& side : shape.sides)
    places = clipped(
      places, [&](const Place& p) { return side.beyond(p.there); },
      [](const Place& p, const Place& q, const double t) {
        return Place{p.there + t * (q.there - p.there), p.rest + t * (q.rest - p.rest)};
      });
  Points come;
  for (const Place& place : places)
    come.push_back(place.rest);
  return come;
}

/// How far the shape has come in the cell; told by where, too.
Front front_in(const CellAtPlane& cell, const Outlines& outlines, const bool as_faces) {
  double inside = 0, all = 0;
  for (Polygon piece : cell.material()) {
    all += area(piece);
    for (const HalfSpace& side : outlines.with_lag.sides)
      piece = clipped(piece, side);
    inside += area(piece);
  }
  const CellAtPlane::Section section = cell.section();
  Front front = cell.front(section, all > 0 ? inside / all : 0);
  if (as_faces)
    front.come = {come_in(section, outlines.own)};
  return front;
}

bool is_same_plane(const Front& one, const Front& other, const double h) {
  constexpr double same = 0.05; // of a cube, and of a right angle's sine
  return one.normal.cross(other.normal).norm() < same && std::abs(one.normal.dot(one.point - other.point)) < same * h;
}

Front with_passed(Front front, const double passed) {
  front.passed = passed;
  return front;
}

} // namespace

std::vector<Front> find_fronts(const CutSurface& surface, const Solid& solid, const Points& x, const bool as_faces) {
  const double h = solid.grid.h();
  const auto outlines = std::visit([&](const auto& shape) { return outlines_of(shape, h); }, surface.shape);
  std::vector<Front> fronts, corners;
  if (!outlines)
    return fronts;
  const Outline& outline = outlines->with_lag;
  for (const auto c : ids<CellId>(solid.grid.n_cells())) {
    const grid::Copy& copy = solid.complex.copies[solid.complex.first_copy[c]];
    const double size = (x[copy.corners[7].value] - x[copy.corners[0].value]).norm();
    if ((x[copy.corners[0].value] - outline.point).norm() > outline.reach + 2 * size)
      continue;
    const Front* const earlier = solid.cuts.front(c);
    if (!earlier && (copy.next.valid() || solid.cuts.joined(c)))
      continue;
    const CellAtPlane cell(solid, c, {outline.point, outline.normal}, grid::corners_of(copy, x));
    if (!cell.is_met())
      continue;
    Front front = front_in(cell, *outlines, as_faces);
    if (earlier) {
      if (front.passed > earlier->passed && is_same_plane(front, *earlier, h)) {
        fronts.push_back(with_passed(*earlier, front.passed));
        fronts.back().come = front.come;
      }
      continue;
    }
    front.label = surface.label;
    if (front.ahead == 0 || hangs_by_skin(solid, front))
      continue;
    if (front.passed >= least_passed)
      fronts.push_back(front);
    else
      corners.push_back(with_passed(front, least_passed));
  }
  FrontsOfCells begun;
  for (const Front& front : fronts)
    begun.emplace(front.cell, front);
  for (const Front& corner : corners)
    if (opens_early(solid, corner, begun))
      fronts.push_back(corner);
  std::ranges::sort(fronts, {}, &Front::cell);
  return fronts;
}

} // namespace kerf::cut
