#include "cut/cell_at_plane.h"

#include "grid/material.h"
#include "grid/shape.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

namespace kerf::cut {

namespace {

namespace cube = grid::cube;
namespace skeleton = grid::skeleton;
using grid::Segments;

constexpr double little_room = 1e-3; // of a cube

/// The order of a convex polygon's points around it.
std::vector<std::size_t> order_around(const Polygon& points, const Vec3& normal) {
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u), middle = mean(points);
  std::vector<double> angle; // in quarters of a turn, nearly: in the same order
  for (const Vec3& p : points) {
    const double x = u.dot(p - middle), y = v.dot(p - middle), size = std::abs(x) + std::abs(y);
    angle.push_back(size > 0 ? std::copysign(1 - x / size, y) : 0);
  }
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](const std::size_t i) { return angle[i]; });
  return order;
}

Polygon in_order(const Polygon& points, const std::vector<std::size_t>& order) {
  Polygon result;
  for (const std::size_t i : order)
    result.push_back(points[i]);
  return result;
}

} // namespace

std::array<Vec3, 8> rest_of(const grid::Solid& solid, const grid::CellId c) {
  std::array<Vec3, 8> corners;
  std::ranges::transform(solid.grid.nodes(c), corners.begin(),
                         [&](const grid::NodeId node) { return solid.grid.position(node); });
  return corners;
}

double area(const Polygon& polygon) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 2; i < polygon.size(); ++i)
    sum += (polygon[i - 1] - polygon[0]).cross(polygon[i] - polygon[0]);
  return 0.5 * sum.norm();
}

Polygon clipped(const Polygon& polygon, const HalfSpace& side) {
  return clipped(
    polygon, [&](const Vec3& p) { return side.beyond(p); },
    [](const Vec3& p, const Vec3& q, const double t) -> Vec3 { return p + t * (q - p); });
}

Vec3 mean(const Polygon& points) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points)
    sum += p;
  return sum / static_cast<double>(points.size());
}

Vec3 normal(const Polygon& points) {
  const Vec3 middle = mean(points);
  Mat3 spread = Mat3::Zero();
  for (const Vec3& p : points)
    spread += (p - middle) * (p - middle).transpose();
  return Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors().col(0);
}

CellAtPlane::CellAtPlane(const grid::Solid& solid, const grid::CellId c, const Plane& plane,
                         const std::array<Vec3, 8>& x, const Mat3& bend)
  : solid_(solid), cell_(c), plane_(plane), bend_(bend), x_(x), room_(1e-7 * solid.grid.h()) {
  for (int v = 0; v < cube::n_vertices; ++v) {
    height_[v] = height(x_[v]);
    above_ |= unsigned(height_[v] >= 0) << v;
  }
}

void CellAtPlane::follow_cuts(const double room) {
  room_ = std::max(room_, room);
  const grid::CellCuts cuts = grid::cuts_of(solid_, cell_);
  const grid::Skeleton& skeleton = cuts.skeleton();
  for (Segments left = cuts.blades & skeleton.segments & skeleton::lines; left != 0; left &= left - 1) {
    const auto& [v, w] = skeleton.segment[std::countr_zero(left)].ends;
    if (std::max(v, w) >= skeleton::first_on_line || (height_[v] >= 0) != (height_[w] >= 0))
      continue;
    const int nearer = std::abs(height_[v]) < std::abs(height_[w]) ? v : w;
    if (std::abs(height_[nearer]) > room_)
      continue;
    height_[nearer] = height_[nearer] >= 0 ? -std::numeric_limits<double>::min() : 0;
    above_ ^= 1u << nearer;
  }
}

bool CellAtPlane::is_clear(const FunctionRef<double(const Vec3&)> margin) const {
  const grid::CellCuts cuts = grid::cuts_of(solid_, cell_);
  const grid::Skeleton& skeleton = cuts.skeleton();
  for (grid::Items left = skeleton.items; left != 0; left &= left - 1) {
    const int item = std::countr_zero(left);
    const bool is_node = item < skeleton::first_on_line;
    const Vec3 place = is_node ? x_[item] : position(item);
    if (std::abs(is_node ? height_[item] : height(place)) <= margin(place))
      return false;
  }
  const auto heights = heights_of_items(cuts);
  for (Segments left = cuts.blades & skeleton.segments; left != 0; left &= left - 1)
    if (const auto& [a, b] = skeleton.segment[std::countr_zero(left)].ends; (heights[a] >= 0) == (heights[b] >= 0))
      return false;
  return true;
}

/// The height at which the plane has a section with an area.
double CellAtPlane::level() const {
  const auto [least, most] = std::minmax_element(height_.begin(), height_.end());
  const double room = std::min(little_room * solid_.grid.h(), 0.25 * (*most - *least));
  return std::clamp(0.0, *least + room, *most - room);
}

