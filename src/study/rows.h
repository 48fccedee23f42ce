#pragma once

/// What the rows of studies and of stability tables have in common.

#include <limits>
#include <string>
#include <vector>

namespace kerf::study {

/// A number that a row does not have.
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// What a row changes of its scene, "key=value | key=value".
inline std::string changes_in_one_line(const std::vector<std::string>& overrides) {
  std::string all;
  for (const std::string& change : overrides)
    all += (all.empty() ? "" : " | ") + change;
  return all;
}

} // namespace kerf::study
