#pragma once

/// How far a front opens the vertices of the cells around it (grid/fronts.h): of what of its plane lies in the cells
/// around a vertex v, weighted by the shape function N_v, the part F that the cut has come to. Below a half of it
/// something ahead is whole, and the vertex closed; from there on it opens by
///
///     1 - sqrt(2 (1 - F)),
///
/// which in a plane along the grid is the part that the front has passed of the cells ahead. A vertex is worth copies
/// once it has opened by a hundredth.

#include "base/function_ref.h"
#include "grid/solid.h"

#include <array>
#include <vector>

namespace kerf::cut {

using OfVertices = std::array<double, grid::cube::n_vertices>;

constexpr double least_part_open = 0.51; ///< F above which a vertex is worth copies

/// What holds copies at a vertex (grid::Front) [m^2]; of what lies in the plane around it [m^2], of which a little is
/// taken to lie there always, and F. `h`: edge of the cubes [m].
double held(double area, double part, double h);

/// A cell's coordinates in which its cube is [0, h]^3 at its place at rest, as an affine map from where it is.
struct ToRest {
  ToRest(const grid::Solid& solid, grid::CellId c, const Points& x);
  Vec3 operator()(const Vec3& p) const { return origin + from * (p - middle); }

  Vec3 origin, middle = Vec3::Zero();
  Mat3 from;
};

/// Adds the integral of each N_v over a convex polygon in a cell at rest [m^2].
void add_integrals(const grid::Solid& solid, grid::CellId c, const std::vector<Vec3>& polygon, OfVertices& sums);

/// What of a front's plane, as it goes on, lies in the eight cells around each vertex of its cell.
class AroundFront {
 public:
  AroundFront() = default;
  AroundFront(const grid::Solid& solid, const grid::Front& front);

  /// Around a vertex, weighted [m^2].
  double area(const int v) const { return area_[v]; }
  /// The part of that to which the cut has come; come(cell, its vertex) of each cell's.
  double part(const grid::Solid& solid, grid::CellId own, int v,
              FunctionRef<double(grid::CellId, int)> come) const;
  /// Calls f(cell) for the cells of which the plane passes something around a vertex.
  void for_each_cell(const grid::Solid& solid, grid::CellId own, int v, FunctionRef<void(grid::CellId)> f) const;

  void archive(Archive& a) { a(area_, shares_); }

 private:
  OfVertices area_{};
  std::array<std::array<float, grid::cube::n_vertices>, grid::cube::n_vertices> shares_{}; // by vertex and octant
};

} // namespace kerf::cut
