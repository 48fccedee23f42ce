#include "cut/course.h"

#include "cut/cell_at_plane.h"
#include "cut/shreds.h"
#include "cut/sides.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

namespace kerf::cut {

namespace {

using grid::CellId;
using grid::Front;
using grid::Solid;
namespace skeleton = grid::skeleton;

constexpr double in_plane = 1e-6; // cubes; and of a unit vector

/// Where a blade has been in a cell and around it, at rest [m].
Points known_points(const Solid& solid, const CellId c, const std::vector<Polygon>& pieces,
                    const grid::CutLabel label) {
  Points points;
  for (const Polygon& piece : pieces)
    points.insert(points.end(), piece.begin(), piece.end());
  for (const CellId cell : cells_around(solid.grid, c))
    for (const grid::EdgeId e : solid.grid.edges(cell))
      if (const grid::EdgeCut* const cut = solid.cuts.find(e); cut && cut->label == label)
        points.push_back(edge_point(solid, e));
  return points;
}

/// The plane nearest to points, and how far they stray from it [m]; where they span little, how far they would in a
/// cell.
struct Course {
  Plane plane;
  double stray;
};
std::optional<Course> course_of(const Points& points, const double h) {
  constexpr double wide = 0.1, least_width = 1e-3; // as standard deviations, in cubes
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : points)
    middle += p / double(points.size());
  Mat3 spread = Mat3::Zero();
  for (const Vec3& p : points)
    spread += (p - middle) * (p - middle).transpose() / double(points.size());
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(spread);
  if (!(axes.eigenvalues()[1] > std::pow(least_width * h, 2)))
    return std::nullopt;
  Course course{{middle, axes.eigenvectors().col(0)}, 0};
  for (const Vec3& p : points)
    course.stray = std::max(course.stray, std::abs(course.plane.normal.dot(p - middle)));
  course.stray *= std::max(1.0, wide * h / std::sqrt(axes.eigenvalues()[1]));
  return course;
}

/// A surface of the second degree in the place along a plane, nearest to points along its normal. What strays from it
/// strays farther where it is drawn out beyond them: by the factor by which random errors would grow.
class BentCourse {
 public:
  BentCourse(const Points& points, const Vec3& origin, const Vec3& normal, const double h)
    : origin_(origin), u_(normal.unitOrthogonal()), v_(normal.cross(u_)), w_(normal), h_(h) {
    constexpr double least = 1e-9; // so that points which leave it open are an equation too
    Eigen::Matrix<double, 6, 6> sum = least * Eigen::Matrix<double, 6, 6>::Identity();
    Row right = Row::Zero();
    for (const Vec3& p : points) {
      const Row row = row_at(p);
      sum += row * row.transpose() / double(points.size());
      right += w_.dot(p - origin_) / h_ * row / double(points.size());
    }
    sum_.compute(sum);
    a_ = sum_.solve(right);
    for (const Vec3& p : points)
      stray_ = std::max(stray_, std::abs(w_.dot(p - origin_) / h_ - a_.dot(row_at(p))));
  }

  Plane plane() const { return {origin_ + h_ * a_[0] * w_, (w_ - a_[1] * u_ - a_[2] * v_) / steepness()}; }
  Mat3 bend() const {
    return (a_[3] * u_ * u_.transpose() + a_[4] * (u_ * v_.transpose() + v_ * u_.transpose()) +
            a_[5] * v_ * v_.transpose()) /
           (steepness() * h_);
  }
  double stray(const Vec3& p) const {
    constexpr double least = 0.005; // of a cube: what cuts of a body in motion are known by
    const Row row = row_at(p);
    return h_ * std::max(least, stray_) * std::max(1.0, std::sqrt(row.dot(sum_.solve(row)) / 6));
  }

