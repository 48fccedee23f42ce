// Forces on corners that hold hardly any material go to copies that hold some.

#include "physics/bearers.h"

#include "grid/material.h"
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
    material.assign(body.complex.n_corners(), 0);
    for (const grid::Copy& copy : body.complex.copies)
      for (const grid::CornerId corner : copy.corners)
        material[corner.value] += grid::fill(body, copy) / 8;
    rest = grid::rest_positions(body);
  }
  Bearers bearers() const { return {body, material, std::vector<std::uint8_t>(rest.size(), 1)}; }
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
        EXPECT_GE(ball.material[carried.columns[k]], light);
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
    middles.add_row(corners, weights);
  }
  const Interpolation carried = ball.bearers().carry(middles);
  for (std::size_t i = 0; i < middles.n_points(); ++i) {
    EXPECT_NEAR((carried.at(i, ball.rest) - middles.at(i, ball.rest)).norm(), 0, 1e-13);
    for (auto k = carried.start[i]; k < carried.start[i + 1]; ++k)
      EXPECT_GE(ball.material[carried.columns[k]], light);
  }
}

/// Where none may be light, and in a body all of which is, corners bear what acts on them.
TEST(Bearers, LeaveWhatIsToBear) {
  const Ball ball(Vec3::Zero());
  const Interpolation all = corners_themselves(ball.rest.size()),
                      carried =
                        Bearers(ball.body, ball.material, std::vector<std::uint8_t>(ball.rest.size(), 0)).carry(all);
  EXPECT_EQ(carried.columns, all.columns);
  EXPECT_EQ(carried.values, all.values);
  const std::vector<double> next_to_nothing(ball.rest.size(), 1e-6);
  const std::vector<std::uint8_t> may_all(ball.rest.size(), 1);
  const auto left = Bearers(ball.body, next_to_nothing, may_all).carry(all);
  EXPECT_EQ(left.columns, all.columns);
  EXPECT_EQ(left.values, all.values);
}

} // namespace
} // namespace kerf::physics::bearers_test
