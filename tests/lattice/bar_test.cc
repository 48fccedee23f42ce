/// Bars against the modulus that calibration.h says.

#include "lattice/calibration.h"
#include "lattice/shape_matching.h"
#include "tests/support/placed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kerf::lattice::bar_test {
namespace {

constexpr double density = 1000, h = 0.1, dt = 0.01;

/// n[2] nodes along the bar, z; the skin passes midway between nodes, so that the bar is n h thick.
struct Bar {
  support::Body body;
  Matching model;
  Points rest;

  Bar(const Index3& n, const int w, const double alpha = 1)
    : body(support::with_copies(support::block(n, h))),
      model(body, matching_options({.half_width = w, .alpha = alpha}, density, dt)),
      rest(grid::rest_positions(body)) {}

  double modulus() const { return youngs_modulus(model.stiffness(), density, h, model.lines().half_width()); }
  dynamics::State at_rest() const { return {rest, Points(rest.size(), Vec3::Zero()), 0}; }

  /// Holds the lowest nodes along z and what is below them.
  dynamics::Loads clamped(const Vec3& gravity, const double damping) const {
    dynamics::Loads loads{.gravity = gravity, .mass_damping = damping, .supports = {}};
    dynamics::Support support{{}, {}, [](double) { return Vec3(Vec3::Zero()); }};
    for (const auto c : ids<grid::CornerId>(body.complex.n_corners()))
      if (body.grid.index(body.complex.node[c])[2] <= 1) {
        support.corners.push_back(c.value);
        support.rest.push_back(rest[c.value]);
      }
    loads.supports.push_back(std::move(support));
    return loads;
  }

