#pragma once

/// A map of a rectangle into the plane: the images of a lattice's nodes, bilinear in each of its cells.
///
/// A bilinear cell maps one to one if the four triangles at its corners keep their orientation (its determinant is
/// linear along each side, so smallest at a corner). So a map whose corner triangles all do is locally one to one, and
/// one to one as a whole if its border is (thesis §3.4.3.1.1 asks for a bijection).

#include "base/vec.h"

#include <optional>
#include <vector>

namespace kerf::warp {

struct LatticeMap {
  Vec2 lower = Vec2::Zero(), upper = Vec2::Ones(); ///< the rectangle, in the units of the source
  int n_columns = 2, n_rows = 2;                   ///< nodes, at least 2
  std::vector<Vec2> nodes;                         ///< images of the nodes, row by row, in the units of the target

  Vec2 spacing() const { return (upper - lower).cwiseQuotient(Vec2(n_columns - 1, n_rows - 1)); }
  Vec2 source(const int column, const int row) const { return lower + spacing().cwiseProduct(Vec2(column, row)); }
  const Vec2& node(const int column, const int row) const { return nodes[row * n_columns + column]; }

  /// Outside of the rectangle its border cells go on.
  Vec2 operator()(const Vec2& p) const;
  /// Derivatives of the image along x and y, as columns.
  Mat2 gradient(const Vec2& p) const;
};

/// p -> linear p + shift.
struct Affine {
  Mat2 linear = Mat2::Identity();
  Vec2 shift = Vec2::Zero();

  Vec2 operator()(const Vec2& p) const { return linear * p + shift; }
  Affine inverse() const;
};

/// A lattice with the images that `map` gives; `map` takes and returns a Vec2.
template <class Map>
LatticeMap lattice_of(const Map& map, const Vec2& lower, const Vec2& upper, const int n_columns, const int n_rows) {
  LatticeMap result{lower, upper, n_columns, n_rows, {}};
  for (int r = 0; r < n_rows; ++r)
    for (int c = 0; c < n_columns; ++c)
      result.nodes.push_back(map(result.source(c, r)));
  return result;
}

/// The smallest determinant of the triangles at the corners of the cells, over that of `reference` [1]. Positive:
/// nothing is folded.
double smallest_determinant(const LatticeMap& map, const Mat2& reference = Mat2::Identity());

/// The point that goes to `target`, by Newton's method from `start`, then cell by cell; empty where there is none.
std::optional<Vec2> inverse_at(const LatticeMap& map, const Vec2& target, const Vec2& start);

/// The inverse on a lattice over a rectangle of the target. Where nothing goes to a node, it is the point whose image,
/// going on over the border, comes closest.
LatticeMap inverse(const LatticeMap& map, const Vec2& lower, const Vec2& upper, int n_columns, int n_rows);

} // namespace kerf::warp
