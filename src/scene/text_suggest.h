#pragma once

/// The name that was probably meant.

#include <optional>
#include <string>
#include <vector>

namespace kerf::scene {

/// Insertions, deletions, substitutions and exchanges of neighbours between two texts, ignoring case (Damerau 1964;
/// what was exchanged is not edited again).
int edit_distance(const std::string& a, const std::string& b);

/// The nearest of `names`, also when only the unit in brackets is missing or wrong; nothing when none is near.
std::optional<std::string> nearest(const std::string& word, const std::vector<std::string>& names);

/// "Did you mean 'Density [kg/m^3]'?", or else "Allowed are 'A', 'B'", or `if_none` when there are no names.
std::string suggestion(const std::string& word, const std::vector<std::string>& names, const std::string& if_none);

} // namespace kerf::scene
