/// Cuts that end inside cells.

#include "lattice/shape_matching.h"
#include "tests/cut/cutting.h"
#include "tests/lattice/bodies.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::lattice::fronts_test {
namespace {

constexpr double h = 0.1, dt = 0.01, arm = 5 * h, length = 18 * h;

/// A bar of 18 x 2 x 10 cubes.
cut::Cutting bar() {
  const auto mesh = geometry::box_mesh(Vec3::Zero(), Vec3(length, 2 * h, 2 * arm));
  return cut::Cutting(support::with_copies(support::embedded(mesh, h, Vec3::Constant(0.5))),
                      cut::Fronts::of_springs);
}

/// Split midway from x = 0 to `front` cubes beyond an arm's height.
cut::Cutting split_bar(const double front) {
  cut::Cutting cutting = bar();
  cutting.cut(cut::Rectangle{Vec3(0, h, arm), Vec3(2 * (arm + front * h), 0, 0), Vec3(0, 6 * h, 0)});
  return cutting;
}

template <class Holds>
void hold(const Points& rest, const Vec3& by, const Holds& holds, dynamics::Loads& loads) {
  dynamics::Support support{{}, {}, [=](double) { return by; }};
  for (std::uint32_t i = 0; i < rest.size(); ++i)
    if (holds(rest[i])) {
      support.corners.push_back(i);
      support.rest.push_back(rest[i]);
    }
  loads.supports.push_back(std::move(support));
}

/// The same by a blade, in so many steps.
cut::Cutting bar_split_by_blade(const double front, const int n_steps) {
  cut::Cutting cutting = bar();
  const cut::Blade blade{
    .name = "blade",
    .edge = {Vec3(0, -h, arm), Vec3(0, 3 * h, arm)},
    .key_frames = {{0, Vec3(-h, 0, 0), Vec3::Zero()}, {1, Vec3(arm + front * h, 0, 0), Vec3::Zero()}}};
  for (int k = 0; k < n_steps || cutting.cutter.n_waiting() > 0; ++k)
    cutting.step(blade, std::min(1.0, k / double(n_steps)), std::min(1.0, (k + 1) / double(n_steps)));
  return cutting;
}

/// What a beam would be as long as, up to a factor, that has the energy of the arms when their ends stand apart.
double length_of_arms(const cut::Cutting& cutting, const int w) {
  const Matching model(cutting.body, matching_options({.half_width = w}, 1000, dt));
  const Points rest = grid::rest_positions(cutting.body);
  constexpr double opening = 0.02 * h;
  dynamics::Loads loads{.gravity = Vec3::Zero(), .mass_damping = 4, .supports = {}};
  hold(rest, Vec3::Zero(), [](const Vec3& X) { return X[0] > length - 2 * h; }, loads);
  for (const int side : {-1, 1})
    hold(rest, Vec3(0, 0, 0.5 * side * opening),
         [&](const Vec3& X) { return X[0] < h && (X[2] > arm) == (side > 0); }, loads);
  dynamics::State state{rest, Points(rest.size(), Vec3::Zero()), 0};
  ShapeMatching stepper(model, 0);
  for (int i = 0; i < 1000; ++i)
    stepper.step(state, loads, dt);
  return std::cbrt(opening * opening / model.energy(state.x));
}

/// A front that moves on lets the arms be longer, by as much wherever it lies in its cell; as it comes into one, with
/// its lag half a cube before it, and as that is cut.
TEST(Fronts, MoveOnEvenly) {
  for (const int w : {2, 3}) {
    constexpr int n = 10;
    double before = length_of_arms(split_bar(0.05), w);
    const double of_step = (length_of_arms(split_bar(1.05), w) - before) / n;
    for (int i = 1; i <= n; ++i) {
      const double now = length_of_arms(split_bar(0.05 + i / double(n)), w);
      EXPECT_GT(now - before, 0.7 * of_step) << w << ' ' << i;
      EXPECT_LT(now - before, 1.4 * of_step) << w << ' ' << i;
      before = now;
    }
  }
}

/// A blade that stops anywhere in a cell leaves what a rectangle leaves.
TEST(Fronts, OfBladesAreThoseOfRectangles) {
  const double of_cell = length_of_arms(split_bar(1.05), 2) - length_of_arms(split_bar(0.05), 2);
  for (const double front : {0.1, 0.35, 0.6, 0.85})
    EXPECT_NEAR(length_of_arms(bar_split_by_blade(front, 50), 2), length_of_arms(split_bar(front), 2), 0.1 * of_cell)
      << front;
}

/// Forces are those of the energy, and sum to nothing.
TEST(Fronts, LeaveForcesThoseOfAnEnergy) {
  const cut::Cutting cutting = split_bar(0.6);
  ASSERT_FALSE(cutting.body.cuts.fronts().empty());
  const Matching model(cutting.body, matching_options({.half_width = 2}, 1000, dt));
  Draw draw(5);
  Points x = grid::rest_positions(cutting.body), d(x.size());
  for (Vec3& p : x)
    p += 0.1 * h * draw.vector();
  for (Vec3& v : d)
    v = draw.vector();
  Points f(x.size(), Vec3::Zero());
  model.force(x, f);
  constexpr double eps = 1e-4 * h;
  const auto at = [&](const double s) {
    Points moved = x;
    for (std::size_t i = 0; i < x.size(); ++i)
      moved[i] += s * d[i];
    return model.energy(moved);
  };
  double power = 0, size = 0;
  Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
  for (std::size_t i = 0; i < x.size(); ++i) {
    power += f[i].dot(d[i]);
    size += f[i].norm();
    sum += f[i];
    torque += x[i].cross(f[i]);
  }
  EXPECT_NEAR((at(-eps) - at(eps)) / (2 * eps), power, 1e-5 * size);
  EXPECT_LT(sum.norm(), 1e-11 * size);
  EXPECT_LT(torque.norm(), 1e-11 * size);
}

} // namespace
} // namespace kerf::lattice::fronts_test
