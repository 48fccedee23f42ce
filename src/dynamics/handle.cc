#include "dynamics/handle.h"

#include "base/error.h"

namespace kerf::dynamics {

namespace {

void check(const Interpolation& point, const double strength, const std::string& name) {
  if (point.n_points() != 1 || point.columns.empty())
    throw ParameterError(Complaint{.rule = "a handle holds one point of the body, and found none",
                                   .remedy = "Choose a point inside the body at rest"});
  if (!(strength >= 0))
    throw ParameterError(Complaint{.path = name,
                                   .value = to_text(strength),
                                   .rule = "must be >= 0",
                                   .remedy = "A handle resists, it does not push"});
}

Vec3 velocity(const Path& path, const double time) {
  constexpr double delta = 1e-5; // [s]
  return (path(time + delta) - path(time - delta)) / (2 * delta);
}

} // namespace

HandleSpring::HandleSpring(Interpolation point, const double stiffness, Path target)
  : point_(std::move(point)), stiffness_(stiffness), target_(std::move(target)) {
  check(point_, stiffness_, "Stiffness [N/m]");
}

double HandleSpring::energy(const double time, const Points& x) const {
  return 0.5 * stiffness_ * (point_.at(0, x) - target_(time)).squaredNorm();
}

void HandleSpring::add_force(const Moment& moment, Points& forces) const {
  point_.add_force(0, -stiffness_ * (point_.at(0, moment.x) - target_(moment.time)), forces);
}

void HandleSpring::add_tangent(Tangent, const Moment&, double, LoadTangent& tangent) const {
  tangent.add(point_, 0, 0, stiffness_ * Mat3::Identity());
}

HandleDamper::HandleDamper(Interpolation point, const double damping, Path target)
  : point_(std::move(point)), damping_(damping), target_(std::move(target)) {
  check(point_, damping_, "Damping [N s/m]");
}

void HandleDamper::add_force(const Moment& moment, Points& forces) const {
  point_.add_force(0, -damping_ * (point_.at(0, moment.v) - velocity(target_, moment.time)), forces);
}

void HandleDamper::add_tangent(Tangent, const Moment&, const double velocity_factor, LoadTangent& tangent) const {
  tangent.add(point_, 0, 0, velocity_factor * damping_ * Mat3::Identity());
}

} // namespace kerf::dynamics
