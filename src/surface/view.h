#pragma once

/// A cell with its cut edges, as the placement of vertices sees it.

#include "grid/parts.h"
#include "grid/solid.h"
#include "surface/planes.h"

#include <bit>

namespace kerf::surface {

/// Calls f(i) for each bit i of a mask, upwards.
template <class Mask, class Function>
void for_each_bit(Mask mask, const Function& f) {
  for (; mask != 0; mask &= mask - 1)
    f(std::countr_zero(mask));
}

/// A cell, with the planes of its cuts; sets are bits.
struct View {
  grid::CellId cell;
  Vec3 lower, upper;             ///< the cell's corners [m]
  grid::CellCuts now;            ///< with the new cuts
  unsigned old = 0;              ///< lines without a new cut
  grid::Segments old_blades = 0; ///< segments that blades have cut before
  std::array<Plane, 12> planes;  ///< by line, where it is cut: of the inner cut
  std::array<grid::CutLabel, 12> labels;

  /// p, no closer to the sides of the cell than a vertex may be [m].
  Vec3 inside(const Vec3& p) const;
};

View look_at(const grid::Solid& solid, grid::CellId c);

/// The plane of a segment's cut, and who made it.
struct CutPlane {
  Plane plane;
  grid::CutLabel label;
};
CutPlane cut_plane(const grid::Solid& solid, const View& view, int segment);

constexpr double in_plane = 1e-9; ///< how near to a plane is in it, but for round-off [h]
/// Do all cuts of the cell lie in one plane, with p?
bool cuts_are_in_plane(const grid::Solid& solid, const View& view, const Vec3& p);
/// Do those of the cell, and those of the one across a face of it, each lie in one with p?
bool cuts_are_in_plane(const grid::Solid& solid, const View& view, int face, const Vec3& p);

/// The segments that bound a side.
grid::Segments border(const grid::Skeleton::Side& side);

/// The mean of a side's items [m].
Vec3 middle_of(const grid::Solid& solid, const View& view, int side);
/// Of the blades' cuts among some segments [m].
Vec3 mean_point_of(const grid::Solid& solid, const View& view, grid::Segments of);

} // namespace kerf::surface
