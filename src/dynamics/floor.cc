#include "dynamics/floor.h"

#include "base/error.h"

namespace kerf::dynamics {

namespace {

/// g(s) / s and the derivative of g.
struct Slip {
  double secant, slope; ///< [s/m]
};

Slip slip(const double s, const double e) {
  return s < e ? Slip{(2 - s / e) / e, 2 * (1 - s / e) / e} : Slip{1 / s, 0};
}

} // namespace

Floor::Floor(ContactPoints points, const FloorParameters& parameters)
  : contact_(std::move(points)), parameters_(parameters) {
  if (contact_.areas.size() != contact_.points.n_points())
    throw ParameterError("a floor needs an area for each contact point");
  if (!(parameters_.normal.norm() > 0) || !parameters_.normal.allFinite())
    throw ParameterError(
      Complaint{.path = "Normal [1]", .rule = "must have a length", .remedy = "Write a vector that is not zero"});
  parameters_.normal = parameters_.normal.stableNormalized();
}

double Floor::depth(const std::size_t i, const Points& x) const {
  return (parameters_.point - contact_.points.at(i, x)).dot(normal());
}

double Floor::energy(double, const Points& x) const {
  double sum = 0;
  for (std::size_t i = 0; i < contact_.areas.size(); ++i)
    if (const double d = depth(i, x); d > 0)
      sum += 0.5 * point_stiffness(i) * d * d;
  return sum;
}

void Floor::add_force(const Moment& moment, Points& forces) const {
  for (std::size_t i = 0; i < contact_.areas.size(); ++i)
    if (const double d = depth(i, moment.x); d > 0)
      contact_.points.add_force(i, point_stiffness(i) * d * normal(), forces);
}

void Floor::add_tangent(Tangent, const Moment& moment, double, LoadTangent& tangent) const {
  const Mat3 along_normal = normal() * normal().transpose();
  for (std::size_t i = 0; i < contact_.areas.size(); ++i)
    if (depth(i, moment.x) > 0)
      tangent.add(contact_.points, i, i, point_stiffness(i) * along_normal);
}

void FloorFriction::add_force(const Moment& moment, Points& forces) const {
  const double mu = floor_.parameters().friction, e = floor_.parameters().creep;
  const Vec3& n = floor_.normal();
  for (std::size_t i = 0; i < floor_.points().n_points(); ++i)
    if (const double d = floor_.depth(i, moment.x); d > 0) {
      const Vec3 v = floor_.points().at(i, moment.v), along = v - v.dot(n) * n;
      floor_.points().add_force(i, -mu * floor_.point_stiffness(i) * d * slip(along.norm(), e).secant * along, forces);
    }
}

void FloorFriction::add_tangent(const Tangent kind, const Moment& moment, const double velocity_factor,
                                LoadTangent& tangent) const {
  const double mu = floor_.parameters().friction, e = floor_.parameters().creep;
  const Vec3& n = floor_.normal();
  for (std::size_t i = 0; i < floor_.points().n_points(); ++i)
    if (const double d = floor_.depth(i, moment.x); d > 0) {
      const Vec3 v = floor_.points().at(i, moment.v), along = v - v.dot(n) * n;
      const double s = along.norm(), k = floor_.point_stiffness(i);
      const Slip g = slip(s, e);
      const Vec3 t = s > 0 ? Vec3(along / s) : Vec3(Vec3::Zero());
      Mat3 block =
        velocity_factor * mu * k * d *
        (g.secant * (Mat3::Identity() - n * n.transpose() - t * t.transpose()) + g.slope * t * t.transpose());
      if (kind == Tangent::exact)
        block -= mu * k * g.secant * along * n.transpose();
      tangent.add(floor_.points(), i, i, block);
    }
}

} // namespace kerf::dynamics
