#pragma once

/// What the criteria make of simple cuts, as plain numbers: the weight around a point on a plane (thesis, figure 2.9),
/// and the weight of a pair against a growing cut (figure 2.19).
///
/// The cuts: strips of the plane z = height, seen from the side in the plane y = 0; along y they are as long as asked
/// for. One front: a strip whose one end stays outside of the picture. Two fronts: two such strips, from left and
/// right, with a gap between them that closes: the last part shares its corners with both, so the fronts are gone.

#include "visibility/criterion.h"

namespace kerf::visibility {

/// Points origin + (i + 0.5) step_u + (j + 0.5) step_v [m]; i < n_u, j < n_v.
struct Plane {
  Vec3 origin = Vec3::Zero(), step_u = Vec3::Zero(), step_v = Vec3::Zero();
  int n_u = 0, n_v = 0;
};

/// pba::weight() [1] between the point `from` and each point of the plane, row j by row. Throws what
/// make_criterion() and PairSights throw.
std::vector<double> weight_field(const CriterionChoice& choice, std::span<const Face> cut, const Vec3& from,
                                 double support, const Plane& plane);

/// The weights [1] of a pair as the cut grows: before the first part, after it, after the second, ...
std::vector<double> weight_history(const CriterionChoice& choice, std::span<const std::vector<Face>> parts,
                                   const Pair& pair);

/// The largest difference of two neighbours; 0 of fewer than two.
double largest_jump(std::span<const double> weights);

/// A rectangle from_x <= x <= to_x, |y| <= half_depth of the plane z = height, as two triangles [m].
std::vector<Face> strip(double from_x, double to_x, double half_depth, double height);

/// A strip that grows from from_x to to_x in n equal parts [m].
std::vector<std::vector<Face>> growing_strip(double from_x, double to_x, int n, double half_depth, double height);

/// Two strips that grow towards each other, from -far and far, until they meet at x = 0: n parts, each of both strips.
std::vector<std::vector<Face>> merging_strips(double far, int n, double half_depth, double height);

} // namespace kerf::visibility
