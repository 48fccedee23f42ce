#include "dynamics/followers.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace kerf::dynamics {

Vec3 led_along(const Follower& follower, const std::span<const double> mass, const Points& x, const Points& values) {
  constexpr double in_a_row = 1e-3; // of their largest moment of inertia
  const std::span<const std::uint32_t> leaders(follower.leaders.data(), follower.n_leaders);
  double all = 0;
  Vec3 centre = Vec3::Zero(), mean = Vec3::Zero(), spin = Vec3::Zero();
  for (const auto j : leaders) {
    all += mass[j];
    centre += mass[j] * x[j];
    mean += mass[j] * values[j];
  }
  centre /= all;
  mean /= all;
  Mat3 inertia = Mat3::Zero();
  for (const auto j : leaders) {
    const Vec3 r = x[j] - centre;
    inertia += mass[j] * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
    spin += mass[j] * r.cross(values[j] - mean);
  }
  const Eigen::LDLT<Mat3> factors(inertia);
  if (!(factors.rcond() > in_a_row))
    return mean;
  const Vec3 rigid = factors.solve(spin).cross(x[follower.corner] - centre), affine = follower.led(values) - mean;
  return mean + (rigid.squaredNorm() < affine.squaredNorm() ? rigid : affine);
}

void lead_along(const ForceModel& model, const Points& x, Points& v) {
  const auto mass = model.lumped_mass();
  for (const Follower& follower : model.followers())
    v[follower.corner] = led_along(follower, mass, x, v);
}

} // namespace kerf::dynamics
