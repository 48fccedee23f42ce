#include "cut/passed.h"

#include "base/convex_polygon.h"
#include "base/parallel.h"
#include "cut/near_sweep.h"
#include "grid/material.h"
#include "grid/shape.h"
#include "grid/touched.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>

namespace kerf::cut {

namespace {

bool meets(const std::array<Vec3, 3>& triangle, const grid::Tetrahedron& tetrahedron) {
  constexpr double shrunk = 1 - 1e-6;
  const Vec3 middle = 0.25 * (tetrahedron[0] + tetrahedron[1] + tetrahedron[2] + tetrahedron[3]);
  std::array<Vec3, 4> v;
  for (int i = 0; i < 4; ++i)
    v[i] = shrunk * (tetrahedron[i] - middle);
  ConvexPolygon<7> polygon; // the triangle, and a vertex for each side of the tetrahedron
  for (const Vec3& p : triangle)
    polygon.push_back(p - middle);
  for (int i = 0; i < 4 && polygon.n > 0; ++i) {
    const Vec3 &a = v[(i + 1) % 4], &b = v[(i + 2) % 4], &c = v[(i + 3) % 4];
    const Vec3 n = (b - a).cross(c - a);
    const double d = n.dot(a); // the middle is at 0
    if (d == 0)
      return false; // flat
    polygon = clipped(polygon, d < 0 ? n : Vec3(-n), -std::abs(d));
  }
  return polygon.n > 0;
}

/// Finds the cells in some blocks that a strip passes.
class Search {
 public:
  Search(const std::span<const SweptTriangle> strip, const SweepCuts& found, const grid::Solid& solid,
         const Points& x_before, const Points& x, const grid::CutLabel label)
    : strip_(strip), near_(patches_of(strip)), solid_(solid), x_before_(x_before), x_(x), label_(label) {
    std::vector<grid::EdgeId> edges;
    for (const grid::EdgeCut& cut : found.cuts)
      edges.push_back(cut.edge);
    std::vector<grid::SkinSegment> segments;
    for (const grid::SkinCut& cut : found.of_skin)
      segments.push_back(cut.segment);
    met_ = grid::touched_cells(solid.grid, edges, segments);
  }

  bool is_near(const EdgeBoxes::Block& block) const { return near_.may_be_in(block.around_cells()); }

  /// `room`: no corner of a copy lies further from the middle between its first and its last one [m]. That is 1.5 of
  /// the longest edge at most, by any way along three edges.
  bool passes(const grid::CellId cell, const double room) const {
    for (const grid::CopyId c : solid_.complex.copies_of(cell)) {
      const grid::Copy& copy = solid_.complex.copies[c];
      const Vec3 middle = middle_of(copy, x_), way = middle - middle_of(copy, x_before_);
      if (((near_.reach().lower - middle.cwiseMax(middle - way)).array() > room).any() ||
          ((middle.cwiseMin(middle - way) - near_.reach().upper).array() > room).any())
        continue;
      const std::array<Vec3, 8> corners = grid::corners_of(copy, x_);
      const Box now = geometry::box_around(corners);
      const Box box{now.lower.cwiseMin(now.lower - way), now.upper.cwiseMax(now.upper - way)};
      bool found = false;
      near_.for_each(box, [&](const std::size_t i) {
        std::array<Vec3, 3> triangle = strip_[i].vertices;
        for (int v = 0; v < 3; ++v)
          triangle[v] += strip_[i].left[v] * way;
        found = found || (are_parted(corners, triangle) && !is_cut_by_label(cell) && passes(copy, corners, triangle));
      });
      if (found)
        return true;
    }
    return false;
  }

 private:
  static std::vector<Patch> patches_of(const std::span<const SweptTriangle> strip) {
    std::vector<std::array<Vec3, 3>> triangles;
    for (const SweptTriangle& swept : strip)
      triangles.push_back(swept.vertices);
    return patches(triangles);
  }

  static Vec3 middle_of(const grid::Copy& copy, const Points& x) {
    return 0.5 * (x[copy.corners[0].value] + x[copy.corners[7].value]);
  }

