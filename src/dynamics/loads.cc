#include "dynamics/loads.h"

namespace kerf::dynamics {

std::vector<std::uint8_t> held_corners(const Loads& loads, const std::size_t n_corners) {
  std::vector<std::uint8_t> held(n_corners, 0);
  for (const Support& support : loads.supports)
    for (const auto c : support.corners)
      held[c] = 1;
  return held;
}

void move_held(const Loads& loads, const double time, const double dt, Points& x, Points& v) {
  for (const Support& support : loads.supports) {
    const Vec3 displacement = support.displacement(time);
    for (std::size_t i = 0; i < support.corners.size(); ++i)
      v[support.corners[i]] = (support.rest[i] + displacement - x[support.corners[i]]) / dt;
  }
  // Only now: a corner may be in several supports, and the last one decides both.
  for (const Support& support : loads.supports) {
    const Vec3 displacement = support.displacement(time);
    for (std::size_t i = 0; i < support.corners.size(); ++i)
      x[support.corners[i]] = support.rest[i] + displacement;
  }
}

} // namespace kerf::dynamics
