#pragma once

/// The material of a solid on a lattice much finer than its grid, and what strokes cut free of it: told from the
/// blades' motion relative to the material alone, whatever the grid has made of it. A link between two neighbours is
/// cut where a blade meets it, as the body carries it along: the same as asking whether the stroke, pulled back to
/// rest, passes between them.

#include "cut/moving_edge.h"
#include "cut/near_sweep.h"
#include "geometry/box_tree.h"
#include "grid/material.h"
#include "grid/shape.h"

#include <Eigen/LU>

#include <map>
#include <numeric>
#include <span>
#include <vector>

namespace kerf::support {

class FineMaterial {
 public:
  /// n points along a cube's edge, in an uncut solid.
  FineMaterial(const grid::Solid& solid, const int n) : n_(n) {
    const double spacing = 1.0 / n;
    std::map<Index3, std::uint32_t> place;
    for (const auto c : ids<grid::CellId>(solid.grid.n_cells())) {
      const Index3& cell = solid.grid.index(solid.grid.nodes(c)[0]);
      for (int i = 0; i < n * n * n; ++i) {
        const Index3 at{i % n, i / n % n, i / (n * n)};
        const Point point{c, spacing * (Vec3(at[0], at[1], at[2]) + Vec3(0.497, 0.501, 0.5038)), {}};
        if (const grid::CopyId copy = copy_around(solid, point); copy.valid()) {
          place[{n * cell[0] + at[0], n * cell[1] + at[1], n * cell[2] + at[2]}] =
            static_cast<std::uint32_t>(points_.size());
          points_.push_back({point.cell, point.local, copy});
        }
      }
    }
    for (const auto& [at, first] : place)
      for (int axis = 0; axis < 3; ++axis) {
        Index3 next = at;
        ++next[axis];
        if (const auto second = place.find(next); second != place.end())
          links_.push_back({first, second->second});
      }
    all_links_ = links_;
  }

  std::size_t size() const { return points_.size(); }
  /// Of a cube [1].
  double volume() const { return 1.0 / (n_ * n_ * n_); }
  /// In whose material a point lies.
  grid::CopyId copy(const std::size_t i) const { return points_[i].copy; }

  /// Cuts what blades meet while the corners go from x_before to x, before the body is cut.
  void cut(const grid::Solid& solid, const std::vector<cut::BladePath>& paths, const Points& x_before,
           const Points& x) {
    const Points before = places(solid, x_before), now = places(solid, x);
    for (const cut::BladePath& path : paths) {
      const cut::NearSweep near(cut::patches(path));
      std::erase_if(links_, [&](const std::array<std::uint32_t, 2>& link) {
        const cut::Segment from{before[link[0]], before[link[1]]}, to{now[link[0]], now[link[1]]};
        return near.may_be_in(cut::room(from, to)) && cut::meet(path, from, to).n_crossings > 0;
      });
    }
  }

  /// The body has been cut, in these cells (ascending): finds the copies that carry the points now.
  void follow(const grid::Solid& solid, const std::span<const grid::CellId> cells) {
    for (Point& point : points_)
      if (std::ranges::binary_search(cells, point.cell))
        if (const grid::CopyId copy = copy_around(solid, point); copy.valid())
          point.copy = copy;
  }

  /// Of the links for which between(point, point) holds, the part that is not cut.
  template <class Between>
  double part_held(const Between& between) const {
    const auto n = [&](const std::vector<std::array<std::uint32_t, 2>>& links) {
      return static_cast<double>(
        std::ranges::count_if(links, [&](const auto& link) { return between(link[0], link[1]); }));
    };
    const double all = n(all_links_);
    return all > 0 ? n(links_) / all : 0;
  }

  /// Points that links hold together have the same number: the lowest of them. Links for which without(point, point)
  /// holds are left out.
  template <class Without>
  std::vector<std::uint32_t> pieces(const Without& without) const {
    std::vector<std::uint32_t> name(points_.size());
    std::iota(name.begin(), name.end(), 0u);
    const auto find = [&](std::uint32_t i) {
      while (name[i] != i)
        i = name[i] = name[name[i]];
      return i;
    };
    for (const auto& [a, b] : links_) {
      if (without(a, b))
        continue;
      const std::uint32_t p = find(a), q = find(b);
      name[std::max(p, q)] = std::min(p, q);
    }
    for (std::uint32_t i = 0; i < name.size(); ++i)
      name[i] = find(i);
    return name;
  }

 private:
  struct Point {
    grid::CellId cell;
    Vec3 local; ///< in the unit cube [1]
    grid::CopyId copy;
  };

  static bool holds(const grid::Tetrahedron& t, const Vec3& p) {
    Mat3 sides;
    sides << t[1] - t[0], t[2] - t[0], t[3] - t[0];
    const Vec3 weights = sides.inverse() * (p - t[0]);
    return sides.determinant() > 0 && (weights.array() >= 0).all() && weights.sum() <= 1;
  }

  static grid::CopyId copy_around(const grid::Solid& solid, const Point& point) {
    for (const grid::CopyId c : solid.complex.copies_of(point.cell)) {
      const grid::Copy& copy = solid.complex.copies[c];
      bool found = copy.nodes == 0xff && grid::cuts_of(solid, point.cell).blades == 0;
      if (!found)
        grid::for_each_tetrahedron(solid, copy,
                                   [&](const grid::Tetrahedron& t, int) { found = found || holds(t, point.local); });
      if (found)
        return c;
    }
    return {};
  }

  Points places(const grid::Solid& solid, const Points& x) const {
    Points all;
    all.reserve(points_.size());
    for (const Point& point : points_) {
      const auto& corners = solid.complex.copies[point.copy].corners;
      Vec3 p = Vec3::Zero();
      for (int v = 0; v < 8; ++v)
        p += grid::shape(v, point.local) * x[corners[v].value];
      all.push_back(p);
    }
    return all;
  }

  int n_;
  std::vector<Point> points_;
  std::vector<std::array<std::uint32_t, 2>> links_, all_links_; // that hold; that held before any cut
};

} // namespace kerf::support
