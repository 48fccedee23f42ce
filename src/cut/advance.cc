#include "cut/advance.h"

#include "cut/cell_at_plane.h"
#include "grid/fronts.h"
#include "grid/material.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <bit>
#include <cmath>

namespace kerf::cut {

namespace {

using grid::CellId;
using grid::Front;
using grid::Solid;

constexpr double off_plane = 0.25;    // what counts [cubes]

/// A cell's coordinates in which its cube is [0, h]^3 at its place at rest, as an affine map from where it is.
struct ToRest {
  ToRest(const Solid& solid, const CellId c, const Points& x) : origin(solid.grid.origin(c)) {
    const grid::Copy& copy = solid.complex.copies[solid.complex.first_copy[c]];
    Mat3 along = Mat3::Zero();
    for (int v = 0; v < 8; ++v) {
      const Vec3& p = x[copy.corners[v].value];
      middle += p / 8;
      for (int axis = 0; axis < 3; ++axis)
        along.col(axis) += ((v >> axis & 1) != 0 ? 0.25 : -0.25) * p;
    }
    const double h = solid.grid.h();
    bool invertible = false;
    Mat3 inverse;
    along.computeInverseWithCheck(inverse, invertible, 1e-6 * h * h * h);
    from = invertible ? Mat3(h * inverse) : Mat3(Mat3::Zero());
    origin += Vec3::Constant(0.5 * h);
  }
  Vec3 operator()(const Vec3& p) const { return origin + from * (p - middle); }

  Vec3 origin, middle = Vec3::Zero();
  Mat3 from;
};

/// Coordinates in a plane and above it, in cubes.
struct InPlane {
  InPlane(const Vec3& point, const Vec3& normal, const double h)
    : origin(point), u(normal.unitOrthogonal() / h), v(normal.cross(u)), w(normal / h) {}
  Vec3 operator()(const Vec3& p) const { return {u.dot(p - origin), v.dot(p - origin), w.dot(p - origin)}; }

  Vec3 origin, u, v, w;
};

std::array<Vec3, 8> rest_of(const Solid& solid, const CellId c) {
  std::array<Vec3, 8> corners;
  std::ranges::transform(solid.grid.nodes(c), corners.begin(),
                         [&](const grid::NodeId node) { return solid.grid.position(node); });
  return corners;
}

/// Where a plane meets a tetrahedron, of coordinates above it and in it: up to four points, around.
void draw_section(const std::array<Vec3, 4>& tetrahedron, Raster& raster) {
  std::array<Vec3, 4> points;
  int n = 0;
  constexpr std::array<std::array<int, 2>, 6> around = {{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
  for (const auto& [i, j] : around) {
    const Vec3 &p = tetrahedron[i], &q = tetrahedron[j];
    if ((p[2] >= 0) != (q[2] >= 0))
      points[n++] = p + p[2] / (p[2] - q[2]) * (q - p);
  }
  for (int i = 0; i < n; ++i) // all triangles of the points cover what they span
    for (int j = i + 1; j < n; ++j)
      for (int k = j + 1; k < n; ++k)
        raster.draw({points[i], points[j], points[k]}, 1);
}

/// Where a plane meets the material of a cell.
Raster section_of(const Solid& solid, const CellId c, const InPlane& in_plane) {
  Raster section;
  const Vec3 origin = solid.grid.origin(c);
  grid::for_each_tetrahedron(solid, solid.complex.copies[solid.complex.first_copy[c]],
                             [&](const grid::Tetrahedron& rest, int) {
                               std::array<Vec3, 4> points;
                               std::ranges::transform(rest, points.begin(), [&](const Vec3& xi) {
                                 return in_plane(origin + solid.grid.h() * xi);
                               });
                               draw_section(points, section);
                             });
  return section;
}

/// A cell's cube at rest, and around it what a front in another cell may reach over by its lag.
Box reach_of(const Solid& solid, const CellId c) {
  const double h = solid.grid.h(), lag = grid::front_lag * std::sqrt(3.0) * h;
  const Vec3 origin = solid.grid.origin(c);
  return {origin - Vec3::Constant(lag), origin + Vec3::Constant(h + lag)};
}

bool is_in(const Box& box, const Patch& quad) {
  const Box around = geometry::box_around(quad);
  return (around.lower.array() <= box.upper.array()).all() && (box.lower.array() <= around.upper.array()).all();
}

Polygon clipped(Polygon polygon, const Box& box) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const double end = side * (side > 0 ? box.upper : box.lower)[axis];
      Polygon kept;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        const double at_p = side * p[axis] - end, at_q = side * q[axis] - end;
        if (at_p <= 0)
          kept.push_back(p);
        if ((at_p < 0 && at_q > 0) || (at_p > 0 && at_q < 0))
          kept.push_back(p + at_p / (at_p - at_q) * (q - p));
      }
      polygon = std::move(kept);
    }
  return polygon;
}

/// Draws the pieces of a path in cells.
class Sweep {
 public:
  Sweep(const BladePath& path, const Solid& solid, const Points& x_before, const Points& x)
    : path_(path), solid_(solid), x_before_(x_before), x_(x), near_(patches(path)) {}

