#pragma once

/// The regions of lattice shape matching on a cut body, and fast sums over them (Rivers and James 2007).
///
/// The material nodes of the grid, but those of crumbs, are the lattice's points; from a point one may step along an
/// uncut edge to the next (two such points share a copy; a cut edge is no step). A *line* along an axis is a longest
/// row of such steps. The **region** of a point r: walk at most w steps along r's z line, from there at most w along
/// the y line, from there at most w along the x line. In the bulk this is the full box of (2 w + 1)^3 points. Cuts and
/// skin break lines, and so trim the box: a region never reaches across a cut, and it goes around the end of a cut only
/// where such a walk does. No point is reached twice, since a walk is fixed by its end.
///
/// Sums over all regions are therefore three passes over lines: x, then y, then z, exact for every cut; sums over all
/// regions that *hold* a point are the same passes in the order z, y, x. Departs from Rivers and James, who find
/// regions by breadth-first search and share bars and plates between them where the lattice is regular: here no case is
/// special.
///
/// Where a cut ends inside cells (grid/fronts.h), what is reached counts in part. Steps along edges ahead of the cut
/// have phi = (1 + r) f / (1 + r f), f the most that the cut has passed of a cell around, and a walk along a line counts
/// by 1 less the largest phi of its steps. With r = 1 + 1.8 / w a split bar opens evenly as f grows, to a third, for
/// w = 2 and 3 (tests/lattice/fronts_test.cc), and 4 by hand; with w = 1 it does so but where the front comes into a
/// cell, which opens it at once by a sixth of what the cell does.
///
/// Limits: where lines are broken, regions depend on the order of the axes, and r may be in the region of s without s
/// in that of r. Matching needs neither.

#include "grid/solid.h"

#include <vector>

namespace kerf::lattice {

class Lines {
 public:
  /// Throws ParameterError when the half width is below 1.
  Lines(const grid::Solid& solid, int half_width);

  int half_width() const { return static_cast<int>(half_width_); }
  /// Points are numbered in the grid's order of nodes, x fastest.
  std::size_t n_points() const { return nodes_.size(); }
  const std::vector<grid::NodeId>& nodes() const { return nodes_; }

  /// For each point r, the sum of f over r's region, in place. f holds 12 or 6 numbers a point.
  void sum_over_regions(std::vector<double>& f) const;
  /// For each point i, the sum of f over the regions r that hold i, in place: the transpose.
  void sum_over_holders(std::vector<double>& f) const;

 private:
  /// Points in lines along one axis.
  struct Axis {
    std::vector<std::uint32_t> start, points;
    std::size_t longest = 0;

    void end_line();
  };
  /// Lines with steps that count in part: the unbroken line by 1 less the largest phi, and for each phi the line broken
  /// at all steps with that and more, by what it is more than the next smaller one.
  struct Broken {
    Axis lines; ///< of places below
    std::vector<std::uint32_t> point; ///< by place
    std::vector<double> weight;       ///< by place, of what is summed there [1]
    std::vector<std::uint32_t> whole_point; ///< of these lines, each once
    std::vector<double> whole_weight;       ///< of the unbroken line [1]
  };
  /// A step of a line that counts in part.
  struct Partial {
    std::uint32_t lower; ///< point
    double phi;          ///< in (0, 1) [1]
  };

  /// From the point one step up from each point.
  static Axis lines_through(const std::vector<std::uint32_t>& next);
  static Broken broken_lines(const Axis& axis, const std::vector<Partial>& partial);
  void sum_windows_along(int axis, std::vector<double>& f) const;

  std::size_t half_width_;
  std::vector<grid::NodeId> nodes_;
  std::array<Axis, 3> axes_;
  std::array<Broken, 3> broken_; // empty where no cut ends inside cells
};

} // namespace kerf::lattice
