/// A block whose corners were put anywhere finds its shape again: elements may be flat, of no size, or inside out.

#include "base/error.h"
#include "dynamics/implicit_euler.h"
#include "tests/fem/models.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <span>

namespace kerf::fem::robustness_test {
namespace {

/// How a block was mistreated.
enum class Mistreatment { point, plane, inverted, scrambled, thrown };
constexpr std::array returnable = {Mistreatment::point, Mistreatment::plane, Mistreatment::inverted,
                                   Mistreatment::scrambled};

/// How far from its rest shape: the largest change of the distance of two material nodes, over h.
double shape_error(const Body& body, const Points& x) {
  const Points rest = body.rest();
  double worst = 0;
  for (const auto a : body.complex.real_corner)
    for (const auto b : body.complex.real_corner)
      if (a.valid() && b.valid())
        worst = std::max(worst, std::abs((x[a.value] - x[b.value]).norm() - (rest[a.value] - rest[b.value]).norm()));
  return worst / body.grid.h();
}

constexpr double h = 0.1; // [m]

/// Where mistreatment leaves the corners. Scrambled: each up to 2 h from its place along each axis, half the block.
/// Thrown: anywhere in a cube of 1 m.
Points mistreated(const Body& body, const Mistreatment mistreatment, Draw& draw) {
  Points x = body.rest();
  const Vec3 middle = body.grid.position(*body.grid.find_node({2, 2, 2}));
  const auto anywhere = [&] { return Vec3(draw(-1, 1), draw(-1, 1), draw(-1, 1)); };
  for (Vec3& p : x) {
    if (mistreatment == Mistreatment::scrambled)
      p += 2 * h * anywhere();
    if (mistreatment == Mistreatment::thrown)
      p = middle + 0.5 * anywhere();
    if (mistreatment == Mistreatment::point)
      p = middle;
    if (mistreatment == Mistreatment::plane)
      p[2] = middle[2];
    if (mistreatment == Mistreatment::inverted)
      p[2] = 2 * middle[2] - p[2];
  }
  return x;
}

/// 3 x 3 x 3 nodes inside a skin half an edge away.
Body make_plain_block(Draw& draw) { return make_block({3, 3, 3}, h, draw, {0.5, 0.5}); }

/// The same with the skin at any distance, and a slit through two thirds of it, 1e-3 h beside its nodes: copies with
/// hardly any material.
Body make_slit_block(Draw& draw) {
  Body body = make_block({3, 3, 3}, h, draw, {1e-3, 1 - 1e-3});
  std::vector<grid::EdgeCut> cuts;
  for (const auto e : inner_edges(body))
    if (const Index3 from = body.grid.index(body.grid.ends(e)[0]);
        body.grid.axis(e) == 0 && from[0] == 1 && from[1] < 3)
      cuts.push_back({e, 1e-3, Vec3::UnitX(), 1});
  body.cut(cuts);
  return body;
}

/// What a block was like at the end.
struct Outcome {
  double error = 1e300; ///< shape_error(); as it is if a step cannot be done
  int winding = 0;      ///< winding()
  int n_divided = 0;    ///< steps
};

/// How often the ring of nodes about the middle one turns around an axis; the largest of the three. 1 at rest.
int winding(const Body& body, const Points& x) {
  const auto at = [&](const Index3& node) { return x[body.complex.real_corner[*body.grid.find_node(node)].value]; };
  static constexpr std::array<std::array<int, 2>, 8> ring = {
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
  int most = 0;
  for (int axis = 0; axis < 3; ++axis) {
    Index3 before = {2, 2, 2}, after = {2, 2, 2};
    --before[axis];
    ++after[axis];
    const Vec3 direction = (at(after) - at(before)).normalized();
    const auto spoke = [&](const int i) {
      Index3 node = {2, 2, 2};
      node[(axis + 1) % 3] += ring[i % 8][0];
      node[(axis + 2) % 3] += ring[i % 8][1];
      const Vec3 arm = at(node) - at({2, 2, 2});
      return Vec3(arm - arm.dot(direction) * direction);
    };
    double turned = 0;
    for (int i = 0; i < 8; ++i)
      turned += std::atan2(spoke(i).cross(spoke(i + 1)).dot(direction), spoke(i).dot(spoke(i + 1)));
    most = std::max(most, static_cast<int>(std::lround(turned / (2 * std::numbers::pi))));
  }
  return most;
}

/// A step that conjugate gradients do not end is divided, as runs do (dynamics/sound_steps.h): it takes one in some
/// hundred blocks that are thrown together. Returns how often.
int step_or_divide(dynamics::ImplicitEuler& stepper, dynamics::State& state, const dynamics::Loads& loads,
                    const double dt) {
  const dynamics::State before = state;
  try {
    stepper.step(state, loads, dt);
    return 0;
  } catch (const NumericalError&) {
    if (dt < 1.0 / 60 / 4)
      throw;
    state = before;
    const int of_first_half = step_or_divide(stepper, state, loads, dt / 2);
    return 1 + of_first_half + step_or_divide(stepper, state, loads, dt / 2);
  }
}

/// After at most n steps of 1/60 s; by default of one Newton iteration each.
Outcome outcome(const int n_steps, const Mistreatment mistreatment, const HexahedraOptions& options,
                Body (*const make)(Draw&), const unsigned seed, const dynamics::ImplicitEulerOptions& stepping = {}) {
  constexpr double good = 5e-3;
  const bool is_corotational = options.material.law == "corotational";
  Draw draw(seed);
  const Body body = make(draw);
  Hexahedra model = make_model(body, options);
  dynamics::ImplicitEuler stepper(model, stepping);
  dynamics::State state{mistreated(body, mistreatment, draw), Points(body.complex.n_corners(), Vec3::Zero()), 0};
  if (mistreatment == Mistreatment::point && !is_corotational)
    for (Vec3& x : state.x) // at a point exactly it has no stress, by symmetry
      x += 0.05 * h * draw.vector();
  int n_divided = 0;
  try {
    for (int i = 0; i < n_steps && !(i % 10 == 9 && shape_error(body, state.x) < good); ++i)
      n_divided += step_or_divide(stepper, state, {.mass_damping = 1, .supports = {}}, 1.0 / 60);
  } catch (const NumericalError&) {
    return {};
  }
  return {shape_error(body, state.x), winding(body, state.x), n_divided};
}

HexahedraOptions block_options(const std::string& law, const double E, const Strain strain) {
  return {.material = {.density = 1000, .youngs_modulus = E, .poissons_ratio = 0.3, .law = law}, .strain = strain};
}

const std::array<double, 8> all_moduli = {1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};
const std::array<double, 3> quick_moduli = {1e4, 1e6, 1e9};
/// 25 s where waves take a second through the block, else 5 s.
int enough_steps(const double E) { return E < 1e4 ? 1500 : 300; }

class Robustness : public testing::TestWithParam<const char*> {
 protected:
  void TearDown() override {
    RecordProperty("steps_divided", n_divided_);
    EXPECT_LE(n_divided_, 3);
  }
  double error_of(const Outcome& end) {
    n_divided_ += end.n_divided;
    return end.error;
  }
  void expect_return(const std::span<const double> moduli, const Mistreatment mistreatment, const Strain strain,
                     const unsigned seed) {
    for (const double E : moduli) {
      const auto options = block_options(GetParam(), E, strain);
      EXPECT_LT(error_of(outcome(enough_steps(E), mistreatment, options, make_plain_block, seed)), 1e-2)
        << "E " << E << ", " << static_cast<int>(mistreatment) << ", " << name_of(options) << ", seed " << seed;
    }
  }
  /// Expects rest, or a block wound twice; counts and returns whether it is at rest.
  int came_back(const int n_steps, const double E, const Mistreatment mistreatment, Body (*const make)(Draw&),
                const unsigned seed) {
    const Outcome end = outcome(n_steps, mistreatment, block_options(GetParam(), E, Strain::enhanced), make, seed);
    const bool is_at_rest = error_of(end) < 1e-2, is_wound_twice = end.winding == 2 && end.error > 2.5 && end.error < 3;
    EXPECT_TRUE(is_at_rest || is_wound_twice) << "E " << E << ", " << static_cast<int>(mistreatment) << ", seed "
                                              << seed << ", error " << end.error << ", winding " << end.winding;
    return is_at_rest ? 1 : 0;
  }

 private:
  int n_divided_ = 0; // in one test
};

TEST_P(Robustness, ComesBackFromAPointAPlaneInsideOutAndScrambled) {
  for (const auto mistreatment : returnable) {
    expect_return(all_moduli, mistreatment, Strain::enhanced, 80);
    expect_return(quick_moduli, mistreatment, Strain::trilinear, 80);
  }
  for (unsigned seed = 81; seed < 85; ++seed)
    expect_return(all_moduli, Mistreatment::scrambled, Strain::enhanced, seed);
}

/// Six iterations and a line search bring it back as well.
TEST_P(Robustness, ComesBackWithALineSearch) {
  const dynamics::ImplicitEulerOptions careful{.n_newton = 6, .line_search = dynamics::LineSearch::backtracking};
  for (const double E : quick_moduli)
    for (unsigned seed = 81; seed < 84; ++seed) {
      const auto options = block_options(GetParam(), E, Strain::enhanced);
      EXPECT_LT(error_of(outcome(300, Mistreatment::scrambled, options, make_plain_block, seed, careful)), 1e-2)
        << "E " << E << ", seed " << seed;
    }
}

/// Another equilibrium exists: the block wound twice around an axis (in the plane across, w^2 / |w| of the complex
/// number w), with no cell inverted. Only contact of its two leaves could tell it from rest. Thrown together at random,
/// a block ends there or at rest.
TEST_P(Robustness, ThrownAnywhereItComesBackOrIsWoundTwice) {
  int n_back = 0, n_all = 0;
  for (const double E : quick_moduli)
    for (unsigned seed = 100; seed < 112; ++seed, ++n_all)
      n_back += came_back(300, E, Mistreatment::thrown, make_plain_block, seed);
  RecordProperty("back_of_" + std::to_string(n_all), n_back);
  EXPECT_GE(n_back, 0.75 * n_all);
}

/// With copies of hardly any material, on both sides of a slit, which halves the block's lowest frequency.
TEST_P(Robustness, ComesBackWithSlivers) {
  int n_back = 0, n_all = 0;
  for (const auto mistreatment : returnable)
    for (const double E : all_moduli)
      for (unsigned seed = 80; seed < 82; ++seed, ++n_all)
        n_back += came_back(2 * enough_steps(E), E, mistreatment, make_slit_block, seed);
  RecordProperty("back_of_" + std::to_string(n_all), n_back);
  EXPECT_GE(n_back, 0.9 * n_all);
}

INSTANTIATE_TEST_SUITE_P(Laws, Robustness, testing::Values("corotational", "neo-Hookean"), [](const auto& info) {
  return std::string(info.param) == "corotational" ? "Corotational" : "NeoHookean";
});

} // namespace
} // namespace kerf::fem::robustness_test