  bool is_near(const EdgeBoxes::Block& block) const {
    const Vec3 slack = Vec3::Constant(2 * block.longest);
    return near_.may_be_in({block.box.lower - slack, block.box.upper + slack});
  }
  bool is_near(const CellId c) const {
    const grid::Copy& copy = solid_.complex.copies[solid_.complex.first_copy[c]];
    std::array<Vec3, 16> corners;
    for (int v = 0; v < 8; ++v) {
      corners[v] = x_[copy.corners[v].value];
      corners[8 + v] = x_before_[copy.corners[v].value];
    }
    Box box = geometry::box_around(corners);
    const Vec3 lag = Vec3::Constant(grid::front_lag * (box.upper - box.lower).sum());
    return near_.may_be_in({box.lower - lag, box.upper + lag});
  }

  /// Calls f(quad at rest) for what of the path may lie in the cell.
  template <class Function>
  void for_each_quad(const CellId c, const Function& f) const {
    const ToRest before(solid_, c, x_before_), now(solid_, c, x_);
    const Box reach = reach_of(solid_, c);
    const auto at = [&](const std::size_t k, const std::size_t i) {
      const double t = path_.fractions[k];
      const Vec3& p = path_.lines[k][i];
      return Vec3((1 - t) * before(p) + t * now(p));
    };
    for (std::size_t k = 1; k < path_.lines.size(); ++k)
      for (std::size_t i = 1; i < path_.lines[k].size(); ++i) {
        const Patch quad = {at(k - 1, i - 1), at(k - 1, i), at(k, i), at(k, i - 1)};
        if (is_in(reach, quad))
          f(quad);
      }
  }

 private:
  const BladePath& path_;
  const Solid& solid_;
  const Points &x_before_, &x_;
  NearSweep near_;
};

} // namespace

void Raster::draw(const std::array<Vec3, 3>& triangle, const double most) {
  const auto& [a, b, c] = triangle;
  const double twice_area = (b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0];
  if (twice_area == 0)
    return;
  const auto texel = [](const double at) {
    return static_cast<int>(std::clamp((at / side + 0.5) * n - 0.5, -1.0, double(n)));
  };
  const Vec3 lower = a.cwiseMin(b).cwiseMin(c), upper = a.cwiseMax(b).cwiseMax(c);
  for (int j = std::max(0, texel(lower[1])); j <= std::min(n - 1, texel(upper[1]) + 1); ++j)
    for (int i = std::max(0, texel(lower[0])); i <= std::min(n - 1, texel(upper[0]) + 1); ++i) {
      const double x = ((i + 0.5) / n - 0.5) * side, y = ((j + 0.5) / n - 0.5) * side;
      const auto weight = [&](const Vec3& p, const Vec3& q) {
        return ((q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])) / twice_area;
      };
      const double of_a = weight(b, c), of_b = weight(c, a), of_c = weight(a, b);
      if (of_a >= 0 && of_b >= 0 && of_c >= 0 && std::abs(of_a * a[2] + of_b * b[2] + of_c * c[2]) <= most)
        rows_[j] |= std::uint64_t(1) << i;
    }
}

Raster Raster::grown(const double distance) const {
  const double radius = distance / side * n;
  Raster result;
  const int reach = static_cast<int>(std::lround(radius));
  for (int dj = -reach; dj <= reach; ++dj) {
    const long width = std::lround(std::sqrt(std::max(0.0, radius * radius - dj * dj)));
    for (int j = std::max(0, -dj); j < std::min(n, n - dj); ++j)
      for (int di = 0; di <= width && rows_[j] != 0; ++di)
        result.rows_[j + dj] |= rows_[j] << di | rows_[j] >> di;
  }
  return result;
}

int Raster::count() const {
  int sum = 0;
  for (const std::uint64_t row : rows_)
    sum += std::popcount(row);
  return sum;
}

Raster operator&(Raster a, const Raster& b) {
  for (int j = 0; j < Raster::n; ++j)
    a.rows_[j] &= b.rows_[j];
  return a;
}

