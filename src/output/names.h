#pragma once

/// Where things stand inside a run's file: one place for writer and reader.

#include "output/records.h"

#include <string>

namespace kerf::output {

/// "000042", so that names sort as numbers do.
inline std::string index_name(const std::size_t index) {
  const auto digits = std::to_string(index);
  return digits.size() < 6 ? std::string(6 - digits.size(), '0') + digits : digits;
}

inline std::string body_path(const std::string& body, const std::string& part) {
  return "/bodies/" + body + "/" + part;
}

inline constexpr const char* library_prefix = "library "; ///< of the root attributes that name a library's version

inline std::string to_string(const Outcome outcome) {
  return outcome == Outcome::running     ? "running"
         : outcome == Outcome::completed ? "completed"
         : outcome == Outcome::failed    ? "failed"
                                         : "interrupted";
}

} // namespace kerf::output
