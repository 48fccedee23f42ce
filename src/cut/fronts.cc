#include "cut/fronts.h"

#include "grid/fronts.h"
#include "grid/shape.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>

namespace kerf::cut {

namespace {

namespace cube = grid::cube;
namespace skeleton = grid::skeleton;
using grid::CellId;
using grid::Front;
using grid::Segments;
using grid::Solid;

using Polygon = std::vector<Vec3>;

constexpr double least_passed =
  0.02; // below it a front is not worth a copy; as much less than 1 is tied until it is cut [1]

struct HalfSpace {
  Vec3 outward;
  double height; ///< outward . p <= height

  double beyond(const Vec3& p) const { return outward.dot(p) - height; }
};

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

/// With the lag of its front.
template <class Flat>
std::optional<Outline> outline_with_lag(const Flat& shape, const double h) {
  return outline_of(shape, grid::front_lag * outline_of(shape, 0).normal.template lpNorm<1>() * h);
}
template <class Shape>
requires(!std::is_same_v<Shape, Disc> &&
         !std::is_same_v<Shape, Rectangle>) std::optional<Outline> outline_with_lag(const Shape&, double) {
  return std::nullopt;
}

Polygon clipped(const Polygon& polygon, const HalfSpace& side) {
  Polygon result;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double at_p = side.beyond(p), at_q = side.beyond(q);
    if (at_p <= 0)
      result.push_back(p);
    if ((at_p < 0) != (at_q < 0) && at_p != 0 && at_q != 0)
      result.push_back(p + at_p / (at_p - at_q) * (q - p));
  }
  return result;
}

double area_of(const Polygon& polygon) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 2; i < polygon.size(); ++i)
    sum += (polygon[i - 1] - polygon[0]).cross(polygon[i] - polygon[0]);
  return 0.5 * sum.norm();
}

Vec3 mean(const Polygon& points) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points)
    sum += p;
  return sum / static_cast<double>(points.size());
}

/// The points of a convex polygon in their order around it.
void sort_around(Polygon& points, const Vec3& normal) {
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u), middle = mean(points);
  const auto angle = [&](const Vec3& p) { return std::atan2(v.dot(p - middle), u.dot(p - middle)); };
  std::sort(points.begin(), points.end(), [&](const Vec3& p, const Vec3& q) { return angle(p) < angle(q); });
}

/// A cell with one copy, and an outline's plane.
class CellAtPlane {
 public:
  CellAtPlane(const Solid& solid, const CellId c, const Outline& outline, const Points& x)
    : solid_(solid), cell_(c), outline_(outline) {
    const grid::Copy& copy = solid.complex.copies[solid.complex.first_copy[c]];
    for (int v = 0; v < cube::n_vertices; ++v) {
      x_[v] = x[copy.corners[v].value];
      height_[v] = height(x_[v]);
      above_ |= unsigned(height_[v] >= 0) << v; // as meet() of cut_surface.cc has it
    }
  }

  bool is_met() const { return above_ != 0 && above_ != 0xff; }

  /// The plane in the cell and the part of it inside the outline; what is ahead is to be said.
  Front front() const {
    Polygon now, rest;
    cut_lines(now, rest);
    Front front{.cell = cell_, .point = mean(rest), .normal = normal_of(rest)};
    sort_around(now, outline_.normal);
    sort_around(rest, front.normal);
    front.area = area_of(rest);
    const double whole = area_of(now);
    for (const HalfSpace& side : outline_.sides)
      now = clipped(now, side);
    front.passed = std::min(1 - least_passed, area_of(now) / whole);
    return front;
  }

  /// The segments whose ends the plane parts, but that are not cut.
  Segments ahead() const {
    const grid::CellCuts cuts = grid::cuts_of(solid_, cell_);
    const grid::Skeleton& skeleton = cuts.skeleton();
    const auto heights = heights_of_items(cuts);
    Segments found = 0;
    for (Segments left = skeleton.segments & ~cuts.blades; left != 0; left &= left - 1)
      if (const auto& [a, b] = skeleton.segment[std::countr_zero(left)].ends; (heights[a] >= 0) != (heights[b] >= 0))
        found |= left & -left;
    return found;
  }

 private:
  double height(const Vec3& p) const { return outline_.normal.dot(p - outline_.point); }

  /// Where the plane meets the cube's lines, now and at rest. A plane that only grazes the cell is moved into it by a
  /// little, so that its section has an area.
  void cut_lines(Polygon& now, Polygon& rest) const {
    constexpr double little = 1e-3; // in parts of h
    const auto [least, most] = std::minmax_element(height_.begin(), height_.end());
    const double room = std::min(little * solid_.grid.h(), 0.25 * (*most - *least));
    const double level = std::clamp(0.0, *least + room, *most - room);
    const auto nodes = solid_.grid.nodes(cell_);
    for (const auto& [v, w] : cube::line_vertices) {
      const double at_v = height_[v] - level, at_w = height_[w] - level;
      if ((at_v >= 0) == (at_w >= 0))
        continue;
      const double t = at_v / (at_v - at_w);
      const Vec3 p = solid_.grid.position(nodes[v]), q = solid_.grid.position(nodes[w]);
      now.push_back(x_[v] + t * (x_[w] - x_[v]));
      rest.push_back(p + t * (q - p));
    }
  }

