// Bodies without a mesh file: mass and inertia against closed forms, wherever they lie; what is refused.

#include "base/error.h"
#include "dynamics/forces.h"
#include "tests/scene/trials.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace kerf::scene::shapes_test {
namespace {

constexpr double pi = std::numbers::pi;

World body_of(const Keys& keys) {
  return world_of(steps(0.01, 1) +
                  section("Body it", keys + Keys{"Cube edge [m] = 0.05", "Mass = consistent"}, material(1e6, 0.3)));
}

struct Inertia {
  double mass;
  Vec3 centre;
  Mat3 moments; ///< integral of density times (x - centre) (x - centre)^T
};

/// By the kinetic energies of linear fields, which the consistent mass integrates exactly.
Inertia inertia_of(Body& body) {
  const auto& model = body.physics->model();
  const Points& x = body.state.x;
  const Points p = dynamics::momenta(model, x);
  Inertia all{0, Vec3::Zero(), Mat3::Zero()};
  for (std::size_t i = 0; i < x.size(); ++i) {
    all.mass += model.lumped_mass()[i];
    all.centre += model.lumped_mass()[i] * x[i];
    all.moments += x[i] * p[i].transpose();
  }
  all.centre /= all.mass;
  all.moments -= all.mass * all.centre * all.centre.transpose();
  return all;
}

void expect(const Keys& keys, const double volume, const Vec3& centre, const Mat3& moments, const double allowed) {
  World world = body_of(keys);
  EXPECT_NEAR(world.bodies[0].mesh_volume / volume, 1, 1e-12);
  const Inertia found = inertia_of(world.bodies[0]);
  const double size = std::cbrt(volume);
  EXPECT_NEAR(found.mass / (1000 * volume), 1, allowed);
  EXPECT_LT((found.centre - centre).norm(), allowed * size);
  EXPECT_LT((found.moments / (1000 * volume) - moments).norm(), 2 * allowed * moments.norm());
}

/// Plane faces are met exactly where no edge of the box cuts a cell's corner off.
TEST(BodyShapes, ABoxHasItsMassAndInertia) {
  const Vec3 sides(0.6, 0.4, 0.5);
  const Mat3 moments = (sides.array().square() / 12).matrix().asDiagonal();
  expect({"Shape = box", "Sides [m] = 0.6, 0.4, 0.5"}, 0.12, Vec3::Zero(), moments, 1e-9);
  expect({"Shape = box", "Sides [m] = 0.6, 0.4, 0.5", "Centre [m] = 1, 2, -3"}, 0.12, {1, 2, -3}, moments, 1e-9);
  const Mat3 turn = Eigen::AngleAxisd(30 * pi / 180, Vec3(1, 2, 2) / 3).toRotationMatrix();
  expect({"Shape = box", "Sides [m] = 0.6, 0.4, 0.5", "Centre [m] = 1, 2, -3", "Rotation [degrees] = 10, 20, 20"}, 0.12,
         {1, 2, -3}, turn * moments * turn.transpose(), 5e-3);
}

TEST(BodyShapes, ABallHasItsMassAndInertia) {
  constexpr double r = 0.3;
  expect({"Shape = ball", "Radius [m] = 0.3", "Centre [m] = 0, 0.7, 0"}, 4 * pi / 3 * r * r * r, {0, 0.7, 0},
         r * r / 5 * Mat3::Identity(), 5e-3);
}

TEST(BodyShapes, ACylinderHasItsMassAndInertia) {
  constexpr double r = 0.25, h = 0.7;
  const Mat3 moments = Vec3(h * h / 12, r * r / 4, r * r / 4).asDiagonal();
  expect({"Shape = cylinder", "Radius [m] = 0.25", "Height [m] = 0.7", "Axis [1] = 3, 0, 0"}, pi * r * r * h,
         Vec3::Zero(), moments, 5e-3);
  const Mat3 turn = Eigen::AngleAxisd(pi / 4, Vec3::UnitZ()).toRotationMatrix();
  expect({"Shape = cylinder", "Radius [m] = 0.25", "Height [m] = 0.7", "Axis [1] = 1, 1, 0"}, pi * r * r * h,
         Vec3::Zero(), turn * moments * turn.transpose(), 5e-3);
}

TEST(BodyShapes, WhatIsNoBodyIsRefused) {
  const auto refuse = [](const Keys& keys, const Keys& words) {
    try {
      body_of(keys);
      ADD_FAILURE() << keys[0] << " was accepted";
    } catch (const ParameterError& error) {
      for (const std::string& word : words)
        EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << word << " in " << error.what();
    }
  };
  refuse({"Shape = ball"}, {"the shape 'ball' must have the key 'Radius [m]'"});
  refuse({"Shape = mesh"}, {"must have the key 'Mesh'"});
  refuse({"Shape = egg", "Radius [m] = 1"}, {"must be one of mesh, box, ball, cylinder"});
  refuse({"Shape = ball", "Radius [m] = 0"}, {"Radius [m]", "must be > 0"});
  refuse({"Shape = ball", "Radius [m] = 1e300"}, {"Cube edge [m]", "Use larger cubes"});
  refuse({"Shape = ball", "Radius [m] = 100"}, {"Cube edge [m]", "more than"});
  refuse({"Shape = ball", "Radius [m] = 0.001"}, {"no grid node is inside", "or check Radius [m]"});
  refuse({"Shape = box", "Sides [m] = 1, 1, 0.01"}, {"no grid node is inside", "Sides [m]", "set Lattice offset"});
  refuse({"Shape = ball", "Radius [m] = 0.2", "Height [m] = 1"}, {"Height [m]", "does not read this key"});
  refuse({"Shape = ball", "Radius [m] = 0.2", "Mesh = x.off"}, {"Mesh", "does not read this key"});
  refuse({"Shape = box", "Sides [m] = 1, 0, 1"}, {"Sides [m]", "must all be > 0"});
  refuse({"Shape = box", "Sides [m] = 1, -1, 1"}, {"Sides [m]", "must all be > 0"});
  refuse({"Shape = box", "Sides [m] = 1, nan, 1"}, {"Sides [m]"});
  refuse({"Shape = cylinder", "Radius [m] = 0.2", "Height [m] = 0.2", "Axis [1] = 0, 0, 0"},
         {"Axis [1]", "must not be zero"});
}

} // namespace
} // namespace kerf::scene::shapes_test
