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
    for (std::size_t i = 0; i < support.corners.size(); ++i) {
      const auto c = support.corners[i];
      const Vec3 target = support.rest[i] + displacement;
      v[c] = (target - x[c]) / dt;
      x[c] = target;
    }
  }
}

} // namespace kerf::dynamics
