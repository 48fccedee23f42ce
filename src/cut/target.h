#pragma once

/// The body that is cut, edge by edge, as it stands now. An uncut edge between two material nodes is one current
/// segment, from the real corner of its lower node to that of its upper node; whoever cuts judges the segments one by one.
///
/// Normals are pulled back to rest with the deformation gradient F = dx/dX at the cut, averaged over the copies around
/// the edge: N ~ F^T n.

#include "cut/recut.h"

#include <functional>

namespace kerf::cut {

/// An edge of the grid as a segment of the current configuration, lower node first [m].
using Segment = std::array<Vec3, 2>;

/// How a surface meets a segment.
struct Verdict {
  std::size_t n_crossings = 0;
  double t = 0;               ///< of the crossing nearest to the lower node, in [0, 1] [1]
  Vec3 normal = Vec3::Zero(); ///< of the surface there, of any length, current configuration
};

class Target {
 public:
  /// Everything must outlive it. Throws NumericalError when a corner is not at a finite position.
  Target(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellComplex& complex, const Points& x);

  Segment segment(grid::EdgeId edge) const { return segment(edge, x_); }
  /// Where the edge is when the corners are at `x`.
  Segment segment(grid::EdgeId edge, const Points& x) const;

  /// Cuts every uncut edge inside the material that `judge` finds crossed an odd number of times. Edges are judged in
  /// parallel; the result is ordered by edge.
  SweepCuts cut(grid::CutLabel label, const std::function<Verdict(grid::EdgeId)>& judge) const;

 private:
  bool is_inside(grid::EdgeId edge) const;
  void add(grid::EdgeId edge, const Verdict& verdict, grid::CutLabel label, SweepCuts& result) const;
  Vec3 rest_normal(grid::EdgeId edge, double t, const Vec3& normal) const;
  Mat3 mean_gradient(grid::EdgeId edge, double t) const;

  const grid::Grid& grid_;
  const grid::Cuts& cuts_;
  const grid::CellComplex& complex_;
  const Points& x_;
};

} // namespace kerf::cut
