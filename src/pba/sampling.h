#pragma once

/// Points spread through a region, one for each cube of the given spacing on average: a jittered grid, or a Poisson
/// disk sample (dart throwing: Cook 1986) in which no two are near each other. The random numbers are the
/// 53 high bits of std::mt19937_64, so the same seed gives the same points everywhere.

#include "base/parameters.h"

#include <functional>

namespace kerf::pba {

struct SamplingOptions {
  std::string distribution = "jittered grid"; ///< or "Poisson disk"
  double spacing = 0; ///< cube root of the mean volume of a point [m]; 0: for a body, the edge of its cubes
  double jitter = 0.5;                        ///< of the grid: largest shift along each axis over half the spacing [1]
  int seed = 1;

  void describe(Parameters& p) {
    p.choice("Distribution", distribution, {"jittered grid", "Poisson disk"},
             "How phyxels are spread: a grid with random shifts, or random points that keep their distance.");
    p.number("Spacing [m]", spacing, non_negative,
             "Cube root of the mean volume of a phyxel. 0: the edge of the grid's cubes.");
    p.number("Jitter [1]", jitter, {.min = 0, .max = 1},
             "Largest shift of a point of the jittered grid along each axis, over half the spacing.");
    p.integer("Seed [1]", seed, non_negative, "Of the random numbers that spread the phyxels.");
  }
};

/// Points of the region inside `box` for which `inside` holds [m]. The lattice of the jittered grid is centred in the
/// box. Throws ParameterError for an unknown distribution or no spacing.
Points sample(const Box& box, const std::function<bool(const Vec3&)>& inside, const SamplingOptions& options);

} // namespace kerf::pba