CellAtPlane::Section CellAtPlane::section() const {
  const double level = this->level();
  const auto nodes = solid_.grid.nodes(cell_);
  Section section;
  for (const auto& [v, w] : cube::line_vertices) {
    const double at_v = height_[v] - level, at_w = height_[w] - level;
    if ((at_v >= 0) == (at_w >= 0))
      continue;
    const double t = at_v / (at_v - at_w);
    const Vec3 p = solid_.grid.position(nodes[v]), q = solid_.grid.position(nodes[w]);
    section.there.push_back(x_[v] + t * (x_[w] - x_[v]));
    section.rest.push_back(p + t * (q - p));
  }
  const auto order = order_around(section.there, plane_.normal);
  return {in_order(section.there, order), in_order(section.rest, order)};
}

/// A little above the plane, as what is cut already has its vertices in it.
std::vector<Polygon> CellAtPlane::material() const {
  if (grid::material_of(solid_.grid, cell_) == 0xff)
    return {section().there};
  const grid::CellCuts cuts = grid::cuts_of(solid_, cell_);
  grid::Copy whole{.cell = cell_, .nodes = static_cast<std::uint8_t>(cuts.material), .corners = {}, .next = {}};
  if (grid::cuts_of_copies(solid_, cell_).is_cut_at_skin()) // which its copies may not know yet
    whole.skin = grid::Part::of(cuts.skeleton().items).skin;
  const double level = this->level() + little_room * solid_.grid.h();
  std::vector<Polygon> pieces;
  grid::for_each_tetrahedron(solid_, whole, [&](const grid::Tetrahedron& xi, int) {
    std::array<Vec3, 4> p;
    std::ranges::transform(xi, p.begin(), [&](const Vec3& at) { return mapped(at); });
    Polygon piece;
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j)
        if (const double at_i = height(p[i]) - level, at_j = height(p[j]) - level; (at_i >= 0) != (at_j >= 0))
          piece.push_back(p[i] + at_i / (at_i - at_j) * (p[j] - p[i]));
    if (piece.empty())
      return;
    pieces.push_back(in_order(piece, order_around(piece, plane_.normal)));
  });
  return pieces;
}

grid::Front CellAtPlane::front(const Section& section, const double passed) const {
  return {.cell = cell_,
          .ahead = ahead(),
          .point = mean(section.rest),
          .normal = normal(section.rest),
          .passed = std::min(most_passed, passed)};
}

Segments CellAtPlane::ahead() const {
  const grid::CellCuts cuts = grid::cuts_of(solid_, cell_);
  const grid::Skeleton& skeleton = cuts.skeleton();
  const auto heights = heights_of_items(cuts);
  Segments found = 0;
  for (Segments left = skeleton.segments & ~cuts.blades; left != 0; left &= left - 1)
    if (const auto& [a, b] = skeleton.segment[std::countr_zero(left)].ends; (heights[a] >= 0) != (heights[b] >= 0))
      found |= left & -left;
  return found;
}

/// Signed like the side of the plane. Of what lies right in the plane the cut itself has said on which side it is.
std::array<double, skeleton::n_items> CellAtPlane::heights_of_items(const grid::CellCuts& cuts) const {
  const grid::Skeleton& skeleton = cuts.skeleton();
  std::array<double, skeleton::n_items> heights{};
  for (grid::Items left = skeleton.items; left != 0; left &= left - 1) {
    const int item = std::countr_zero(left);
    heights[item] = item < skeleton::first_on_line ? height_[item] : height(position(item));
  }
  for (const Segments kind : {skeleton::lines, ~skeleton::lines & ~skeleton::spokes, skeleton::spokes})
    for (Segments left = skeleton.segments & cuts.blades & kind; left != 0; left &= left - 1) {
      const auto& [a, b] = skeleton.segment[std::countr_zero(left)].ends;
      for (const auto& [p, q] : {std::pair{a, b}, std::pair{b, a}})
        if (p >= skeleton::first_on_line && std::abs(heights[p]) < room_)
          heights[p] = heights[q] >= 0 ? -1 : 1;
    }
  return heights;
}

Vec3 CellAtPlane::position(const int item) const {
  return mapped((grid::item_point(solid_, cell_, item) - solid_.grid.origin(cell_)) / solid_.grid.h());
}

Vec3 CellAtPlane::mapped(const Vec3& xi) const {
  return grid::interpolated(xi, [&](const int v) { return x_[v]; });
}

bool hangs_by_skin(const grid::Solid& solid, const grid::Front& front) {
  constexpr unsigned nodes = 0xf;
  const grid::Parts parts = grid::parts_of(grid::with(grid::cuts_of(solid, front.cell), front.ahead));
  for (int face = 0; face < cube::n_faces; ++face)
    if (solid.grid.neighbour(front.cell, face).valid())
      for (const grid::Part& part : parts)
        if (const unsigned items = grid::detail::in_face(part, face); items != 0 && (items & nodes) == 0)
          return true;
  return false;
}

} // namespace kerf::cut
