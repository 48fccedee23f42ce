#include "dynamics/body_force.h"

#include "base/error.h"

namespace kerf::dynamics {

BodyForce::BodyForce(std::vector<double> volume, Points rest, Field density)
  : volume_(std::move(volume)), rest_(std::move(rest)), density_(std::move(density)) {
  if (volume_.size() != rest_.size())
    throw ParameterError("a body force needs a rest position for each corner's volume");
}

double BodyForce::energy(const double time, const Points& x) const {
  double sum = 0;
  for (std::size_t i = 0; i < volume_.size(); ++i)
    sum -= volume_[i] * density_(rest_[i], time).dot(x[i] - rest_[i]);
  return sum;
}

void BodyForce::add_force(const Moment& moment, Points& forces) const {
  for (std::size_t i = 0; i < volume_.size(); ++i)
    forces[i] += volume_[i] * density_(rest_[i], moment.time);
}

} // namespace kerf::dynamics
