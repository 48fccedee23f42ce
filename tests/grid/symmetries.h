#pragma once

/// The 48 symmetries of the cube at the origin, in points with twice the lattice's coordinates.

#include "tests/grid/slow_parts.h"

namespace kerf::grid::slow {

/// Where each axis goes, and which axes are turned round.
struct Symmetry {
  std::array<int, 3> axes;
  unsigned turned;

  Point operator()(const Point& p) const {
    Point q{};
    for (int axis = 0; axis < 3; ++axis)
      q[axes[axis]] = (turned >> axis & 1) != 0 ? 2 - p[axis] : p[axis];
    return q;
  }
  Item operator()(const Item& item) const {
    Item image{(*this)(item.at)};
    for (const Point& p : item.of)
      image.of.insert((*this)(p));
    return image;
  }
  Items operator()(const Items& items) const {
    Items image;
    for (const Item& item : items)
      image.insert((*this)(item));
    return image;
  }
  /// The bits of vertices, of lines, by the points of each.
  template <class PointOf>
  unsigned bits(const unsigned from, const int n, const PointOf& point) const {
    unsigned to = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        if ((from >> i & 1) && point(Index3{}, j) == (*this)(point(Index3{}, i)))
          to |= 1u << j;
    return to;
  }
  unsigned vertices(const unsigned from) const { return bits(from, 8, node_point); }
  unsigned lines(const unsigned from) const { return bits(from, 12, line_point); }

  /// Is left still left?
  bool is_turn() const {
    const bool is_even = axes[1] == (axes[0] + 1) % 3;
    const bool is_odd_mirror = ((turned & 1) + (turned >> 1 & 1) + (turned >> 2 & 1)) % 2 != 0;
    return is_even != is_odd_mirror;
  }
};

inline std::vector<Symmetry> symmetries() {
  std::vector<Symmetry> all;
  std::array<int, 3> axes = {0, 1, 2};
  do
    for (unsigned turned = 0; turned < 8; ++turned)
      all.push_back({axes, turned});
  while (std::next_permutation(axes.begin(), axes.end()));
  return all;
}

} // namespace kerf::grid::slow
