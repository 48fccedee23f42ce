/// A block whose corners were put anywhere finds its shape again: elements may be flat, of no size, or inside out.

#include "dynamics/implicit_euler.h"
#include "fem/corotational.h"
#include "tests/fem/bodies.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::fem {
namespace {

/// How a block was mistreated.
enum class Mistreatment { point, plane, inverted, scrambled };

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

/// The error that is left after n steps of 1/60 s with one Newton iteration each.
double error_after(const int n_steps, const Mistreatment mistreatment, const double E, const unsigned seed) {
  Draw draw(seed);
  Body body = make_block({3, 3, 3}, 0.1, draw, {0.5, 0.5});
  Corotational model(body.grid, body.cuts, body.complex,
                     {.material = {.density = 1000, .youngs_modulus = E, .poissons_ratio = 0.3}});
  dynamics::ImplicitEuler stepper(model, {});
  dynamics::State state{body.rest(), Points(body.complex.n_corners(), Vec3::Zero()), 0};
  const Vec3 middle = body.grid.position(*body.grid.find_node({2, 2, 2}));
  for (Vec3& x : state.x) {
    if (mistreatment == Mistreatment::scrambled)
      x = middle + 0.5 * Vec3(draw(-1, 1), draw(-1, 1), draw(-1, 1));
    if (mistreatment == Mistreatment::point)
      x = middle;
    if (mistreatment == Mistreatment::plane)
      x[2] = middle[2];
    if (mistreatment == Mistreatment::inverted)
      x[2] = 2 * middle[2] - x[2];
  }
  for (int i = 0; i < n_steps; ++i)
    stepper.step(state, {.mass_damping = 1, .supports = {}}, 1.0 / 60);
  return shape_error(body, state.x);
}

TEST(Robustness, ComesBackFromAPointAPlaneAndInsideOut) {
  for (const auto mistreatment : {Mistreatment::point, Mistreatment::plane, Mistreatment::inverted})
    for (const double E : {1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9}) {
      const double error = error_after(E < 1e4 ? 1500 : 300, mistreatment, E, 80);
      EXPECT_LT(error, 1e-2) << "E " << E << ", " << static_cast<int>(mistreatment);
    }
}

/// Folded equilibria exist, where inverted elements hold each other: not every scramble comes undone, but most do, and
/// none ends in numbers that are none.
TEST(Robustness, MostScramblesComeUndone) {
  int n_undone = 0, n_all = 0;
  for (const double E : {1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9}) {
    int n = 0;
    for (unsigned seed = 81; seed < 89; ++seed) {
      const double error = error_after(E < 1e4 ? 1000 : 300, Mistreatment::scrambled, E, seed);
      EXPECT_TRUE(std::isfinite(error)) << E;
      n += error < 1e-2;
    }
    RecordProperty("undone_of_8_at_E_" + std::to_string(E), n);
    n_undone += n;
    n_all += 8;
  }
  EXPECT_GE(n_undone, n_all / 2);
}

} // namespace
} // namespace kerf::fem
