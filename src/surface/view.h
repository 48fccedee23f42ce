#pragma once

/// A cell with its cut edges, as the placement of vertices sees it.

#include "grid/parts.h"
#include "grid/solid.h"
#include "surface/planes.h"

namespace kerf::surface {

/// Calls f(i) for each bit i of a mask, upwards.
template <class Function>
void for_each_bit(unsigned mask, const Function& f) {
  for (; mask != 0; mask &= mask - 1)
    f(std::countr_zero(mask));
}

/// A cell, with the planes of its cut edges; sets are bits, of lines or of vertices.
struct View {
  grid::CellId cell;
  Vec3 lower, upper;            ///< the cell's corners [m]
  grid::CellCuts now;           ///< with the new cuts
  unsigned old = 0;             ///< lines without a new cut
  unsigned parted_faces = 0;    ///< where a cut has been, and newly parts the skin
  std::array<Plane, 12> planes; ///< by line, where it is cut: of the inner cut
  std::array<grid::CutLabel, 12> labels;
  std::array<Plane, 12> skin_planes; ///< of lines that are cut twice: of the outer cut

  /// What had been cut before, and what the skin alone cuts.
  grid::CellCuts before() const;
  grid::CellCuts without_blades() const;

  const Plane& skin_plane(const int line) const { return now.twice >> line & 1 ? skin_planes[line] : planes[line]; }
  /// Where the skin cuts a line [m].
  const Vec3& skin_at(const int line) const { return skin_plane(line).point; }
  /// The mean plane of the blades' cuts of some lines: of the new ones, where there are some.
  Plane mean_plane(unsigned lines) const;
  /// p, no closer to the sides of the cell than a vertex may be [m].
  Vec3 inside(const Vec3& p) const;
};

View look_at(const grid::Solid& solid, grid::CellId c);

} // namespace kerf::surface