  /// The middle node of layer k along z, counted from 1.
  std::uint32_t middle(const int k, const Index3& n) const {
    return body.complex.real_corner[*body.grid.find_node({(n[0] + 1) / 2, (n[1] + 1) / 2, k})].value;
  }
};

/// After so many steps that nothing moves any more.
dynamics::State settled(const Bar& bar, const dynamics::Loads& loads, const int n_steps) {
  dynamics::State state = bar.at_rest();
  ShapeMatching stepper(bar.model, 0);
  for (int i = 0; i < n_steps; ++i)
    stepper.step(state, loads, dt);
  double fastest = 0;
  for (const Vec3& v : state.v)
    fastest = std::max(fastest, v.norm());
  EXPECT_LT(fastest, 1e-9);
  return state;
}

/// The strain under its own weight is density g (L - z) / E for every cross-section: within 2 % from 2 w + 1 cells
/// off the ends on, where regions are trimmed, and within 0.2 % in the middle.
TEST(Bar, HangsAsItsModulusSays) {
  for (const int w : {1, 2, 3})
    for (const int thick : {1, 2, 5}) {
      const Index3 n = {thick, thick, 31};
      const Bar bar(n, w);
      const double length = n[2] * h, g = 1e-4 * bar.modulus() / (density * length);
      const auto state = settled(bar, bar.clamped(Vec3(0, 0, g), 3), 4000);
      for (int k = 2 * w + 3; k + 2 * w + 2 < n[2]; ++k) {
        const double strain = (state.x[bar.middle(k + 1, n)][2] - state.x[bar.middle(k, n)][2]) / h - 1;
        const double expected = density * g * (length - k * h) / bar.modulus(); // the bar starts at h / 2
        EXPECT_NEAR(strain / expected, 1, std::abs(k - 15) <= 2 ? 2e-3 : 2e-2)
          << "w " << w << ", " << thick << ", " << k;
      }
    }
}

/// No part of it goes sideways: Poisson's ratio is zero.
TEST(Bar, DoesNotContractSideways) {
  const Index3 n = {5, 5, 21};
  const Bar bar(n, 2);
  const auto state = settled(bar, bar.clamped(Vec3(0, 0, -1e-5 * bar.modulus() / density), 3), 3000);
  const auto a = bar.body.complex.real_corner[*bar.body.grid.find_node({1, 3, 11})].value,
             b = bar.body.complex.real_corner[*bar.body.grid.find_node({5, 3, 11})].value;
  const double along = (state.x[bar.middle(12, n)][2] - state.x[bar.middle(11, n)][2]) / h - 1,
               across = (state.x[b] - state.x[a]).norm() / (4 * h) - 1;
  EXPECT_LT(std::abs(across), 1e-3 * std::abs(along));
}

/// Frequency of the first longitudinal mode of a free bar over c / (2 L), from its zero crossings.
double frequency_ratio(const Index3& n, const int w, const double alpha) {
  const Bar bar(n, w, alpha);
  const double length = n[2] * h, f = std::sqrt(bar.modulus() / density) / (2 * length);
  dynamics::State state = bar.at_rest();
  for (std::size_t c = 0; c < state.x.size(); ++c)
    state.v[c][2] = 1e-4 * length * f * std::cos(std::numbers::pi * (bar.rest[c][2] - h / 2) / length);
  ShapeMatching stepper(bar.model, 0);
  const auto tip = bar.middle(1, n), end = bar.middle(n[2], n);
  std::vector<double> zeros;
  double before = 0;
  while (zeros.size() < 5) {
    stepper.step(state, {.supports = {}}, dt);
    const double stretch = state.x[end][2] - state.x[tip][2] - (length - h);
    if (before * stretch < 0)
      zeros.push_back(state.time - dt * stretch / (stretch - before));
    before = stretch;
  }
  return 2 / (zeros[4] - zeros[0]) / f;
}

/// Lower where the wave is shorter, and where regions are trimmed at the ends.
TEST(Bar, SoundsAsItsModulusSays) {
  for (const int w : {1, 2, 3})
    for (const double alpha : {1.0, 0.25}) {
      const double coarse = frequency_ratio({2, 2, 20}, w, alpha), fine = frequency_ratio({2, 2, 40}, w, alpha);
      EXPECT_NEAR(coarse, 1, 0.01) << w << ", " << alpha;
      EXPECT_NEAR(fine, 1, 0.004) << w << ", " << alpha;
      EXPECT_LT(std::abs(fine - 1), 0.6 * std::abs(coarse - 1)) << w << ", " << alpha;
    }
}

/// Tip deflection of a cantilever under its weight over Timoshenko's, nu = 0.
double deflection_ratio(const int thick, const int length_cells, const int w) {
  const Index3 n = {thick, thick, length_cells + 1};
  const Bar bar(n, w);
  const double L = length_cells * h, a = thick * h, E = bar.modulus(); // free length, from the held nodes to the last
  const double free = L + h / 2, I = a * a * a * a / 12;
  const double per_load =
    density * a * a * (free * free * free * free / (8 * E * I) + free * free / (2 * 5.0 / 6 * E / 2 * a * a));
  const double g = 1e-3 * free / per_load;
  const double slowest = 3.516 * std::sqrt(E * a * a / (12 * density)) / (free * free);
  const auto state = settled(bar, bar.clamped(Vec3(g, 0, 0), slowest), static_cast<int>(30 / (slowest * dt)));
  return (state.x[bar.middle(n[2], n)][0] - bar.rest[bar.middle(n[2], n)][0]) / (1e-3 * free);
}

/// Golden numbers: what the limits of calibration.h are taken from. They tend to 1 with the thickness over the region.
TEST(Bar, BendsMoreStifflyTheThinnerItIs) {
  struct Case {
    int thick, w;
    double ratio;
  };
  for (const Case& c : {Case{1, 1, 0.236}, {2, 1, 0.543}, {4, 1, 0.823}, {2, 2, 0.522}, {4, 2, 0.797}, {2, 3, 0.668}})
    EXPECT_NEAR(deflection_ratio(c.thick, 8 * std::max(c.thick, 2), c.w), c.ratio, 0.005) << c.thick << ", w " << c.w;
}

TEST(Calibration, InvertsItself) {
  const double k = stiffness_for(5e4, 1100, 0.02, 3);
  EXPECT_NEAR(youngs_modulus(k, 1100, 0.02, 3), 5e4, 1e-9);
  for (const double E : {1.0, 1e3, 1e5, 1e6}) {
    const int w = least_half_width(E, 1000, 0.01, 1.0 / 60);
    EXPECT_LE(stiffness_for(E, 1000, 0.01, w) / 3600, 1 + 1e-12);
    if (w > 1) {
      EXPECT_GT(stiffness_for(E, 1000, 0.01, w - 1) / 3600, 1);
    }
  }
}

} // namespace
} // namespace kerf::lattice::bar_test
