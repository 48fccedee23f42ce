#pragma once

/// How far a cut stands open: where it cuts edges of the grid, both of whose sides copies follow.
///
/// An edge along axis k that the cut crosses stands for h^2 of the cut's shadow along k, whatever the cut's slope, as
/// the edges along k lie h apart in both other directions. So the volume between the sides is the sum over all cut
/// edges of the gap times h^2 times e_k, carried into the current configuration by the cofactor of the deformation
/// gradient. First order in h at the border of the cut.

#include "grid/solid.h"

#include <vector>

namespace kerf::grid {

struct Gap {
  EdgeId edge;
  Vec3 way = Vec3::Zero();  ///< from the edge's lower side to its upper one, current configuration [m]
  Vec3 area = Vec3::Zero(); ///< of the part that the edge stands for, current configuration [m^2]
};

/// Of each edge between two material nodes that the cut `label` has parted, with the corners at `x` [m].
std::vector<Gap> gaps(const Solid& solid, CutLabel label, const Points& x);

/// The sum of way . area [m^3]: what lies between the sides of a cut, negative where they pass through each other.
double opened_volume(const std::vector<Gap>& gaps);

} // namespace kerf::grid
