#pragma once

/// Triangles that lie in nearly one plane, close to each other: what small features see of their surroundings is found
/// once for all of them.

#include "texture/twins.h"

namespace kerf::texture {

/// Numbers of triangles; their plane is that of the first.
using FlatGroup = std::vector<std::size_t>;

/// Groups of some triangles with an area, by number, in their order: `corners` are those of all. In a group no corner
/// lies farther from the plane than a quarter of a pixel, no triangle leans by more than 3.4 degrees, by which what the
/// windows around a point see rises as far, and centroids lie in one cube of 64 pixels of a lattice of cubes along
/// `axes` from `origin`, so that a group is no larger than pays. Each triangle joins the first group of its cube that
/// takes it. Triangles without an area are groups of their own.
std::vector<FlatGroup> flat_groups(std::span<const std::size_t> triangles, std::span<const Corners> corners,
                                   const Mat3& axes, const Vec3& origin, double pixel);

} // namespace kerf::texture