  /// The material lies among its copy's corners. Round-off counts as parted.
  static bool are_parted(const std::array<Vec3, 8>& corners, const std::array<Vec3, 3>& triangle) {
    const Vec3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
    return !are_apart(corners, triangle, normal);
  }

  /// Do the vertices lie on both sides, where heights are trilinear?
  static bool are_parted(const std::array<double, 8>& heights, const grid::Tetrahedron& tetrahedron) {
    int n_above = 0;
    for (const Vec3& p : tetrahedron) {
      std::array<double, 4> of_x;
      for (int i = 0; i < 4; ++i)
        of_x[i] = heights[2 * i] + p[0] * (heights[2 * i + 1] - heights[2 * i]);
      const double lower = of_x[0] + p[1] * (of_x[1] - of_x[0]), upper = of_x[2] + p[1] * (of_x[3] - of_x[2]);
      n_above += lower + p[2] * (upper - lower) > 0;
    }
    return n_above != 0 && n_above != 4;
  }

  bool is_cut_by_label(const grid::CellId cell) const {
    if (std::ranges::binary_search(met_, cell))
      return true;
    return grid::cut_by(solid_, cell, label_) != 0;
  }

  bool passes(const grid::Copy& copy, const std::array<Vec3, 8>& corners, const std::array<Vec3, 3>& triangle) const {
    const Vec3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
    std::array<double, 8> heights;
    for (int v = 0; v < 8; ++v)
      heights[v] = normal.dot(corners[v] - triangle[0]);
    bool found = false;
    grid::for_each_tetrahedron(solid_, copy, [&](const grid::Tetrahedron& rest, int) {
      if (found || !are_parted(heights, rest))
        return;
      grid::Tetrahedron now;
      std::ranges::transform(rest, now.begin(), [&](const Vec3& xi) {
        return grid::interpolated(xi, [&](const int v) { return corners[v]; });
      });
      found = meets(triangle, now);
    });
    return found;
  }

  std::span<const SweptTriangle> strip_;
  NearSweep near_;
  const grid::Solid& solid_;
  const Points &x_before_, &x_;
  grid::CutLabel label_;
  std::vector<grid::CellId> met_; // in which it cuts now
};

} // namespace

std::vector<SweptTriangle> swept_triangles(const BladePath& path) {
  std::vector<SweptTriangle> swept;
  for (std::size_t k = 1; k < path.lines.size(); ++k) {
    std::vector<std::array<Vec3, 3>> strip;
    add_strip(path.lines[k - 1], path.lines[k], strip);
    const double before = 1 - path.fractions[k - 1], after = 1 - path.fractions[k];
    for (std::size_t i = 0; i < strip.size(); ++i) // two a piece of the edge: with two vertices before, and with one
      swept.push_back({strip[i], {before, i % 2 == 0 ? before : after, after}});
  }
  return swept;
}

void PassedCells::pass(const std::span<const SweptTriangle> strip, const SweepCuts& found, const grid::Solid& solid,
                       const Points& x_before, const Points& x, const EdgeBoxes& boxes, const grid::CutLabel label) {
  if (strip.empty())
    return;
  const Search search(strip, found, solid, x_before, x, label);
  const auto blocks = boxes.blocks([&](const EdgeBoxes::Block& block) { return search.is_near(block); });
  std::vector<std::vector<grid::CellId>> passed(blocks.size());
  parallel_for(blocks.size(), [&](const std::size_t k) {
    const double room = 2 * boxes.block(blocks[k]).longest;
    boxes.for_each_cell(blocks[k], [&](const grid::CellId c) {
      if (search.passes(c, room))
        passed[k].push_back(c);
    });
  });
  for (const auto& of_block : passed)
    cells_.insert(of_block.begin(), of_block.end());
}

void PassedCells::remove(const std::span<const grid::CellId> cells) {
  if (cells_.empty())
    return;
  for (const grid::CellId c : cells)
    if (c.valid())
      cells_.erase(c);
}

} // namespace kerf::cut
