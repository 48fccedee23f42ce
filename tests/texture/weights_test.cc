#include "tests/texture/probes.h"

#include <gtest/gtest.h>

namespace kerf::texture::weights_test {
namespace {

constexpr Blending by_mean_value = {Morph::blend, Weights::mean_value, 1};

TEST(MeanValue, ReproducesPointsInsideAnOctahedron) {
  const std::vector<Vec3> sources = {Vec3::UnitX(),  -Vec3::UnitX(), Vec3::UnitY(),
                                     -Vec3::UnitY(), Vec3::UnitZ(),  -Vec3::UnitZ()};
  const std::vector<Triple> triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                         {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  const auto sum = [&](const Vec3& p) {
    Shares shares;
    EXPECT_EQ(mean_value(p, sources, triangles, shares), 1) << p.transpose();
    Vec3 result = Vec3::Zero();
    for (int i = 0; i < 6; ++i)
      result += shares[i] * sources[i];
    return result;
  };
  for (const Vec3& p : {Vec3(0.1, 0.2, -0.3), Vec3(0.6, 0.1, 0.1), Vec3(0, 0, 0)})
    EXPECT_NEAR((sum(p) - p).norm(), 0, 1e-12);
  // On a side, on an edge, at a corner, and closer and closer to them.
  const Points limits = {Vec3(0.2, 0.3, 0.5), Vec3(0.4, 0.6, 0), Vec3(0, 0, -1)};
  for (const Vec3& p : limits)
    for (double shrink = 0.1; shrink > 1e-18; shrink *= 0.03)
      EXPECT_NEAR((sum((1 - shrink) * p) - (1 - shrink) * p).norm(), 0, 3e-8) << p.transpose() << " " << shrink;
  Shares shares;
  EXPECT_EQ(mean_value(Vec3(2, 2, 2), sources, triangles, shares), 0);
}

/// Six planes of a box wholly inside the ball, and a tetrahedron of planes in another ball: cells that planes close.
const Interior& nine() {
  static const Interior interior(axis_exemplars(onion, 9, 100), ball(3), {});
  return interior;
}
const Interior& tetrahedron() {
  static const Interior interior = [] {
    std::vector<Exemplar> exemplars;
    for (const Vec3& n : {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)}) {
      const Vec3 x = n.unitOrthogonal();
      exemplars.push_back(exemplar_of("e" + std::to_string(exemplars.size()), onion, 0.012 * n.normalized(), x,
                                      n.normalized().cross(x), 100));
    }
    return Interior(exemplars, ball(3), {});
  }();
  return interior;
}

/// Where the sources of a blend, weighted, lie from p [m].
double away(const Interior& inside, const Vec3& p, const Blending& how) {
  const Blend blend = inside.blend(p, how);
  Vec3 sum = -p;
  for (int i = 0; i < blend.n; ++i) {
    const SectionPlane& plane = inside.charts()[blend.exemplars[i]].plane;
    sum += blend.weights[i] * plane.point(plane.to_local(Vec2(blend.x[i], blend.y[i])));
  }
  return sum.norm();
}

TEST(MeanValueInside, ReproducesPointsOfClosedCells) {
  ASSERT_EQ(nine().n_closed_cells(), 8u);
  double largest = 0, shepard = 0;
  for (const Vec3& p : points_inside(3000, 21))
    if (p.cwiseAbs().maxCoeff() < 0.0239) { // inside of the box
      largest = std::max(largest, away(nine(), p, by_mean_value));
      shepard = std::max(shepard, away(nine(), p, {Morph::blend, Weights::shepard, 1}));
    }
  EXPECT_LT(largest, 1e-8); // pixels are stored in single precision
  // In a box sources lie straight opposite each other, up to the end of their sweeps, and Shepard's weights do it too.
  EXPECT_LT(shepard, 1e-8);
}

TEST(MeanValueInside, GivesWayToShepardAtFacesThatAllSourcesReach) {
  // As a point goes to a side of the tetrahedron, all four sources go into that side.
  const Interior& inside = tetrahedron();
  ASSERT_EQ(inside.n_closed_cells(), 1u);
  const SectionPlane& plane = inside.charts()[0].plane;
  const Vec3 foot = Vec3(0.012 / std::sqrt(3.0) * Vec3::Ones() + 0.004 * plane.x() + 0.002 * plane.y());
  EXPECT_LT(away(inside, foot - 0.008 * plane.normal(), by_mean_value), 1e-8);
  EXPECT_GT(away(inside, foot - 0.008 * plane.normal(), {Morph::blend, Weights::shepard, 1}), 1e-5);
  float before = 0;
  for (const double depth : {0.004, 1e-4, 1e-6, 1e-8}) {
    const Blend blend = inside.blend(foot - depth * plane.normal(), by_mean_value);
    ASSERT_EQ(blend.exemplars[0], 0);
    EXPECT_GT(blend.weights[0], before);
    before = blend.weights[0];
  }
  EXPECT_GT(before, 1 - 1e-4);
}

TEST(MeanValueInside, IsContinuousAndExact) {
  for (const Interior* inside : {&nine(), &tetrahedron()})
    for (const auto morph : {Morph::blend, Morph::first_order}) {
      const Blending how = {morph, Weights::mean_value, 1};
      const double jump = largest_jump([&](const Vec3& p) { return inside->colour(p, how); }, ball(3), 300, 200);
      std::printf("largest jump on 300 ways through the ball: %.2e\n", jump);
      EXPECT_LT(jump, 1e-4);
      EXPECT_LT(largest_error_on_exemplars(*inside, how), 2e-3);
    }
}

} // namespace
} // namespace kerf::texture::weights_test
