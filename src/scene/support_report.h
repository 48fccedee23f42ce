#pragma once

/// What supports hold, said before a run begins: a support that holds too much, nothing, or by chance is the commonest
/// reason for a wrong answer, and the run does not show it.

#include "scene/body.h"

#include <string>
#include <vector>

namespace kerf::scene {

/// A line for each support that holds corners or phyxels: how many, from where to where, and in how many pieces they
/// hang together; then warnings: as below, and of supports that together hold every phyxel.
std::vector<std::string> describe_supports(const Body& body);

/// Of a box, or half space across an axis, whose face lies within 1e-6 h of a layer of nodes: round-off of the mesh
/// decides which side these are on. `what` has the region: "support wall".
std::vector<std::string> warn_of_layers(const Body& body, const std::string& what, const Region& region);

/// "from (0, 0, 0) to (1, 2, 3) m"
std::string extent(const Points& points);

} // namespace kerf::scene
