#pragma once

/// Fronts of cracks whose energy release rates would be wrong, said before a run begins: the figures do not show it.

#include "scene/world.h"

#include <span>
#include <string>
#include <vector>

namespace kerf::scene {

/// Warns of a front whose outer tube reaches over the skin ahead of it or behind it; of one whose crack ends again
/// before its tubes end; and, where discs and rectangles cut at once and nothing else does, of one within a cube of
/// which none of them ends. The body is not cut yet.
std::vector<std::string> warn_of_fronts(const Body& body, const World& world);

/// Of a body that has been cut, also by what has no known end, as blades: says which front no cut has come to, and
/// which one a cut has gone beyond. At most a line each.
std::vector<std::string> fronts_that_cuts_missed(const Body& body);

} // namespace kerf::scene
