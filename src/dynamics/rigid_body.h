#pragma once

/// A body that moves as one, and how it flies.
///
/// In flight its centre obeys v' = g - alpha v and its spin L' = -alpha L, which are solved exactly. Its momentum in
/// the frame of the body, Pi = R^T L, follows Euler's equation by the implicit midpoint rule, and its attitude by the
/// rule's Cayley map (Austin, Krishnaprasad and Wang 1993, Almost Poisson integration of rigid body systems, Journal of
/// Computational Physics 107, 105-117):
///
///     Pi_1 - Pi_0 = dt Pi x xi,   R_1 = R_0 cay(dt xi),   xi = I^-1 Pi,   Pi = (Pi_0 + Pi_1) / 2.
///
/// That keeps L and the energy of rotation to round-off for any dt; the attitude is of second order in dt.

#include "base/archive.h"
#include "base/vec.h"

namespace kerf::dynamics {

/// What it is at rest.
struct RigidBody {
  double mass = 0;             ///< [kg]
  Vec3 centre = Vec3::Zero();  ///< [m]
  Mat3 inertia = Mat3::Zero(); ///< about the centre [kg m^2]; positive definite

  void archive(Archive& a) { a(mass, centre, inertia); }
};

struct RigidMotion {
  Vec3 x = Vec3::Zero();     ///< of the centre [m]
  Vec3 v = Vec3::Zero();     ///< [m/s]
  Mat3 R = Mat3::Identity(); ///< attitude
  Vec3 spin = Vec3::Zero();  ///< angular momentum about the centre, world frame [kg m^2/s]

  void archive(Archive& a) { a(x, v, R, spin); }
};

/// World frame [rad/s].
Vec3 angular_velocity(const RigidBody& body, const RigidMotion& motion);
/// Of masses that have an inertia about their centre and, were they all there, another one about the origin [kg m^2],
/// with an angular momentum L. Axes about which they have hardly any but round-off are left out: one mass has no other.
Vec3 angular_velocity(const Mat3& inertia, double about_origin, const Vec3& L);
/// Where a point of the body is that rests at X [m].
inline Vec3 place(const RigidBody& body, const RigidMotion& motion, const Vec3& X) {
  return motion.x + motion.R * (X - body.centre);
}
/// Of a point of the body that is at x now, with its angular velocity omega [m/s].
inline Vec3 velocity(const RigidMotion& motion, const Vec3& omega, const Vec3& x) {
  const Vec3 r = x - motion.x;
  return motion.v +
         Vec3(omega[1] * r[2] - omega[2] * r[1], omega[2] * r[0] - omega[0] * r[2], omega[0] * r[1] - omega[1] * r[0]);
}
/// Of flight and rotation [J].
double kinetic_energy(const RigidBody& body, const RigidMotion& motion);

/// Flies for dt [s] under gravity [m/s^2] and mass damping alpha [1/s]. Many at once: flight.h.
void fly(const RigidBody& body, const Vec3& gravity, double alpha, double dt, RigidMotion& motion);

/// What mass damping alpha [1/s] leaves of velocity and spin within dt [s].
class Decay {
 public:
  Decay(double alpha, double dt);

  /// In the mean of the step, over what there was [1].
  double mean() const { return mean_; }
  double end() const;
  /// Moves the centre on.
  void move(const Vec3& gravity, RigidMotion& motion) const;

 private:
  double alpha_, dt_, mean_, of_force_;
};

/// Turns the attitude alone for dt, by as many steps of the midpoint rule as keep each below 1 rad. `mean`: of the spin
/// in the step, over what it is now.
void turn(const RigidBody& body, double mean, double dt, RigidMotion& motion);

/// R after a turn by a rotation vector [rad], world frame.
Mat3 turned(const Mat3& R, const Vec3& angle);

} // namespace kerf::dynamics
