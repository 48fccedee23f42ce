#pragma once

/// A handle: a point of the body drawn by a spring, and braked by a damper, towards a target that may move.

#include "base/parameters.h"
#include "dynamics/load.h"

#include <functional>

namespace kerf::dynamics {

/// A position at a time [s], world frame [m].
using Path = std::function<Vec3(double time)>;

/// A force -stiffness (W x - target).
class HandleSpring : public Load {
 public:
  /// point: the one point that is drawn; stiffness [N/m]. Throws ParameterError for another number of points, for a
  /// point without corners or for a negative stiffness.
  HandleSpring(Interpolation point, double stiffness, Path target);

  Nature nature() const override { return Nature::conservative; }
  double energy(double time, const Points& x) const override;
  void add_force(const Moment& moment, Points& forces) const override;
  void add_tangent(Tangent kind, const Moment& moment, double velocity_factor, LoadTangent& tangent) const override;

 private:
  Interpolation point_;
  double stiffness_;
  Path target_;
};

/// A force -damping (W v - velocity of the target).
class HandleDamper : public Load {
 public:
  /// damping [N s/m]; else as HandleSpring. The target's velocity is taken by central differences over 1e-5 s.
  HandleDamper(Interpolation point, double damping, Path target);

  Nature nature() const override { return Nature::driving; } // a moving target drags
  double energy(double, const Points&) const override { return 0; }
  void add_force(const Moment& moment, Points& forces) const override;
  void add_tangent(Tangent kind, const Moment& moment, double velocity_factor, LoadTangent& tangent) const override;

 private:
  Interpolation point_;
  double damping_;
  Path target_;
};

struct HandleParameters {
  Vec3 point = Vec3::Zero(); ///< rest configuration [m]
  double stiffness = 100;    ///< [N/m]
  double damping = 0;        ///< [N s/m]
  std::string displacement = "0; 0; 0";

  void describe(Parameters& p) {
    p.vector("Point [m]", point, "Where the body is gripped, rest configuration.");
    p.require_last();
    p.number("Stiffness [N/m]", stiffness, positive, "Of the spring between the point and its target.");
    p.number("Damping [N s/m]", damping, non_negative, "Of the damper beside the spring.");
    p.text("Displacement [m]", displacement,
           "Of the target from the point at rest: three functions of t (s), separated by semicolons.");
  }
};

} // namespace kerf::dynamics
