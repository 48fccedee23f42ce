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

class CellTriangles {
 public:
  /// `cells` ascending.
  CellTriangles(const geometry::TriangleMesh& mesh, const grid::Grid& grid, std::span<const grid::TouchedCell> cells);

  /// Those that come near the i-th cell: all whose box meets it, but for those whose plane passes beside it.
  std::span<const std::uint32_t> of(const std::size_t i) const {
    return std::span(triangles_).subspan(start_[i], start_[i + 1] - start_[i]);
  }
  const FlatTriangle& operator[](const std::uint32_t triangle) const { return flat_[triangle]; }

 private:
  std::vector<FlatTriangle> flat_;
  std::vector<std::uint32_t> start_, triangles_;
};

} // namespace kerf::cut