 private:
  using Row = Eigen::Matrix<double, 6, 1>;
  Row row_at(const Vec3& p) const {
    const double x = u_.dot(p - origin_) / h_, y = v_.dot(p - origin_) / h_;
    return Row{{1, x, y, 0.5 * x * x, x * y, 0.5 * y * y}};
  }
  double steepness() const { return std::sqrt(1 + a_[1] * a_[1] + a_[2] * a_[2]); }

  Vec3 origin_, u_, v_, w_;
  double h_, stray_ = 0;
  Row a_; // in cubes
  Eigen::LDLT<Eigen::Matrix<double, 6, 6>> sum_;
};

/// As the predicates have it, by which blades cut (geometry/predicates.h): what lies right in a plane is behind it
/// along the first axis that is not in the plane.
Plane displaced(const Plane& plane, const double distance) {
  int axis = 0;
  while (std::abs(plane.normal[axis]) < in_plane)
    ++axis;
  return {plane.point + (plane.normal[axis] > 0 ? distance : -distance) * plane.normal, plane.normal};
}

/// Two parts, with nodes in each.
bool parts_in_two(const Solid& solid, const Front& front) {
  const grid::Parts parts = grid::parts_of(grid::with(grid::cuts_of(solid, front.cell), front.ahead));
  return parts.n == 2 && std::ranges::all_of(parts, [](const grid::Part& part) { return part.nodes != 0; });
}

/// Would these cuts come between the nodes of a front's cell?
bool parts_nodes(const Solid& solid, const Front& front, const grid::Segments blades) {
  grid::CellCuts cuts = grid::cuts_of(solid, front.cell);
  cuts.blades = blades;
  return std::ranges::count_if(grid::whole_parts_of(cuts), [](const grid::Part& part) { return part.nodes != 0; }) > 1;
}

/// Where the front's plane crosses a segment of its cell, from the first end to the second [1].
double crossing(const Solid& solid, const Front& front, const std::array<std::uint8_t, 2>& ends) {
  const auto height = [&](const int item) {
    return front.normal.dot(grid::item_point(solid, front.cell, item) - front.point);
  };
  const double a = height(ends[0]), b = height(ends[1]);
  return (a >= 0) == (b >= 0) ? 0.5 : std::clamp(a / (a - b), grid::min_edge_parameter, 1 - grid::min_edge_parameter);
}

/// Do the parts of two cells divide the face between them alike, or does one of the cells hold it together?
bool divide_alike(const grid::Parts& one, const grid::Parts& other, const int face) {
  const auto divided = [](const grid::Parts& parts, const int side) {
    std::set<unsigned> in_face;
    for (const grid::Part& part : parts)
      if (const unsigned bits = grid::detail::in_face(part, side); bits != 0)
        in_face.insert(bits);
    return in_face;
  };
  const std::set<unsigned> a = divided(one, face), b = divided(other, face ^ 1);
  return a.size() < 2 || b.size() < 2 || a == b;
}

/// What the copies of a cell would follow, with a front in some cell and those of `begun`.
grid::CellCuts cuts_with(const Solid& solid, const CellId c, const Front& front, const FrontsOfCells& begun) {
  if (c == front.cell)
    return grid::with(grid::cuts_of(solid, c), front.ahead);
  if (const auto at = begun.find(c); at != begun.end())
    return grid::with(grid::cuts_of(solid, c), at->second.ahead);
  const Front* const earlier = solid.cuts.front(c); // which may be about to be taken back
  return earlier && !is_ahead(solid, *earlier) ? grid::cuts_of(solid, c) : grid::cuts_of_copies(solid, c);
}

bool agrees_with_neighbours(const Solid& solid, const Front& front, const FrontsOfCells& begun) {
  const auto parts = [&](const CellId c) { return grid::parts_of(cuts_with(solid, c, front, begun)); };
  const grid::Parts own = parts(front.cell);
  for (int face = 0; face < grid::cube::n_faces; ++face)
    if (const CellId next = solid.grid.neighbour(front.cell, face);
        next.valid() && !divide_alike(own, parts(next), face))
      return false;
  return true;
}

/// Would a part of the cell hang together with hardly anything?
bool leaves_shreds(const Solid& solid, const Front& front, const FrontsOfCells& begun) {
  const auto cuts_of = [&](const CellId c) { return cuts_with(solid, c, front, begun); };
  const grid::Parts parts = grid::parts_of(cuts_of(front.cell));
  return std::ranges::any_of(parts, [&](const grid::Part& part) {
    return is_small(solid, front.cell, std::countr_zero(part.items()), cuts_of);
  });
}

/// With more cuts in and around a cell?
bool leaves_shreds(const Solid& solid, const CellId c, const SweepCuts& more) {
  const auto cuts_of = [&](const CellId cell) {
    const auto edges = solid.grid.edges(cell);
    grid::Segments cut = 0;
    for (const grid::EdgeCut& one : more.cuts)
      if (const auto at = std::ranges::find(edges, one.edge); at != edges.end())
        cut |= grid::Segments(1) << (at - edges.begin());
    const grid::CellCuts cuts = grid::cuts_of(solid, cell);
    for (grid::Segments left = more.of_skin.empty() ? 0 : cuts.skeleton().segments & ~skeleton::lines; left != 0;
         left &= left - 1)
      if (const auto one = grid::skin_segment(solid.grid, cell, std::countr_zero(left));
          std::ranges::find(more.of_skin, one, &grid::SkinCut::segment) != more.of_skin.end())
        cut |= left & -left;
    return grid::with(cuts, cut);
  };
  const grid::Parts parts = grid::parts_of(cuts_of(c));
  return std::ranges::any_of(parts, [&](const grid::Part& part) {
    return is_small(solid, c, std::countr_zero(part.items()), cuts_of);
  });
}

std::optional<Front> front_of(const Solid& solid, const CellAtPlane& cell, const grid::CutLabel label) {
  if (!cell.is_met())
    return std::nullopt;
  Front front = cell.front(cell.section(), 0);
  front.label = label;
  return front.ahead != 0 && parts_in_two(solid, front) && !hangs_by_skin(solid, front) ? std::optional(front)
                                                                                        : std::nullopt;
}

/// Lie the nodes of what is to be one part in one copy now, and in the faces between it and those that have the rest of
/// it, skin alone, no wound that gapes? Then that goes over to it, and no corner is joined to another far away.
bool gains_skin_alone(const Solid& solid, const CellId c, const grid::Part& part, const Points& x) {
  grid::CopyId own;
  for (const grid::CopyId copy : solid.complex.copies_of(c))
    if ((solid.complex.copies[copy].nodes & part.nodes) != 0) {
      if (own.valid())
        return false;
      own = copy;
    }
  if (!own.valid())
    return false;
  for (const grid::CopyId copy : solid.complex.copies_of(c)) {
    const grid::Items gained = solid.complex.copies[copy].items() & part.items();
    if (copy != own && gained != 0 &&
        (solid.complex.copies[copy].nodes == 0 || !are_near_at(solid, own, copy, gained, x)))
      return false;
  }
  return true;
}

} // namespace

