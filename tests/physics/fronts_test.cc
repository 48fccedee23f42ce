/// Fronts inside cells, as explicit integrators feel them.

#include "cut/cutter.h"
#include "dynamics/stable_step.h"
#include "fem/hexahedra.h"
#include "spring/mass_spring.h"
#include "tests/support/placed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <vector>

namespace kerf::physics::fronts_test {
namespace {

const material::Elastic rubber{.density = 1, .youngs_modulus = 1, .poissons_ratio = 0.3};
const material::Elastic gel{.density = 1, .youngs_modulus = 1, .poissons_ratio = 0.47};

double frequency(dynamics::ElasticModel& model, const Points& rest) {
  dynamics::State state;
  state.x = rest;
  state.v.assign(rest.size(), Vec3::Zero());
  return std::sqrt(dynamics::largest_square_frequency(model, {}, state));
}

double of_springs(const support::Body& body, const grid::TieStiffness ties) {
  spring::MassSpring springs(body, {.density = 1, .youngs_modulus = 1, .ties = ties});
  return frequency(springs, grid::rest_positions(body));
}

/// The largest of elements of two materials, or of springs.
std::vector<double> frequencies(const support::Body& body, const cut::Fronts fronts) {
  const auto of_elements = [&](const material::Elastic& material) {
    fem::Hexahedra model(body,
                         {.material = material, .strain = fem::Strain::enhanced, .inertia = fem::Inertia::extended});
    return frequency(model, grid::rest_positions(body));
  };
  if (fronts == cut::Fronts::of_elements)
    return {of_elements(rubber), of_elements(gel)};
  return {of_springs(body, grid::TieStiffness::of_explicit_steps)};
}

/// A box of 7 cubes, or a ball of 3 cubes a radius whose skin lies anywhere between nodes.
support::Body some_body(const int i, support::Random& random) {
  return support::with_copies(support::with_placed_skin(
    i % 2 == 0 ? support::block({7, 7, 7}) : support::ball(3, 1, support::random_offset(random))));
}

/// A disc of any place, tilt and radius, and then a blade that stops somewhere. Copies alone, without ties, vibrate
/// faster than the whole body by up to 24, 25, 14 %.
void expect_hardly_shortened_steps(const cut::Fronts fronts) {
  std::vector<double> soft(2, 0.0);
  double stiff = 0;
  std::size_t n_tied = 0;
  for (int seed = 0; seed < 60; ++seed) {
    support::Random random(seed);
    support::Body body = some_body(seed, random);
    const Vec3 centre = seed % 2 == 0 ? Vec3(Vec3::Constant(3.5)) : Vec3(Vec3::Zero());
    const std::vector<double> of_whole = frequencies(body, fronts);
    const double of_whole_springs = of_springs(body, grid::TieStiffness::of_explicit_steps);
    const auto rest = [&] { return grid::rest_positions(body); };
    cut::Cutter cutter(2, cut::Release::queued, fronts);
    cutter.begin(body, rest());
    const auto compare = [&] {
      n_tied += body.complex.tied.size();
      const std::vector<double> now = frequencies(body, fronts);
      for (std::size_t k = 0; k < now.size(); ++k)
        soft[k] = std::max(soft[k], now[k] / of_whole[k]);
      stiff = std::max(stiff, of_springs(body, grid::TieStiffness::of_fronts) / of_whole_springs);
    };
    const Vec3 middle = centre + support::random_vector(random);
    const cut::Disc disc{middle, support::random_direction(random), support::uniform(random, 1, 3)};
    surface::place(body, cutter.at_once(body, {"disc", disc, 1}, rest()), {});
    compare();
    const double height = support::uniform(random, -2.5, 2.5), end = support::uniform(random, -1.5, 1.5);
    const cut::Blade blade = {
      .name = "blade",
      .edge = {Vec3(0, -4.5, 0), Vec3(0, 4.5, support::uniform(random, -0.5, 0.5))},
      .key_frames = {{0, centre + Vec3(-4.5, 0, height)}, {1, centre + Vec3(end, 0, height)}},
      .label = 2};
    for (int i = 0; i < 10; ++i) {
      surface::place(body, cutter.step(body, std::span(&blade, 1), 0.1 * i, 0.1 * (i + 1), rest()), {});
      if (i > 7)
        compare();
    }
  }
  EXPECT_GT(n_tied, 1000u);
  std::cout << "over the whole body: " << soft[0] << ", " << soft[1] << "; springs with ties of fronts " << stiff << '\n';
  EXPECT_LT(soft[0], 1.3);
  EXPECT_LT(soft[1], 1.3);
  EXPECT_GT(stiff, 5);
}

TEST(Fronts, HardlyShortenExplicitStepsOfElements) { expect_hardly_shortened_steps(cut::Fronts::of_elements); }
TEST(Fronts, HardlyShortenExplicitStepsOfSprings) { expect_hardly_shortened_steps(cut::Fronts::of_springs); }

} // namespace
} // namespace kerf::physics::fronts_test