void Advance::sweep(const BladePath& path, const Solid& solid, const Points& x_before, const Points& x,
                    const EdgeBoxes& boxes, const grid::CutLabel label) {
  const Sweep sweep(path, solid, x_before, x);
  for (const std::uint32_t k : boxes.blocks([&](const EdgeBoxes::Block& block) { return sweep.is_near(block); }))
    boxes.for_each_cell(k, [&](const CellId c) {
      const bool is_whole = !solid.complex.copies[solid.complex.first_copy[c]].next.valid();
      if ((is_whole || cells_.contains(c)) && sweep.is_near(c))
        sweep.for_each_quad(c, [&](const Patch& quad) { draw(solid, c, quad, label); });
    });
}

void Advance::draw(const Solid& solid, const CellId c, const Patch& quad, const grid::CutLabel label) {
  const double h = solid.grid.h();
  auto at = cells_.find(c);
  if (at == cells_.end()) {
    const std::optional<Cell> begun = begin(solid, c, quad, label);
    if (!begun)
      return;
    at = cells_.emplace(c, *begun).first;
  }
  Cell& cell = at->second;
  if (cell.label != label)
    return;
  const InPlane in_plane(cell.point, cell.normal, h);
  const Vec3 a = in_plane(quad[0]), b = in_plane(quad[1]), c_ = in_plane(quad[2]), d = in_plane(quad[3]);
  cell.swept.draw({a, b, c_}, off_plane);
  cell.swept.draw({a, c_, d}, off_plane);
  touched_.insert(c);
}

std::optional<Advance::Cell> Advance::begin(const Solid& solid, const CellId c, const Patch& quad,
                                            const grid::CutLabel label) {
  constexpr double least_area = 1e-6; // of a face
  const double h = solid.grid.h();
  const Polygon piece = clipped({quad.begin(), quad.end()}, reach_of(solid, c));
  if (area(piece) < least_area * h * h)
    return std::nullopt;
  const CellAtPlane at_plane(solid, c, {mean(piece), normal(piece)}, rest_of(solid, c));
  if (!at_plane.is_met())
    return std::nullopt;
  const Front front = at_plane.front(at_plane.section(), 0);
  const Raster section = section_of(solid, c, InPlane(front.point, front.normal, h));
  if (!section.any())
    return std::nullopt;
  return Cell{front.point, front.normal, section, {}, label};
}

std::vector<Front> Advance::take(const Solid& solid, const PendingCuts& pending) {
  std::vector<Front> fronts;
  std::set<CellId> later;
  for (const CellId c : touched_) {
    if (grid::whole_parts_of(grid::cuts_of(solid, c)).n > 1) {
      cells_.erase(c);
      continue;
    }
    const auto edges = solid.grid.edges(c);
    if (std::ranges::any_of(edges, [&](const grid::EdgeId e) { return pending.waits(e); }))
      later.insert(c);
    else if (const std::optional<Front> front = front_in(solid, c))
      fronts.push_back(*front);
  }
  touched_ = std::move(later);
  return fronts;
}

/// Is the blade in the material of the cell, or of one beside it?
bool Advance::is_in_material(const Solid& solid, const CellId c) const {
  const auto is_in = [&](const CellId cell) {
    if (const auto at = cells_.find(cell); at != cells_.end())
      return (at->second.section & at->second.swept).any();
    return cell.valid() && grid::cuts_of(solid, cell).blades != 0;
  };
  bool found = is_in(c);
  for (int face = 0; face < grid::cube::n_faces && !found; ++face)
    found = is_in(solid.grid.neighbour(c, face));
  return found;
}

/// As it is now, if that is further than it was.
std::optional<Front> Advance::front_in(const Solid& solid, const CellId c) const {
  const Cell& cell = cells_.at(c);
  const bool has_skin = grid::material_of(solid.grid, c) != 0xff;
  const Raster come =
    cell.section & (has_skin ? cell.swept : cell.swept.grown(grid::front_lag * cell.normal.lpNorm<1>()));
  const double now = double(come.count()) / cell.section.count();
  if (const Front* const earlier = solid.cuts.front(c)) {
    Front moved = *earlier;
    moved.passed = std::min(most_passed, now);
    return moved.passed > earlier->passed ? std::optional(moved) : std::nullopt;
  }
  if (now < least_passed || !is_in_material(solid, c))
    return std::nullopt;
  const CellAtPlane at_plane(solid, c, {cell.point, cell.normal}, rest_of(solid, c));
  Front front = at_plane.front(at_plane.section(), now);
  front.label = cell.label;
  return front.ahead != 0 && !hangs_by_skin(solid, front) ? std::optional(front) : std::nullopt;
}

} // namespace kerf::cut
