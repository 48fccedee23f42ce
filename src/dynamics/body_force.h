#pragma once

/// A force per rest volume, a function of rest position and time: dead, so with a potential at each time.

#include "base/parameters.h"
#include "dynamics/load.h"

#include <functional>

namespace kerf::dynamics {

/// A vector at a rest position X [m] and a time [s].
using Field = std::function<Vec3(const Vec3& X, double time)>;

class BodyForce : public Load {
 public:
  /// volume [m^3] and rest position [m] of each corner; density [N/m^3], world frame. Throws ParameterError for lists
  /// of different length.
  BodyForce(std::vector<double> volume, Points rest, Field density);

  Nature nature() const override { return Nature::conservative; }
  double energy(double time, const Points& x) const override;
  void add_force(const Moment& moment, Points& forces) const override;
  void add_tangent(Tangent, const Moment&, double, LoadTangent&) const override {} // does not depend on x

 private:
  std::vector<double> volume_;
  Points rest_;
  Field density_;
};

struct BodyForceParameters {
  std::string density = "0; 0; 0"; ///< [N/m^3]

  void describe(Parameters& p) {
    p.text("Force density [N/m^3]", density,
           "Force per rest volume: three functions of x, y, z (rest position, m) and t (s), separated by semicolons.");
  }
};

} // namespace kerf::dynamics
