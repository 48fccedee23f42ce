#pragma once

/// The triangles of a mesh near each of some cells, with what queries ask of them at hand.

#include "geometry/triangle_mesh.h"
#include "grid/touched.h"

#include <span>

namespace kerf::cut {

/// A triangle and its plane.
struct FlatTriangle {
  Vec3 normal;                 ///< (b - a) x (c - a) [m^2]
  std::array<Vec3, 3> corners; ///< [m]

  /// Distance of p from the plane, times the normal's length [m^3].
  double height(const Vec3& p) const { return normal.dot(p - corners[0]); }
};

/// Some triangles side by side, so that the compiler makes vector code of one question to all.
class TriangleGroup {
 public:
  static constexpr std::size_t most = 16;

  void clear() { n_ = 0; }
  /// For up to `most`.
  void push_back(const FlatTriangle& triangle);

  /// Bits of those that the line p + s d may meet (d a unit vector, p no further from them than they are long, or
  /// `room` [m]), by geometry::line_meets(); and of those from whose planes p is no further than `tolerance` [m]. With
  /// room for round-off.
  std::uint32_t which_may_meet(const Vec3& p, const Vec3& d, double room, double tolerance) const;

 private:
  using Column = std::array<double, most>;

  std::array<Column, 3> a_, e_, f_, normal_; // first corner; sides from it to the others; e x f
  Column length_, area2_;                    // of the sides together; square of the normal's
  std::size_t n_ = 0;
};

class CellTriangles {
 public:
  /// `cells` ascending.
  CellTriangles(const geometry::TriangleMesh& mesh, const grid::Grid& grid, std::span<const grid::TouchedCell> cells);

  /// Those that come near the i-th cell: all whose box meets it, but for those whose plane passes beside it.
  std::span<const std::uint32_t> of(const std::size_t i) const {
    return std::span(triangles_).subspan(start_[i], start_[i + 1] - start_[i]);
  }
  const FlatTriangle& operator[](const std::uint32_t triangle) const { return flat_[triangle]; }
  /// Asks the memory for those near the i-th cell, if there is one: they lie all over the mesh.
  void prefetch(const std::size_t i) const {
    if (i + 1 < start_.size())
      for (const std::uint32_t t : of(i)) {
        __builtin_prefetch(&flat_[t]);
        __builtin_prefetch(reinterpret_cast<const char*>(&flat_[t] + 1) - 1);
      }
  }

 private:
  std::vector<FlatTriangle> flat_;
  std::vector<std::uint32_t> start_, triangles_;
};

} // namespace kerf::cut