  /// Of the plane nearest to points.
  static Vec3 normal_of(const Polygon& points) {
    const Vec3 middle = mean(points);
    Mat3 spread = Mat3::Zero();
    for (const Vec3& p : points)
      spread += (p - middle) * (p - middle).transpose();
    return Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors().col(0);
  }

  /// Signed like the side of the plane. Of what lies right in the plane the cut itself has said on which side it is.
  std::array<double, skeleton::n_items> heights_of_items(const grid::CellCuts& cuts) const {
    const grid::Skeleton& skeleton = cuts.skeleton();
    std::array<double, skeleton::n_items> heights{};
    for (grid::Items left = skeleton.items; left != 0; left &= left - 1) {
      const int item = std::countr_zero(left);
      heights[item] = item < skeleton::first_on_line ? height_[item] : height(position(item));
    }
    const double in_plane = 1e-7 * solid_.grid.h();
    for (const Segments kind : {skeleton::lines, ~skeleton::lines & ~skeleton::spokes, skeleton::spokes})
      for (Segments left = skeleton.segments & cuts.blades & kind; left != 0; left &= left - 1) {
        const auto& [a, b] = skeleton.segment[std::countr_zero(left)].ends;
        for (const auto& [p, q] : {std::pair{a, b}, std::pair{b, a}})
          if (p >= skeleton::first_on_line && std::abs(heights[p]) < in_plane)
            heights[p] = heights[q] >= 0 ? -1 : 1;
      }
    return heights;
  }

  Vec3 position(const int item) const {
    const Vec3 xi = (grid::item_point(solid_, cell_, item) - solid_.grid.origin(cell_)) / solid_.grid.h();
    Vec3 p = Vec3::Zero();
    for (int v = 0; v < cube::n_vertices; ++v)
      p += grid::shape(v, xi) * x_[v];
    return p;
  }

  const Solid& solid_;
  CellId cell_;
  const Outline& outline_;
  std::array<Vec3, 8> x_;
  std::array<double, 8> height_;
  unsigned above_ = 0;
};

/// Would a part of the cell hold on to a neighbour by points of the skin alone? Neighbours that no blade has cut do not say
/// which part holds those (grid/parts.h).
bool hangs_by_skin(const Solid& solid, const Front& front) {
  constexpr unsigned nodes = 0xf;
  const grid::Parts parts = grid::parts_of(grid::with(grid::cuts_of(solid, front.cell), front.ahead));
  for (int face = 0; face < cube::n_faces; ++face)
    if (solid.grid.neighbour(front.cell, face).valid())
      for (const grid::Part& part : parts)
        if (const unsigned items = grid::detail::in_face(part, face); items != 0 && (items & nodes) == 0)
          return true;
  return false;
}

bool is_same_plane(const Front& one, const Front& other, const double h) {
  constexpr double same = 0.05; // of a cube, and of a right angle's sine
  return one.normal.cross(other.normal).norm() < same && std::abs(one.normal.dot(one.point - other.point)) < same * h;
}

Front moved_on(Front front, const double passed) {
  front.passed = passed;
  return front;
}

} // namespace

std::vector<Front> find_fronts(const CutSurface& surface, const Solid& solid, const Points& x) {
  const double h = solid.grid.h();
  const auto outline =
    std::visit([&](const auto& shape) -> std::optional<Outline> { return outline_with_lag(shape, h); }, surface.shape);
  std::vector<Front> fronts;
  if (!outline)
    return fronts;
  for (const auto c : ids<CellId>(solid.grid.n_cells())) {
    const grid::Copy& copy = solid.complex.copies[solid.complex.first_copy[c]];
    const double size = (x[copy.corners[7].value] - x[copy.corners[0].value]).norm();
    if ((x[copy.corners[0].value] - outline->point).norm() > outline->reach + 2 * size)
      continue;
    const Front* const earlier = solid.cuts.front(c);
    if (copy.next.valid() && !earlier)
      continue;
    const CellAtPlane cell(solid, c, *outline, x);
    if (!cell.is_met())
      continue;
    Front front = cell.front();
    if (earlier) {
      if (front.passed > earlier->passed && is_same_plane(front, *earlier, h))
        fronts.push_back(moved_on(*earlier, front.passed));
      continue;
    }
    front.label = surface.label;
    if (front.passed < least_passed)
      continue;
    front.ahead = cell.ahead();
    if (front.ahead != 0 && !hangs_by_skin(solid, front))
      fronts.push_back(front);
  }
  return fronts;
}

} // namespace kerf::cut
