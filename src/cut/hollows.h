#pragma once

/// Hollows of the skin between parts of a cell. What lies on the same sides of all cuts (sides.h) is convex, but for
/// the skin: where that has a hollow, as at an edge between two walls that meet like those of an L, two tips on both
/// sides of it may lie on the same sides of all cuts, and hang together by nothing.

#include "grid/material.h"
#include "grid/solid.h"

#include <array>
#include <vector>

namespace kerf::cut {

class Hollows {
 public:
  /// Of a cell that holds these items.
  Hollows(const grid::Solid& solid, grid::CellId c, grid::Items items);

  /// Does a hollow lie between all of some items and all of others? One of less than a tenth of a cube is none: the
  /// skin of a round body has such.
  bool lie_between(grid::Items some, grid::Items others) const;
  /// Between all of some items and a point, in coordinates of the cell?
  bool lie_between(grid::Items some, const Vec3& p) const;
  /// On a segment, so far from its first end; on a line in edges of the grid [1].
  Vec3 point(const grid::Skeleton& skeleton, int segment, double t) const;

 private:
  bool is_inside(const Vec3& p) const;

  std::array<Vec3, grid::skeleton::n_items> at_; // of the items, in coordinates of the cell [1]
  std::vector<grid::Tetrahedron> material_;      // signed
  Vec3 inward_;                                  // the middle of its nodes
};

} // namespace kerf::cut
