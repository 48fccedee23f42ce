#include "cut/fronts.h"

#include "cut/course.h"
#include "cut/in_plane.h"
#include "cut/openings.h"
#include "grid/fronts.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
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

/// The shape, larger all around by the lag of these fronts in cubes of this edge [m], or not with 0.
Outline outline_of(const Disc& disc, const Fronts fronts, const double h) {
  constexpr int n = 256;
  Outline outline{disc.centre, disc.normal, disc.radius + most_lag(fronts) * h, {}};
  const Vec3 u = disc.normal.unitOrthogonal(), v = disc.normal.cross(u);
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    const Vec3 out = std::cos(angle) * u + std::sin(angle) * v;
    outline.sides.push_back({out, out.dot(disc.centre) + disc.radius + lag(fronts, out) * h});
  }
  return outline;
}

Outline outline_of(const Rectangle& rectangle, const Fronts fronts, const double h) {
  const Vec3 &a = rectangle.first_side, &b = rectangle.second_side;
  Outline outline{rectangle.centre, a.cross(b).normalized(), 0.5 * (a + b).norm() + 2 * most_lag(fronts) * h, {}};
  for (const Vec3& side : {a, Vec3(-a), b, Vec3(-b)})
    outline.sides.push_back({side.normalized(),
                             side.normalized().dot(rectangle.centre) + 0.5 * side.norm() + lag(fronts, side) * h});
  return outline;
}

/// Of a shape, and with the lag of its front.
struct Outlines {
  Outline own, with_lag;
};
template <class Flat>
std::optional<Outlines> outlines_of(const Flat& shape, const Fronts fronts, const double h) {
  return Outlines{outline_of(shape, fronts, 0), outline_of(shape, fronts, h)};
}
template <class Shape>
requires(!std::is_same_v<Shape, Disc> && !std::is_same_v<Shape, Rectangle>) std::optional<Outlines>
  outlines_of(const Shape&, Fronts, double) {
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

Polygon clipped(Polygon piece, const Outline& outline) {
  for (const HalfSpace& side : outline.sides)
    piece = clipped(piece, side);
  return piece;
}

/// The side nearest to the middle of the section is where the cut ends.
void put_end(const Outline& shape, const Vec3& middle, const ToRest& to_rest, Front& front) {
  const auto nearest =
    std::ranges::max_element(shape.sides, {}, [&](const HalfSpace& side) { return side.beyond(middle); });
  const Vec3 along = to_rest.from * shape.normal.cross(nearest->outward), across = along.cross(front.normal);
  if (across.norm() == 0)
    return;
  front.onward = (across.dot(to_rest.from * nearest->outward) > 0 ? 1 : -1) * across.normalized();
  front.end = front.onward.dot(to_rest(middle - nearest->beyond(middle) * nearest->outward));
}

/// How far the shape has come in the cell; told by where, too.
Front front_in(const CellAtPlane& cell, const Outlines& outlines, const ToRest& to_rest, const Fronts fronts) {
  double inside = 0, all = 0;
  const std::vector<Polygon> material = cell.material();
  for (const Polygon& piece : material) {
    all += area(piece);
    inside += area(clipped(piece, outlines.with_lag));
  }
  const CellAtPlane::Section section = cell.section();
  Front front = cell.front(section, all > 0 ? inside / all : 0);
  put_end(outlines.own, mean(section.there), to_rest, front);
  if (fronts == Fronts::of_points)
    front.come = {come_in(section, outlines.own)};
  return front;
}

bool is_same_plane(const Front& one, const Front& other, const double h) {
  constexpr double same = 0.05; // of a cube, and of a right angle's sine
  return one.normal.cross(other.normal).norm() < same && std::abs(one.normal.dot(one.point - other.point)) < same * h;
}

/// What of the plane lies around nodes, weighted [m^2]: all of it, and what the shape with its lag covers.
struct AroundNode {
  double all = 0, come = 0;
  double part() const { return all > 0 ? come / all : 0; }
};
using AroundNodes = std::map<grid::NodeId, AroundNode>;

/// Adds a cell's; returns the part of it that is covered, by vertex.
OfVertices add(const Solid& solid, const CellId c, const CellAtPlane& cell, const Points& x, const Outline& with_lag,
               AroundNodes& nodes) {
  const bool is_parted = !solid.cuts.front(c) && solid.complex.copies[solid.complex.first_copy[c]].next.valid();
  const ToRest to_rest(solid, c, x);
  OfVertices all{}, come{};
  for (Polygon piece : cell.material()) {
    const auto add_to = [&](OfVertices& sums) {
      Polygon at_rest(piece.size());
      std::ranges::transform(piece, at_rest.begin(), to_rest);
      add_integrals(solid, c, at_rest, sums);
    };
    add_to(all);
    if (!is_parted)
      piece = clipped(piece, with_lag);
    add_to(come);
  }
  const auto at = solid.grid.nodes(c);
  for (int v = 0; v < 8; ++v) {
    AroundNode& node = nodes[at[v]];
    node.all += all[v];
    node.come += come[v];
    come[v] = all[v] > 0 ? come[v] / all[v] : 0;
  }
  return come;
}

/// By vertex of a cell, by how far the vertices are open.
OfVertices held_at(const Solid& solid, const CellId c, const AroundNodes& nodes) {
  OfVertices all{};
  std::ranges::transform(solid.grid.nodes(c), all.begin(), [&](const grid::NodeId node) {
    const AroundNode& around = nodes.at(node);
    return held(around.all, around.part(), solid.grid.h());
  });
  return all;
}

bool opens_a_vertex(const Solid& solid, const CellId c, const AroundNodes& nodes) {
  return std::ranges::any_of(solid.grid.nodes(c),
                             [&](const grid::NodeId node) { return nodes.at(node).part() > least_part_open; });
}

/// An earlier front, where the shape has come farther; none elsewhere.
std::optional<Front> moved_on(const Front& earlier, const Front& now, const double h) {
  Front farther = now, moved = earlier;
  keep_farther_end(earlier, h, farther);
  moved.onward = farther.onward;
  moved.end = farther.end;
  moved.passed = std::max(now.passed, earlier.passed);
  bool comes_on = now.passed > earlier.passed;
  for (int v = 0; v < grid::cube::n_vertices; ++v) {
    comes_on = comes_on || now.held[v] < earlier.held[v];
    moved.held[v] = std::min(now.held[v], earlier.held[v]);
    moved.reached[v] = std::max(now.reached[v], earlier.reached[v]);
  }
  moved.come = now.come;
  return comes_on ? std::optional(moved) : std::nullopt;
}

} // namespace

