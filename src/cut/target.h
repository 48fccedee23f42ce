#pragma once

/// The body that is cut, edge by edge, as it stands now. An uncut edge between two material nodes is one current
/// segment, from the real corner of its lower node to that of its upper node; an edge of the skin that is cut once is
/// one from the real corner of its material node towards the virtual corner at its empty node, as far as the skin. A
/// segment of the skin (grid/skeleton.h) that is not cut is one between two points of the skin, which lie among the
/// corners of the copy that holds them. Whoever cuts judges the segments one by one, all of them or those near the cut
/// (edge_boxes.h).
///
/// Normals are pulled back to rest with the deformation gradient F = dx/dX at the cut, averaged over the copies around
/// the edge: N ~ F^T n; and pushed forward as n ~ F^-T N. Of a blade they are those of its motion against that of the
/// cells around, on average: that against one edge alone would tilt with every recoil of the material.

#include "cut/edge_boxes.h"
#include "cut/recut.h"
#include "geometry/box_tree.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <span>

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
  Vec3 along = Vec3::Zero();  ///< a blade's edge: in material that moves by u in the step, normal - along x u is normal
};

/// How a surface meets a segment that was at one place, and is at another one now.
using Judge = std::function<Verdict(const Segment& before, const Segment& now)>;

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

/// The skin of a cell as it stands.
class SkinNow {
 public:
  /// The solid must outlive it.
  SkinNow(const grid::Solid& solid, grid::CellId cell);

  /// Calls f(segment) for each segment of the skin: spokes, and halves in those faces that have no cell below, or below
  /// which this one lies.
  template <class Function>
  void for_each_segment(const Function& f) const {
    for (grid::Segments left = skeleton_.segments & ~grid::skeleton::lines; left != 0; left &= left - 1)
      if (const int segment = std::countr_zero(left); is_own(segment))
        f(segment);
  }
  /// Between its two items when the corners are at `x` [m]; also of an edge of the skin.
  Segment segment(int segment, const Points& x) const;
  /// Likewise of all items.
  SkinPlaces::mapped_type places(const Points& x) const;
  /// The same, at other places if the cell is among them.
  Segment segment(int segment, const Points& x, const SkinPlaces* places) const;
  /// The unit normal at rest of a surface that cuts it at t with a current normal.
  Vec3 pulled_back(int segment, double t, const Points& x, const Vec3& normal) const;

 private:
  bool is_own(const int segment) const {
    const int face = (segment - grid::skeleton::first_half) / 4;
    return segment >= grid::skeleton::first_spoke || face % 2 == 1 ||
           !solid_.grid.cells(solid_.grid.faces(cell_)[face])[0].valid();
  }
  const grid::Copy& copy_with(int item) const;
  Vec3 local(int item) const;
  Vec3 place(int item, const Points& x) const;

  const grid::Solid& solid_;
  grid::CellId cell_;
  grid::CellCuts cuts_;
  const grid::Skeleton& skeleton_;
};

class Target {
 public:
  /// Everything must outlive it. `boxes` are fitted to x_before and x, or null: then every edge is judged. Points of
  /// the skin were at `places_before` where their cells are among them; null if none are. Throws NumericalError when a
  /// corner is not at a finite position.
  Target(const grid::Solid& solid, const Points& x_before, const Points& x, const EdgeBoxes* boxes,
         const SkinPlaces* places_before = nullptr);

  /// Cuts every edge and every segment of the skin that `judge` finds crossed an odd number of times. They are judged
  /// in parallel; the result is ordered.
  SweepCuts cut(grid::CutLabel label, const Nearness& near, const Judge& judge) const;

 private:
  SweepCuts cut_anywhere(grid::CutLabel label, const Judge& judge) const;
  SweepCuts cut_near(grid::CutLabel label, const Nearness& near, const Judge& judge) const;
  void judge_edges(std::uint32_t block, const Nearness& near, grid::CutLabel label, const Judge& judge,
                   SweepCuts& result) const;
  void judge_skin_edges(std::uint32_t block, const Nearness& near, grid::CutLabel label, const Judge& judge,
                        SweepCuts& result) const;
  void judge_skin(grid::CellId cell, const Nearness* near, grid::CutLabel label, const Judge& judge,
                  SweepCuts& result) const;
  bool is_asked(grid::EdgeId edge, grid::CutLabel label) const;
  void judge(grid::EdgeId edge, grid::CutLabel label, const Judge& judge, SweepCuts& result) const;
  void judge_later(grid::EdgeId edge, grid::CutLabel label, const Judge& judge, SweepCuts& result) const;
  Box box_around_copies(grid::CellId cell) const; // before and now
  Vec3 normal_among(std::span<const grid::CellId> cells, const Verdict& verdict) const;

  const grid::Solid& solid_;
  const Points& x_before_;
  const Points& x_;
  const EdgeBoxes* boxes_;
  const SkinPlaces* places_before_;
};

} // namespace kerf::cut
