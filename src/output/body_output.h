#pragma once

/// One body's part of a run's file: its complexes, surfaces and frames.

#include "output/h5_array.h"
#include "output/records.h"

#include <string>

namespace kerf::output {

/// How much of a body is in the file.
struct BodyCounts {
  std::size_t n_frames = 0, n_complexes = 0, n_surfaces = 0;
  std::size_t n_corners = 0; ///< of the last complex
};

/// Throws DataError unless the arrays fit each other and what was written before.
void check(const BodyStep& step, const BodyCounts& counts, const std::string& file);

/// Writes a frame, and before it the complex and the surface where they are new.
void write_body(const h5::Object& root, const BodyStep& step, double time, std::int64_t number, BodyCounts& counts);

} // namespace kerf::output
