#pragma once

/// A plane floor that bodies land on, by penalty, with regularised Coulomb friction.
///
/// A contact point of area A at a depth d = -(x - p).n > 0 is pushed with N = k A d along n, of potential k A d^2 / 2.
/// Friction takes -mu N g(s) v_t / s from its tangential velocity v_t of length s, with g = (s/e)(2 - s/e) below the
/// velocity e and 1 above, so it is continuous, and never drives. Sticking is then creeping, slower than e.
/// Source: Wriggers, Computational Contact Mechanics (2006), ch. 5 (penalty), 5.2.3 (regularised friction law).
/// Limits: a resting body sinks by its weight over k times its area. Friction stiffens explicit steps by
/// 2 mu N / (m e), which a longer step dt answers by quivering at up to mu N dt / m and creeping at less than that, no
/// more.

#include "base/parameters.h"
#include "dynamics/load.h"

namespace kerf::dynamics {

/// Where a body can be touched, and the area that each point stands for [m^2].
struct ContactPoints {
  Interpolation points;
  std::vector<double> areas;
};

struct FloorParameters {
  Vec3 point = Vec3::Zero(), normal = Vec3::UnitZ(); ///< of the plane; the normal points to the free side [m], [1]
  double stiffness = 1e6;                            ///< pressure per depth [N/m^3]
  double friction = 0.5;                             ///< Coulomb's mu [1]
  double creep = 1e-3;                               ///< the velocity e up to which friction builds up [m/s]

  void describe(Parameters& p) {
    p.vector("Point [m]", point, "On the floor.");
    p.vector("Normal [1]", normal, "Points away from the floor to where bodies are; of any length.");
    p.number("Stiffness [N/m^3]", stiffness, positive, "Pressure of the floor per depth of penetration.");
    p.number("Friction [1]", friction, non_negative,
             "Coulomb's coefficient; 0 for none. It needs 'Newton iterations [1] = 3' or more of implicit integrators.");
    p.number("Creep velocity [m/s]", creep, positive, "Friction is full from here on; sticking bodies creep slower.");
  }
};

class Floor : public Load {
 public:
  /// Throws ParameterError for a normal without length or not one area a point.
  Floor(ContactPoints points, const FloorParameters& parameters);

  Nature nature() const override { return Nature::conservative; }
  double energy(double time, const Points& x) const override;
  void add_force(const Moment& moment, Points& forces) const override;
  void add_tangent(Tangent kind, const Moment& moment, double velocity_factor, LoadTangent& tangent) const override;

  const Interpolation& points() const { return contact_.points; }
  const FloorParameters& parameters() const { return parameters_; }
  const Vec3& normal() const { return parameters_.normal; } ///< of length 1
  /// How deep point i is below the floor [m]; negative above it.
  double depth(std::size_t i, const Points& x) const;
  /// k A of point i [N/m].
  double point_stiffness(const std::size_t i) const { return parameters_.stiffness * contact_.areas[i]; }

 private:
  ContactPoints contact_;
  FloorParameters parameters_;
};

/// The friction of a floor.
class FloorFriction : public Load {
 public:
  /// The floor must outlive it.
  explicit FloorFriction(const Floor& floor) : floor_(floor) {}

  Nature nature() const override { return Nature::dissipative; }
  double energy(double, const Points&) const override { return 0; }
  void add_force(const Moment& moment, Points& forces) const override;
  /// The change of N with x couples friction to the normal, unsymmetrically: only in the exact one.
  void add_tangent(Tangent kind, const Moment& moment, double velocity_factor, LoadTangent& tangent) const override;
  bool is_bounded_in_velocity() const override { return true; }

 private:
  const Floor& floor_;
};

} // namespace kerf::dynamics
