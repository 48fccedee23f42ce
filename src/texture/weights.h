#pragma once

/// Weights of source points (thesis §3.4.2.2).

#include "base/vec.h"

#include <array>
#include <span>
#include <vector>

namespace kerf::texture {

/// Most source points of one cell.
constexpr int max_sources = 16;

/// Of each source point the share of what it shows; they sum to 1.
using Shares = std::array<double, max_sources>;

/// Shepard: w_i ~ 1 / |p - p_i|^power. `distances` [m], one each; the first n of `shares` are set.
void shepard(std::span<const double> distances, double power, Shares& shares);

/// A triangle of source points, counter-clockwise seen from outside of the cell.
using Triple = std::array<int, 3>;

/// Mean value coordinates of p with respect to the closed surface of triangles between source points (Ju, Schaefer,
/// Warren, Mean value coordinates for closed triangular meshes, 2005). False, and nothing set, where p is not enclosed
/// by them (a coordinate below zero).
bool mean_value(const Vec3& p, std::span<const Vec3> sources, const std::vector<Triple>& triangles, Shares& shares);

} // namespace kerf::texture
