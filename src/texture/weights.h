#pragma once

/// Weights of source points (thesis §3.4.2.2).

#include "base/vec.h"

#include <array>
#include <span>
#include <vector>

namespace kerf::texture {

/// Most source points of one cell.
constexpr int max_sources = 32;

/// Of each source point the share of what it shows; they sum to 1.
using Shares = std::array<double, max_sources>;

/// Shepard: w_i ~ 1 / |p - p_i|^power. `distances` [m], one each; the first n of `shares` are set.
void shepard(std::span<const double> distances, double power, Shares& shares);

/// A triangle of source points, counter-clockwise seen from outside of the cell.
using Triple = std::array<int, 3>;

/// Mean value coordinates of p with respect to the closed surface of triangles between source points (Ju, Schaefer,
/// Warren, Mean value coordinates for closed triangular meshes, 2005; by triangle as Floater, Kos, Reimers, Mean value
/// coordinates in 3D, 2005). Those below zero count as zero; the rest sum to 1. Returns how far the points enclose p:
/// 1 where no coordinate is below zero, 0 from where one is below -0.1, or none can be found, linear in between.
double mean_value(const Vec3& p, std::span<const Vec3> sources, const std::vector<Triple>& triangles, Shares& shares);

/// Replaces Shepard's shares by mean value coordinates, as far as the points enclose p. Near a face of the cell Shepard
/// gives all to the face's own source; mean value coordinates do so in a box, but not in a tetrahedron, say, whose
/// sources all move into the face along with p: there Shepard's shares come back, so that shares are continuous.
void enclose(const Vec3& p, std::span<const Vec3> sources, const std::vector<Triple>& triangles, Shares& shares);

} // namespace kerf::texture