double lag(const Fronts fronts, const Vec3& ahead) {
  return grid::front_lag(ahead) * (fronts == Fronts::of_springs ? grid::lag_of_springs : 1);
}
double most_lag(const Fronts fronts) {
  return grid::most_front_lag * (fronts == Fronts::of_springs ? grid::lag_of_springs : 1);
}

std::vector<Front> find_fronts(const CutSurface& surface, const Solid& solid, const Points& x, const Fronts fronts) {
  const double h = solid.grid.h();
  const auto outlines = std::visit([&](const auto& shape) { return outlines_of(shape, fronts, h); }, surface.shape);
  if (!outlines)
    return {};
  const Outline& outline = outlines->with_lag;
  std::vector<Front> met;
  AroundNodes nodes;
  for (const auto c : ids<CellId>(solid.grid.n_cells())) {
    const grid::Copy& copy = solid.complex.copies[solid.complex.first_copy[c]];
    const double size = (x[copy.corners[7].value] - x[copy.corners[0].value]).norm();
    if ((x[copy.corners[0].value] - outline.point).norm() > outline.reach + 2 * size)
      continue;
    const CellAtPlane cell(solid, c, {outline.point, outline.normal}, grid::corners_of(copy, x));
    if (!cell.is_met())
      continue;
    const OfVertices reached = add(solid, c, cell, x, outline, nodes);
    const Front* const earlier = solid.cuts.front(c);
    if (!earlier && (copy.next.valid() || solid.cuts.joined(c)))
      continue;
    Front front = front_in(cell, *outlines, ToRest(solid, c, x), fronts);
    front.reached = reached;
    front.label = surface.label;
    if (earlier ? is_same_plane(front, *earlier, h) : front.ahead != 0 && !hangs_by_skin(solid, front))
      met.push_back(std::move(front));
  }
  std::vector<Front> found;
  for (Front& front : met) {
    front.held = held_at(solid, front.cell, nodes);
    if (const Front* const earlier = solid.cuts.front(front.cell)) {
      if (auto moved = moved_on(*earlier, front, h))
        found.push_back(std::move(*moved));
    } else if (opens_a_vertex(solid, front.cell, nodes)) {
      front.passed = std::max(front.passed, least_passed);
      found.push_back(std::move(front));
    }
  }
  return found;
}

} // namespace kerf::cut
