#pragma once

/// From where a vertex of cuts sees what is around it in its cell. The material between cuts is made of tetrahedra on
/// the cell's vertex and those in its sides (grid/material.h). Where these see all of the skin, and of the borders of
/// their faces, from within, each has a volume that is not negative. Under a jagged skin a quadric's minimum may not.

#include "base/vec.h"
#include "surface/view.h"

#include <optional>
#include <vector>

namespace kerf::surface {

/// Of p above the plane of a half-space, which is what lies above it.
double height(const Vec3& p, const Plane& half_space);

/// In the middle of all points that half-spaces have in common in a box and in up to two planes: the mean of the
/// corners of what they leave, each as often as three planes meet in it. None where they leave nothing. With n half-
/// spaces in m planes it takes n^(4 - m) steps: a cell has at most 30.
std::optional<Vec3> middle_of(std::vector<Plane> half_spaces, const Vec3& lower, const Vec3& upper,
                              const std::vector<Plane>& in_planes);

/// From where a side of the cell's skeleton that lies in a face sees its whole border, within that face and at most one
/// other plane through p: p, or as far as that from the middle of all such points towards p. None where there is none.
std::optional<Vec3> seeing_border(const grid::Solid& solid, const View& view, int side, const Vec3& p,
                                  std::vector<Plane> in_planes);
/// Does no part of such a side, between two cuts that follow each other on its border, have less than no area, with a
/// vertex at p?
bool parts_have_areas(const grid::Solid& solid, const View& view, int side, const Vec3& p);
/// From where the cell sees all of its skin, within up to two planes through p: p, or as far as that.
std::optional<Vec3> seeing_skin(const grid::Solid& solid, const View& view, const Vec3& p,
                                const std::vector<Plane>& in_planes);
constexpr double nothing = -1e-13; ///< but for round-off [h^3]
/// Has each part of the cell, and each that a front parts, more than `least` [h^3] at each corner, and no trilinear
/// field a negative square in it?
bool has_material(const grid::Solid& solid, const View& view, double least);
/// Moves the cell's vertex to p, and asks that.
bool has_material(grid::Solid& solid, const View& view, const Vec3& p, double least);
/// On the way from p to what sees all around it, in fifths of it, the first point that is good enough.
template <class IsGood>
Vec3 nearest(const Vec3& p, const Vec3& seeing, const IsGood& is_good) {
  constexpr int n = 5;
  for (int k = 0; k < n; ++k)
    if (const Vec3 q = p + double(k) / n * (seeing - p); is_good(q))
      return q;
  return seeing;
}
/// Do the cell's vertex and those in its faces see all that they should?
bool all_is_seen(const grid::Solid& solid, const View& view);

} // namespace kerf::surface