std::vector<CellId> cells_around(const grid::Grid& grid, const CellId c) {
  std::vector<CellId> cells = {c};
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0, n = cells.size(); i < n; ++i)
      for (const int side : {0, 1})
        if (const CellId next = grid.neighbour(cells[i], 2 * axis + side); next.valid())
          cells.push_back(next);
  return cells;
}

std::optional<Front> front_ahead(const Solid& solid, const CellId c, const std::vector<Polygon>& pieces,
                                 const grid::CutLabel label, const Ahead ahead,
                                 const FunctionRef<void(Points&)> add_around) {
  constexpr double safety = 2;
  const double h = solid.grid.h();
  Points points = known_points(solid, c, pieces, label);
  const std::optional<Course> course = course_of(points, h);
  if (!course)
    return std::nullopt;
  const auto corners = rest_of(solid, c);
  const CellAtPlane flat(solid, c, displaced(course->plane, in_plane * h), corners);
  const double margin = std::max(safety * course->stray, 0.9 * in_plane * h);
  if (flat.is_clear([&](const Vec3&) { return margin; }))
    return front_of(solid, flat, label);
  add_around(points);
  const BentCourse bent(points, solid.grid.origin(c) + Vec3::Constant(0.5 * h), course->plane.normal, h);
  CellAtPlane at_bent(solid, c, bent.plane(), corners, bent.bend());
  constexpr double any = -1, vague = 0.25; // of a cube
  double most = 0;
  for (const Vec3& p : corners)
    most = std::max(most, bent.stray(p));
  const bool is_known = ahead == Ahead::ends && most < vague * h;
  if (is_known)
    at_bent.follow_cuts(most);
  if (at_bent.is_clear([&](const Vec3& p) { return is_known ? any : bent.stray(p); }))
    return front_of(solid, at_bent, label);
  return std::nullopt;
}

