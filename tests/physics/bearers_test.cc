// Forces on corners that hold hardly any material go to copies that hold some.

#include "physics/bearers.h"

#include "tests/support/placed.h"

#include <gtest/gtest.h>

namespace kerf::physics::bearers_test {
namespace {

constexpr double h = 0.1, light = 1.0 / 64;

struct Ball {
  support::Body body;
  std::vector<double> material;
  Points rest;

  explicit Ball(const Vec3& offset) : body(support::with_placed_skin(support::ball(0.37, h, offset))) {
    body.complex = grid::build_complex(body);
    material = material_of_corners(body);
    rest = grid::rest_positions(body);
  }
  Bearers bearers() const { return Bearers(body, std::vector<std::uint8_t>(rest.size(), 1)); }
};

TEST(Bearers, TakeUpForcesWithTheirSumAndTheirMoment) {
  support::Random random(3);
  std::size_t n_light = 0;
  for (int i = 0; i < 5; ++i) {
    const Ball ball(h * support::random_vector(random));
    const std::size_t n = ball.rest.size();
    const Interpolation carried = ball.bearers().carry(corners_themselves(n));
    ASSERT_EQ(carried.n_points(), n);
    for (std::uint32_t c = 0; c < n; ++c) {
      double sum = 0;
      for (auto k = carried.start[c]; k < carried.start[c + 1]; ++k) {
        sum += carried.values[k];
        EXPECT_GE(ball.material[carried.corners[k]], light);
      }
      EXPECT_NEAR(sum, 1, 1e-13);
      EXPECT_NEAR((carried.at(c, ball.rest) - ball.rest[c]).norm(), 0, 1e-13);
      const bool is_light = ball.material[c] < light;
      EXPECT_EQ(carried.start[c + 1] - carried.start[c], is_light ? 8u : 1u);
      n_light += is_light ? 1 : 0;
    }
  }
  EXPECT_GT(n_light, 50u);
}

/// Points between corners follow the bearers of these.
TEST(Bearers, TakeUpWhatActsBetweenCorners) {
  const Ball ball(Vec3(0.013, 0.027, 0.041));
  Interpolation middles; // of the copies
  for (const grid::Copy& copy : ball.body.complex.copies) {
    std::array<std::uint32_t, 8> corners;
    std::array<double, 8> weights;
    weights.fill(0.125);
    for (int v = 0; v < 8; ++v)
      corners[v] = copy.corners[v].value;
    middles.add_point(corners, weights);
  }
  const Interpolation carried = ball.bearers().carry(middles);
  for (std::size_t i = 0; i < middles.n_points(); ++i) {
    EXPECT_NEAR((carried.at(i, ball.rest) - middles.at(i, ball.rest)).norm(), 0, 1e-13);
    for (auto k = carried.start[i]; k < carried.start[i + 1]; ++k)
      EXPECT_GE(ball.material[carried.corners[k]], light);
  }
}

/// Where none may be light, and in a body all of which is, corners bear what acts on them.
TEST(Bearers, LeaveWhatIsToBear) {
  const Ball ball(Vec3::Zero());
  const Interpolation all = corners_themselves(ball.rest.size()),
                      carried = Bearers(ball.body, std::vector<std::uint8_t>(ball.rest.size(), 0)).carry(all);
  EXPECT_EQ(carried.corners, all.corners);
  EXPECT_EQ(carried.values, all.values);
  support::Body flake = support::with_placed_skin(support::ball(0.02, h, Vec3::Zero()));
  flake.complex = grid::build_complex(flake);
  const Interpolation of_flake = corners_themselves(flake.complex.n_corners()),
                      left = Bearers(flake, std::vector<std::uint8_t>(flake.complex.n_corners(), 1)).carry(of_flake);
  EXPECT_GT(of_flake.n_points(), 0u);
  EXPECT_EQ(left.corners, of_flake.corners);
  EXPECT_EQ(left.values, of_flake.values);
}

} // namespace
} // namespace kerf::physics::bearers_test
