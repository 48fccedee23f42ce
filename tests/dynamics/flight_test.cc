// Bodies that fly side by side, against each by itself (rigid_body.h).

#include "dynamics/flight.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <random>

namespace kerf::dynamics::flight_test {
namespace {

constexpr std::size_t n_bodies = 101; // the last eight are not full

double uniform(std::mt19937& random, const double from, const double to) {
  return from + (to - from) * static_cast<double>(random()) / std::mt19937::max();
}

Vec3 any(std::mt19937& random, const double most) {
  return Vec3(uniform(random, -most, most), uniform(random, -most, most), uniform(random, -most, most));
}

Mat3 any_rotation(std::mt19937& random) {
  return Eigen::AngleAxisd(uniform(random, 0, 6), any(random, 1).normalized()).toRotationMatrix();
}

/// Of all sizes; some stand still, some turn by many radians in a step.
struct Swarm {
  std::vector<RigidBody> bodies;
  std::vector<RigidMotion> motions;

  explicit Swarm(const double dt) {
    std::mt19937 random(7);
    for (std::size_t b = 0; b < n_bodies; ++b) {
      const Mat3 axes = any_rotation(random);
      const double size = std::pow(10, uniform(random, -12, 2));
      const Vec3 moments = size * Vec3(uniform(random, 1, 1.4), uniform(random, 1, 1.4), uniform(random, 0.5, 1.4));
      bodies.push_back({uniform(random, 1e-6, 1), any(random, 1), axes * moments.asDiagonal() * axes.transpose()});
      RigidMotion motion{any(random, 3), any(random, 2), any_rotation(random), Vec3::Zero()};
      if (b % 7 != 0)
        motion.spin = motion.R * bodies.back().inertia * motion.R.transpose() * any(random, (b % 5 == 0 ? 9 : 0.5) / dt);
      motions.push_back(motion);
    }
  }

  auto body() const {
    return [&](const std::size_t b) -> const RigidBody& { return bodies[b]; };
  }
};

TEST(Flight, OfManyIsThatOfEach) {
  const Vec3 g(0.3, 1, -9.81);
  for (const double dt : {1e-4, 1.0 / 60})
    for (const double alpha : {0.0, 0.7, 300.0}) {
      Swarm swarm(dt);
      for (int step = 0; step < 20; ++step) {
        std::vector<RigidMotion> each = swarm.motions;
        for (std::size_t b = 0; b < n_bodies; ++b)
          fly(swarm.bodies[b], g, alpha, dt, each[b]);
        fly(swarm.body(), g, alpha, dt, swarm.motions);
        for (std::size_t b = 0; b < n_bodies; ++b) {
          EXPECT_EQ(swarm.motions[b].x, each[b].x);
          EXPECT_EQ(swarm.motions[b].v, each[b].v);
          EXPECT_EQ(swarm.motions[b].spin, each[b].spin);
          EXPECT_LT((swarm.motions[b].R - each[b].R).norm(), 1e-13) << b << ", dt " << dt << ", alpha " << alpha;
          EXPECT_LT((swarm.motions[b].R.transpose() * swarm.motions[b].R - Mat3::Identity()).norm(), 1e-14);
        }
      }
    }
}

TEST(Flight, DoesNotDependOnWhoIsBeside) {
  constexpr double dt = 0.01;
  Swarm together(dt), alone(dt);
  fly(together.body(), Vec3::Zero(), 0, dt, together.motions);
  for (std::size_t b = 0; b < n_bodies; ++b) {
    fly([&](std::size_t) -> const RigidBody& { return alone.bodies[b]; }, Vec3::Zero(), 0, dt,
        std::span(&alone.motions[b], 1));
    EXPECT_EQ(alone.motions[b].R, together.motions[b].R);
  }
}

/// 10^5 steps of tumbles about axes near the unstable one, as of one body alone (RigidBody).
TEST(Flight, KeepsSpinAndEnergyThroughManySteps) {
  Swarm swarm(1);
  swarm.bodies.resize(8);
  swarm.motions.resize(8);
  std::vector<double> energies;
  for (std::size_t b = 0; b < 8; ++b) {
    swarm.motions[b].spin = swarm.motions[b].R * swarm.bodies[b].inertia * Vec3(0.02 * double(b), 0.5, -0.01);
    energies.push_back(swarm.motions[b].spin.dot(angular_velocity(swarm.bodies[b], swarm.motions[b])));
  }
  const std::vector<RigidMotion> start = swarm.motions;
  double worst = 0;
  for (int i = 0; i < 100000; ++i) {
    fly(swarm.body(), Vec3::Zero(), 0, 1, swarm.motions);
    for (std::size_t b = 0; b < 8; ++b)
      worst = std::max(worst, std::abs(swarm.motions[b].spin.dot(angular_velocity(swarm.bodies[b], swarm.motions[b])) /
                                         energies[b] -
                                       1));
  }
  std::printf("10^5 steps of eight tumbles: energy off by %.1e\n", worst);
  EXPECT_LT(worst, 1e-11);
  for (std::size_t b = 0; b < 8; ++b)
    EXPECT_EQ(swarm.motions[b].spin, start[b].spin);
}

TEST(Flight, CarriesPointsAsBodiesDo) {
  Swarm swarm(0.1);
  std::mt19937 random(3);
  std::vector<Vec3> omegas(n_bodies);
  put_angular_velocities(swarm.body(), swarm.motions, omegas);
  for (std::size_t b = 0; b < n_bodies; ++b) {
    const Vec3 omega = angular_velocity(swarm.bodies[b], swarm.motions[b]);
    EXPECT_LT((omegas[b] - omega).norm(), 1e-13 * omega.norm() + 1e-300);
    const std::size_t n = b % 30;
    Points rest, x(2 * n + 1, Vec3::Constant(-7)), v = x;
    std::vector<std::uint32_t> places;
    for (std::size_t i = 0; i < n; ++i) {
      rest.push_back(swarm.bodies[b].centre + any(random, 0.1));
      places.push_back(static_cast<std::uint32_t>(2 * (n - 1 - i) + 1)); // backwards, each second one
    }
    carry(swarm.bodies[b], swarm.motions[b], omega, rest, places.data(), x, v);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 at = place(swarm.bodies[b], swarm.motions[b], rest[i]);
      EXPECT_LT((x[places[i]] - at).norm(), 1e-14);
      EXPECT_LT((v[places[i]] - velocity(swarm.motions[b], omega, at)).norm(), 1e-13 * (1 + omega.norm()));
    }
    for (std::size_t i = 0; i < x.size(); i += 2) // the others stay
      EXPECT_TRUE(x[i] == Vec3(Vec3::Constant(-7)) && v[i] == x[i]);
  }
}

} // namespace
} // namespace kerf::dynamics::flight_test
