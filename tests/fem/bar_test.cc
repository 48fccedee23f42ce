/// A bar of 1 x 0.2 x 0.2 m, clamped at x = 0, bends under its own weight, by so little that it stays linear.
/// Reference: tip -0.37663 m at E = 1e6 Pa, nu = 0.3, 1000 kg/m^3, g = 9.81 m/s^2 (quadratic elements, converged);
/// plain trilinear cubes are too stiff in bending by 13.3, 4.13 and 1.22 % with 2, 4 and 8 of them over the height.

#include "cut/embed.h"
#include "dynamics/implicit_euler.h"
#include "fem/hexahedra.h"
#include "surface/surface.h"
#include "tests/fem/bodies.h"
#include "tests/geometry/meshes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::fem::bar_test {
namespace {

const material::Elastic rubber{.density = 1000, .youngs_modulus = 1e6, .poissons_ratio = 0.3};
constexpr double reference = -0.37663e-3; // [m], at a thousandth of g

Body make_bar(const double h, const Vec3& offset) {
  const auto mesh = geometry::box_mesh(Vec3(0, -0.1, -0.1), Vec3(1, 0.1, 0.1));
  Body bar{cut::embed(mesh, h, offset).solid};
  bar.cut({});
  return bar;
}

dynamics::Support clamp(const Body& bar) {
  dynamics::Support support{{}, {}, [](double) { return Vec3::Zero(); }};
  const Points rest = bar.rest();
  for (std::size_t c = 0; c < rest.size(); ++c)
    if (rest[c][0] < 1e-9) {
      support.corners.push_back(static_cast<std::uint32_t>(c));
      support.rest.push_back(rest[c]);
    }
  return support;
}

/// Mean deflection of the surface at x = 1 [m].
double tip(const Body& bar, const Points& x) {
  const auto skin = surface::build_surface(bar);
  Points positions;
  surface::follow(skin, x, positions);
  double sum = 0;
  int n = 0;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (skin.rest[i][0] > 1 - 1e-6 && std::abs(skin.rest[i][2]) < 0.051) {
      sum += positions[i][2] - skin.rest[i][2];
      ++n;
    }
  return sum / n;
}

/// By one step so long that inertia does not count.
double static_tip(const double h, const Vec3& offset, const HexahedraOptions& options) {
  const Body bar = make_bar(h, offset);
  Hexahedra model(bar, options);
  dynamics::ImplicitEuler stepper(model, {.cg_tolerance = 1e-9, .max_cg_iterations = 20000});
  dynamics::State state{bar.rest(), Points(bar.complex.n_corners(), Vec3::Zero()), 0};
  dynamics::Loads loads{.gravity = Vec3(0, 0, -9.81e-3), .supports = {}};
  loads.supports = {clamp(bar)};
  stepper.step(state, loads, 1e4);
  return tip(bar, state.x);
}

TEST(Bar, BendsLikeTrilinearCubesDo) {
  const std::vector<std::pair<double, double>> known = {{0.1, 0.133}, {0.05, 0.0413}, {0.025, 0.0122}};
  for (const auto& [h, locking] : known) {
    const double error = 1 - static_tip(h, Vec3::Zero(), {.material = rubber}) / reference;
    EXPECT_NEAR(error, locking, 0.1 * locking + 0.003) << h;
    RecordProperty("aligned_h_" + std::to_string(h), std::to_string(100 * error) + "_percent");
  }
}

/// The skin's cells are then half full, in y and z.
TEST(Bar, ShiftedByHalfACellBendsAlike) {
  for (const double h : {0.05, 0.025}) {
    const double aligned = static_tip(h, Vec3::Zero(), {.material = rubber});
    const double shifted = static_tip(h, Vec3(0, 0.5, 0.5), {.material = rubber});
    EXPECT_NEAR(shifted / aligned, 1, 0.02) << h;
    RecordProperty("shifted_h_" + std::to_string(h), std::to_string(100 * (shifted / aligned - 1)) + "_percent");
  }
}

/// What the octants are for: counting the skin's half cells as full makes the bar far too stiff.
TEST(Bar, FullCubesAreTooStiff) {
  const double octants = static_tip(0.05, Vec3(0, 0.5, 0.5), {.material = rubber});
  const double full = static_tip(0.05, Vec3(0, 0.5, 0.5), {.material = rubber, .boundary = Boundary::full_cube});
  EXPECT_LT(full / octants, 0.8);
  RecordProperty("full_over_octants", std::to_string(full / octants));
}

/// The skin just past nodes: layers of cells hold next to nothing, and move as their neighbours go on.
TEST(Bar, NearEmptyLayersChangeNothing) {
  const double without = static_tip(0.05, Vec3::Zero(), {.material = rubber});
  for (const double depth : {1e-12, 1e-6, 1e-3}) {
    const double change = static_tip(0.05, Vec3(0, depth, depth), {.material = rubber}) / without - 1;
    EXPECT_LT(std::abs(change), 2 * depth + 3e-6) << depth;
    RecordProperty("depth_" + std::to_string(depth), std::to_string(100 * change) + "_percent");
  }
}

} // namespace
} // namespace kerf::fem::bar_test
