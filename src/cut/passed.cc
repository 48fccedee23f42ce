#include "cut/passed.h"

#include "base/parallel.h"
#include "cut/near_sweep.h"
#include "grid/material.h"
#include "grid/shape.h"
#include "grid/touched.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace kerf::cut {

namespace {

using Polygon = std::vector<Vec3>;

/// The part of a convex polygon above the plane n . p = d.
void clip(Polygon& polygon, const Vec3& n, const double d) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double a = n.dot(p) - d, b = n.dot(q) - d;
    if (a > 0)
      kept.push_back(p);
    if ((a > 0) != (b > 0))
      kept.push_back(p + a / (a - b) * (q - p));
  }
  polygon = std::move(kept);
}

bool meets(const std::array<Vec3, 3>& triangle, const grid::Tetrahedron& tetrahedron) {
  constexpr double shrunk = 1 - 1e-6;
  const Vec3 middle = 0.25 * (tetrahedron[0] + tetrahedron[1] + tetrahedron[2] + tetrahedron[3]);
  std::array<Vec3, 4> v;
  for (int i = 0; i < 4; ++i)
    v[i] = shrunk * (tetrahedron[i] - middle);
  Polygon polygon;
  for (const Vec3& p : triangle)
    polygon.push_back(p - middle);
  for (int i = 0; i < 4 && !polygon.empty(); ++i) {
    const Vec3 &a = v[(i + 1) % 4], &b = v[(i + 2) % 4], &c = v[(i + 3) % 4];
    const Vec3 n = (b - a).cross(c - a);
    const double d = n.dot(a); // the middle is at 0
    if (d == 0)
      return false; // flat
    clip(polygon, d < 0 ? n : Vec3(-n), -std::abs(d));
  }
  return !polygon.empty();
}

/// Finds the cells in some blocks that a strip passes.
class Search {
 public:
  Search(const std::span<const std::array<Vec3, 3>> strip, const grid::Grid& grid, const grid::Cuts& cuts,
         const grid::CellComplex& complex, const Points& x, const grid::CutLabel label)
    : near_(patches(strip)), grid_(grid), cuts_(cuts), complex_(complex), x_(x), label_(label) {}

  /// Boxes hold the ends of edges alone; other corners of the cells may lie beside them.
  bool is_near(const EdgeBoxes::Block& block) const {
    const Vec3 slack = Vec3::Constant(2 * block.longest);
    return near_.may_be_in({block.box.lower - slack, block.box.upper + slack});
  }

  /// `room`: no corner of the cell lies further from another [m].
  bool is_near(const grid::CellId cell, const double room) const {
    const Vec3& corner = x_[complex_.copies[complex_.first_copy[cell]].corners[0].value];
    return ((near_.reach().lower - corner).array() <= room).all() &&
           ((corner - near_.reach().upper).array() <= room).all();
  }

  bool passes(const grid::CellId cell) const {
    for (const grid::CopyId c : complex_.copies_of(cell)) {
      const grid::Copy& copy = complex_.copies[c];
      std::array<Vec3, 8> corners;
      for (int v = 0; v < 8; ++v)
        corners[v] = x_[copy.corners[v].value];
      bool found = false;
      near_.for_each(geometry::box_around(corners), [&](const Patch& patch) {
        const std::array<Vec3, 3> triangle = {patch[0], patch[1], patch[2]};
        found = found || (are_parted(corners, triangle) && passes(copy, corners, triangle));
      });
      if (found)
        return !is_cut_by_label(cell);
    }
    return false;
  }

 private:
  /// The material lies among its copy's corners. Round-off counts as parted.
  static bool are_parted(const std::array<Vec3, 8>& corners, const std::array<Vec3, 3>& triangle) {
    const Vec3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
    return !are_apart(corners, triangle, normal);
  }

  bool is_cut_by_label(const grid::CellId cell) const {
    return std::ranges::any_of(grid_.edges(cell), [&](const grid::EdgeId e) {
      const grid::EdgeCut* const cut = cuts_.find(e);
      return cut && cut->label == label_;
    });
  }

  bool passes(const grid::Copy& copy, const std::array<Vec3, 8>& corners, const std::array<Vec3, 3>& triangle) const {
    bool found = false;
    grid::for_each_tetrahedron(grid_, cuts_, copy, [&](const grid::Tetrahedron& rest, int) {
      if (found)
        return;
      grid::Tetrahedron now;
      for (int i = 0; i < 4; ++i) {
        now[i] = Vec3::Zero();
        for (int v = 0; v < 8; ++v)
          now[i] += grid::shape(v, rest[i]) * corners[v];
      }
      found = meets(triangle, now);
    });
    return found;
  }

  NearSweep near_;
  const grid::Grid& grid_;
  const grid::Cuts& cuts_;
  const grid::CellComplex& complex_;
  const Points& x_;
  grid::CutLabel label_;
};

} // namespace

void PassedCells::pass(const std::span<const std::array<Vec3, 3>> strip, const std::span<const grid::EdgeCut> found,
                       const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellComplex& complex,
                       const Points& x, const EdgeBoxes& boxes, const grid::CutLabel label) {
  if (strip.empty())
    return;
  std::vector<grid::EdgeId> edges;
  for (const grid::EdgeCut& cut : found)
    edges.push_back(cut.edge);
  const auto met = grid::touched_cells(grid, edges);
  const auto is_met = [&](const grid::CellId c) {
    return std::ranges::binary_search(met, c, {}, &grid::TouchedCell::cell);
  };
  const Search search(strip, grid, cuts, complex, x, label);
  const auto blocks = boxes.blocks([&](const EdgeBoxes::Block& block) { return search.is_near(block); });
  std::vector<std::vector<grid::CellId>> passed(blocks.size());
  parallel_for(blocks.size(), [&](const std::size_t k) {
    const double room = 4 * boxes.block(blocks[k]).longest;
    boxes.for_each_cell(blocks[k], [&](const grid::CellId c) {
      if (search.is_near(c, room) && !is_met(c) && search.passes(c))
        passed[k].push_back(c);
    });
  });
  for (const auto& of_block : passed)
    cells_.insert(of_block.begin(), of_block.end());
}

void PassedCells::remove_around(const grid::Grid& grid, const grid::EdgeId edge) {
  if (cells_.empty())
    return;
  for (const grid::CellId c : grid.cells(edge))
    if (c.valid())
      cells_.erase(c);
}

} // namespace kerf::cut
