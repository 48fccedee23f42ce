#pragma once

/// Names of units that mean the same.

#include <string>

namespace kerf::study {

/// The series of modes are in Hz, what counts passages and formulas in 1/s.
inline bool is_same_unit(const std::string& a, const std::string& b) {
  const auto is_frequency = [](const std::string& unit) { return unit == "1/s" || unit == "Hz"; };
  return a == b || (is_frequency(a) && is_frequency(b));
}

} // namespace kerf::study
