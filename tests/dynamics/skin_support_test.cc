// A support of the skin: force and tangent by differences, what it holds, where it moves, and what is refused.

#include "dynamics/skin_support.h"

#include "base/error.h"
#include "dynamics/rigid_modes.h"
#include "tests/dynamics/chain.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <random>

namespace kerf::dynamics::skin_support_test {
namespace {

constexpr double k = 40; // [N/m^3]

/// Two triangles of one square of 2 x 1 m, and a vertex beside them that no triangle has; the five follow eight corners
/// by weights of sum 1.
SurfacePatch square() {
  SurfacePatch patch;
  patch.rest = {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 1, 0), Vec3(0, 1, 0), Vec3(5, 5, 5)};
  patch.triangles = {{0, 1, 2}, {0, 2, 3}};
  for (std::uint32_t i = 0; i < 5; ++i) {
    const std::uint32_t corners[] = {i, (i + 2) % 8, (3 * i + 5) % 8};
    const double weights[] = {0.5, 0.8, -0.3};
    patch.points.add_row(corners, weights);
  }
  return patch;
}

/// The same with each vertex a corner of its own.
SurfacePatch square_of_corners() {
  SurfacePatch patch = square();
  patch.points = corners_themselves(5);
  return patch;
}

Vec3 path(const double t) { return {0.3 * t, -0.1, 0.2 + t * t}; }
Mat3 turn(const double t) { return Eigen::AngleAxisd(t, Vec3(1, 2, 2) / 3).toRotationMatrix(); }
Vec3 still(double) { return Vec3::Zero(); }
Support hold(const Mat3& held) { return {{}, {}, path, turn, held}; }

Points random_points(const std::size_t n, const unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Points points(n);
  for (Vec3& p : points)
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = uniform(random);
  return points;
}

Points force(const Load& load, const double time, const Points& x) {
  const Points v(x.size(), Vec3::Zero());
  Points forces(x.size(), Vec3::Zero());
  load.add_force({time, x, v}, forces);
  return forces;
}

TEST(SkinSupport, ForceAndTangentAreDerivatives) {
  constexpr double time = 0.7, d = 1e-6;
  const Points x = random_points(8, 1), direction = random_points(8, 2);
  for (const Mat3& held : {held_axes("all"), held_axes("xz"), held_along(Vec3(1, -2, 3))})
    for (const Tangent kind : {Tangent::exact, Tangent::positive}) {
      const SkinSupport support(square(), k, hold(held));
      const Points f = force(support, time, x);
      for (std::size_t i = 0; i < 8; ++i)
        for (int axis = 0; axis < 3; ++axis) {
          Points forward = x, back = x;
          forward[i][axis] += d;
          back[i][axis] -= d;
          EXPECT_NEAR((support.energy(time, forward) - support.energy(time, back)) / (2 * d), -f[i][axis], 1e-6);
        }
      LoadTangent tangent;
      support.add_tangent(kind, {time, x, x}, 3, tangent);
      Points product(8, Vec3::Zero()), forward = x;
      tangent.add_product(flat(direction), flat(product));
      for (std::size_t i = 0; i < 8; ++i)
        forward[i] += direction[i];
      const Points f1 = force(support, time, forward); // the force is linear
      double power = 0;
      for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_LT((f1[i] - f[i] + product[i]).norm(), 1e-11);
        power += product[i].dot(direction[i]);
      }
      EXPECT_GT(power, 0);
    }
}

/// Moved as it is told nothing pulls; moved besides by u, all vertices are drawn back with k A u, each by its third.
TEST(SkinSupport, PullsByAreaBackToItsPlace) {
  const Vec3 u(0.1, 0.2, -0.4);
  constexpr double time = 0.3;
  const SurfacePatch patch = square_of_corners();
  for (const auto& [word, held_u] : {std::pair("all", u), std::pair("x", Vec3(0.1, 0, 0))}) {
    const SkinSupport support(patch, k, hold(held_axes(word)));
    EXPECT_DOUBLE_EQ(support.area(), 2);
    Points x;
    for (const Vec3& X : patch.rest)
      x.push_back(turn(time) * X + path(time));
    EXPECT_NEAR(support.energy(time, x), 0, 1e-25);
    EXPECT_GT(support.energy(time + 0.1, x), 0.01) << "its place moves on";
    for (Vec3& p : x)
      p += u;
    const double thirds[] = {2, 1, 2, 1, 0}; // both triangles have 1 m^2
    const Points f = force(support, time, x);
    for (std::size_t i = 0; i < 5; ++i)
      EXPECT_LT((f[i] + k * thirds[i] / 3 * held_u).norm(), 1e-12) << i;
    EXPECT_NEAR(support.energy(time, x), 0.5 * k * 2 * held_u.squaredNorm(), 1e-12);
  }
}

/// A square held everywhere leaves no motion free, held across it the three within its plane.
TEST(SkinSupport, CountsAsSupport) {
  Chain model({1, 1, 1, 1}, {});
  SurfacePatch patch = square_of_corners();
  patch.rest.pop_back();
  patch.points = corners_themselves(4);
  const auto free = [&](const std::string& word) {
    Loads loads;
    loads.acting.push_back(std::make_unique<SkinSupport>(patch, k, Support{{}, {}, still, {}, held_axes(word)}));
    std::vector<std::string> names;
    for (const FreeMode& mode : free_rigid_modes(model, loads, 0, patch.rest, {}))
      names.push_back(mode.name);
    return names;
  };
  EXPECT_EQ(free("all"), std::vector<std::string>());
  EXPECT_EQ(free("z"), (std::vector<std::string>{"translation along x", "translation along y", "rotation about z"}));
}

TEST(SkinSupport, RefusesWhatCannotHold) {
  EXPECT_THROW(SkinSupport(square(), 0, hold(Mat3::Identity())), ParameterError);
  SurfacePatch unknown = square();
  unknown.triangles.push_back({0, 1, 9});
  EXPECT_THROW(SkinSupport(unknown, k, hold(Mat3::Identity())), ParameterError);
  SurfacePatch nothing = square();
  nothing.triangles.clear();
  EXPECT_EQ(SkinSupport(nothing, k, hold(Mat3::Identity())).energy(0, random_points(8, 3)), 0);
}

} // namespace
} // namespace kerf::dynamics::skin_support_test
