// A rigid body in flight: what it keeps to round-off, closed forms, and the order of its attitude.

#include "dynamics/rigid_body.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <array>
#include <cmath>

namespace kerf::dynamics::rigid_body_test {
namespace {

RigidBody lump() {
  const Mat3 axes = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  return {2e-3, Vec3(0.1, 0.2, 0.3), axes * Vec3(1e-7, 2.3e-7, 3e-7).asDiagonal() * axes.transpose()};
}

RigidMotion thrown(const RigidBody& body, const Vec3& omega) {
  return {Vec3(1, -2, 0.5), Vec3(0.3, 0, 2), Mat3::Identity(), body.inertia * omega};
}

/// Energy of rotation [J].
double spinning(const RigidBody& body, const RigidMotion& motion) {
  return 0.5 * motion.spin.dot(angular_velocity(body, motion));
}

/// 10^5 steps of a tumble about an axis near the unstable one, a third of a radian each.
TEST(RigidBody, KeepsSpinAndEnergyThroughManySteps) {
  const RigidBody body = lump();
  RigidMotion motion = thrown(body, Vec3(8, 17, -5));
  const Vec3 spin = motion.spin;
  const double energy = spinning(body, motion);
  double worst = 0;
  for (int i = 0; i < 100000; ++i) {
    fly(body, Vec3::Zero(), 0, 1.0 / 60, motion);
    worst = std::max(worst, std::abs(spinning(body, motion) / energy - 1));
  }
  std::printf("10^5 steps of a tumble: energy off by %.1e\n", worst);
  EXPECT_EQ(motion.spin, spin);
  EXPECT_LT(worst, 1e-11);
  EXPECT_LT((motion.R.transpose() * motion.R - Mat3::Identity()).norm(), 1e-14);
}

/// However long the step is.
TEST(RigidBody, KeepsEnergyInLongSteps) {
  const RigidBody body = lump();
  for (const double dt : {1e-4, 1e-2, 0.3, 3.0}) {
    RigidMotion motion = thrown(body, Vec3(8, 17, -5));
    const double energy = spinning(body, motion);
    for (int i = 0; i < 100; ++i)
      fly(body, Vec3::Zero(), 0, dt, motion);
    EXPECT_NEAR(spinning(body, motion), energy, 1e-12 * energy) << dt;
  }
}

TEST(RigidBody, AttitudeIsOfSecondOrder) {
  const RigidBody body = lump();
  const auto attitude = [&](const int n) {
    RigidMotion motion = thrown(body, Vec3(3, 5, -2));
    for (int i = 0; i < n; ++i)
      fly(body, Vec3::Zero(), 0, 1.0 / n, motion);
    return motion.R;
  };
  const Mat3 exact = attitude(20000);
  const double coarse = (attitude(50) - exact).norm(), fine = (attitude(100) - exact).norm();
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.1);
}

/// About a principal axis the angle is omega t to the order of the rule: 2 atan(omega dt / 2) a step.
TEST(RigidBody, TurnsAboutAPrincipalAxisAsTheRuleSays) {
  RigidBody body = lump();
  body.inertia = Vec3(1e-7, 2e-7, 3e-7).asDiagonal();
  RigidMotion motion = thrown(body, Vec3(0, 0, 5));
  fly(body, Vec3::Zero(), 0, 0.1, motion);
  const Eigen::AngleAxisd turn(motion.R);
  EXPECT_NEAR(turn.angle(), 2 * std::atan(0.25), 1e-14);
  EXPECT_NEAR(turn.axis()[2], 1, 1e-14);
}

/// In gravity and damping: x'' = g - a x', exactly, in one step as in many; the spin decays alike.
TEST(RigidBody, FliesByTheClosedForm) {
  const RigidBody body = lump();
  const Vec3 g(0, 1, -9.81);
  for (const double alpha : {0.0, 1e-6, 0.4, 20.0})
    for (const int n : {1, 7, 1000}) {
      RigidMotion motion = thrown(body, Vec3(8, 17, -5));
      const RigidMotion start = motion;
      const double t = 0.8;
      for (int i = 0; i < n; ++i)
        fly(body, g, alpha, t / n, motion);
      const double e = std::exp(-alpha * t);
      const Vec3 v = alpha == 0 ? Vec3(start.v + t * g) : Vec3(start.v * e + g * -std::expm1(-alpha * t) / alpha);
      EXPECT_LT((motion.v - v).norm(), 1e-9) << alpha << ", " << n;
      EXPECT_LT((motion.spin - e * start.spin).norm(), 1e-12 * start.spin.norm());
      const Vec3 x = alpha < 1e-3 ? Vec3(start.x + t * start.v + 0.5 * t * t * (g - alpha * start.v))
                                  : Vec3(start.x + (start.v - v + t * g) / alpha);
      EXPECT_LT((motion.x - x).norm(), alpha == 1e-6 ? 2e-6 : 1e-11) << alpha << ", " << n;
    }
}

/// Masses in one place have an inertia of round-off about their mean, and turn about nothing; those in a row not about
/// it.
TEST(AngularVelocity, KnowsNoAxisWithoutInertia) {
  const Vec3 place(0.1, 0.7, 0.3), along = Vec3(1, 2, -2) / 3, L(1e-3, -2e-3, 5e-4);
  for (const double length : {0.0, 0.2}) {
    double mass = 0;
    Vec3 moment = Vec3::Zero();
    std::array<Vec3, 3> places;
    for (int k = 0; k < 3; ++k) {
      places[k] = place + length * k * along;
      mass += 0.1 * (k + 1);
      moment += 0.1 * (k + 1) * places[k];
    }
    const Vec3 centre = moment / mass;
    Mat3 inertia = Mat3::Zero();
    for (int k = 0; k < 3; ++k) {
      const Vec3 r = places[k] - centre;
      inertia += 0.1 * (k + 1) * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
    }
    const Vec3 omega = angular_velocity(inertia, mass * centre.squaredNorm(), L);
    if (length == 0) {
      EXPECT_EQ(omega, Vec3(Vec3::Zero()));
    } else {
      EXPECT_LT(std::abs(omega.dot(along)), 1e-12 * omega.norm());
      EXPECT_LT((inertia * omega - (L - along.dot(L) * along)).norm(), 1e-12);
    }
  }
}

} // namespace
} // namespace kerf::dynamics::rigid_body_test
