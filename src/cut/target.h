#pragma once

/// The body that is cut, edge by edge, as it stands now. An uncut edge between two material nodes is one current
/// segment, from the real corner of its lower node to that of its upper node; an edge of the skin that is cut once is
/// one from the real corner of its material node towards the virtual corner at its empty node, as far as the skin.
/// Whoever cuts judges the segments one by one, all of them or those near the cut (edge_boxes.h).
///
/// Normals are pulled back to rest with the deformation gradient F = dx/dX at the cut, averaged over the copies around
/// the edge: N ~ F^T n; and pushed forward as n ~ F^-T N.

#include "cut/edge_boxes.h"
#include "cut/recut.h"
#include "geometry/box_tree.h"

#include <functional>

namespace kerf::cut {

/// An edge of the grid as a segment of the current configuration, lower node first [m].
using Segment = std::array<Vec3, 2>;

/// The box around where an edge was and is.
inline Box room(const Segment& before, const Segment& now) {
  return geometry::box_around(std::array{before[0], before[1], now[0], now[1]});
}

/// How a surface meets a segment.
struct Verdict {
  std::size_t n_crossings = 0;
  double t = 0;               ///< of the crossing nearest to the lower node, in [0, 1] [1]
  Vec3 normal = Vec3::Zero(); ///< of the surface there, of any length, current configuration
};

/// Which edges a surface may meet: all others are not crossed.
struct Nearness {
  Box reach;                                ///< of the surface [m]
  std::function<bool(const Box&)> may_meet; ///< false for boxes that hold, before and now, no edge that is crossed
};

/// What an edge that may be cut is made of.
struct EdgeEnds {
  std::array<grid::CornerId, 2>
    corners;               ///< of the lower and the upper node: of an empty node, that of the copies around
                           ///< the edge
  double from = 0, to = 1; ///< the part that is material now [1]

  Segment segment(const Points& x) const {
    const Vec3 &lower = x[corners[0].value], &upper = x[corners[1].value];
    const auto at = [&](const double t) -> Vec3 { return lower + t * (upper - lower); };
    return {from == 0 ? lower : at(from), to == 1 ? upper : at(to)};
  }
};
EdgeEnds ends_of(const grid::Solid& solid, grid::EdgeId edge);

/// dx/dX on an edge at t, summed over the copies around it that hold its material node, when the corners are at `x`:
/// only its direction matters.
Mat3 gradient_on(const grid::Solid& solid, const Points& x, grid::EdgeId edge, double t);

/// The unit normal at rest of a surface that cuts an edge at t with a current normal.
Vec3 pulled_back(const grid::Solid& solid, const Points& x, grid::EdgeId edge, double t, const Vec3& normal);

class Target {
 public:
  /// Everything must outlive it. `boxes` are fitted to x_before and x, or null: then every edge is judged. Throws
  /// NumericalError when a corner is not at a finite position.
  Target(const grid::Solid& solid, const Points& x_before, const Points& x, const EdgeBoxes* boxes);

  Segment segment(grid::EdgeId edge) const { return segment(edge, x_); }
  /// Where the edge is when the corners are at `x`.
  Segment segment(grid::EdgeId edge, const Points& x) const;

  /// Cuts every edge whose segment `judge` finds crossed an odd number of times. Edges are judged in
  /// parallel; the result is ordered by edge.
  SweepCuts cut(grid::CutLabel label, const Nearness& near, const std::function<Verdict(grid::EdgeId)>& judge) const;

 private:
  SweepCuts cut_anywhere(grid::CutLabel label, const std::function<Verdict(grid::EdgeId)>& judge) const;
  SweepCuts cut_near(grid::CutLabel label, const Nearness& near,
                     const std::function<Verdict(grid::EdgeId)>& judge) const;
  void judge_skin(std::uint32_t block, const Nearness& near, double longest,
                  const std::function<void(grid::EdgeId)>& judge) const;
  void add(grid::EdgeId edge, const Verdict& verdict, grid::CutLabel label, SweepCuts& result) const;

  const grid::Solid& solid_;
  const Points& x_before_;
  const Points& x_;
  const EdgeBoxes* boxes_;
};

} // namespace kerf::cut
