#pragma once

/// Convex hulls in a plane, by CGAL's exact predicates.

#include <Eigen/Core>

#include <vector>

namespace kerf::geometry {

/// Its corners, around; fewer than three where the points lie on a line.
std::vector<Eigen::Vector2d> convex_hull(const std::vector<Eigen::Vector2d>& points);

} // namespace kerf::geometry