bool is_along(const Front& front, const Plane& plane, const double h) {
  constexpr double turned = 0.2, off = 0.1; // sine of the angle; of a cube
  return plane.normal.cross(front.normal).norm() < turned &&
         std::abs(front.normal.dot(plane.point - front.point)) < off * h;
}

bool is_along(const Front& front, const std::vector<Polygon>& pieces, const double h) {
  Points points;
  for (const Polygon& piece : pieces)
    points.insert(points.end(), piece.begin(), piece.end());
  const std::optional<Course> course = course_of(points, h);
  return course && is_along(front, course->plane, h);
}

bool fits_in(const Solid& solid, const Front& front, const FrontsOfCells& begun) {
  return agrees_with_neighbours(solid, front, begun) && !leaves_shreds(solid, front, begun);
}

bool is_ahead(const Solid& solid, const Front& front) {
  const grid::Segments by_others = front.ahead & grid::cuts_of(solid, front.cell).blades;
  return !parts_nodes(solid, front, grid::cut_by(solid, front.cell, front.label) | by_others);
}

SweepCuts cuts_between_gaping(const Solid& solid, const Front& front, const Points& x) {
  SweepCuts between;
  const CellId c = front.cell;
  const grid::CellCuts cuts = grid::cuts_of(solid, c);
  const auto edges = solid.grid.edges(c);
  for (const grid::Part& part : grid::whole_parts_of(cuts)) {
    if (gains_skin_alone(solid, c, part, x))
      continue;
    for (grid::Segments left = front.ahead & ~cuts.blades; left != 0; left &= left - 1) {
      const int segment = std::countr_zero(left);
      const auto& ends = cuts.skeleton().segment[segment].ends;
      const auto holds = [&](const int item) { return (part.items() >> item & 1) != 0; };
      if (!holds(ends[0]) || !holds(ends[1]) || are_near(solid, c, ends, x))
        continue;
      const double t = crossing(solid, front, ends);
      if (segment >= skeleton::first_half) {
        between.of_skin.push_back({grid::skin_segment(solid.grid, c, segment), t, front.normal, front.label});
        continue;
      }
      const auto along = [&](const int item) { // the edge; the end of one of the skin is a point of that
        const auto& [lower, upper] = grid::cube::line_vertices[segment];
        return item == lower ? 0 : item == upper ? 1 : solid.cuts.find_outer(edges[segment])->t;
      };
      between.cuts.push_back({edges[segment], std::lerp(along(ends[0]), along(ends[1]), t), front.normal, front.label});
    }
  }
  const bool is_any = !between.cuts.empty() || !between.of_skin.empty();
  return is_any && leaves_shreds(solid, c, between) ? SweepCuts() : between;
}

} // namespace kerf::cut
