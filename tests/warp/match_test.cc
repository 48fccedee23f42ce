#include "warp/match.h"

#include "base/error.h"
#include "warp/fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace kerf::warp::match_test {
namespace {

using image::Grey;

/// A few soft blobs on grey, where `where` says each pixel's point is.
template <class Where>
Picture blobs(const int n, const Where& where) {
  Picture picture{image::Colours(n, n, image::Rgb::Constant(0.4f)), image::Grey(n, n, 1)};
  const std::vector<std::array<double, 4>> spots = {
    {0.3, 0.35, 0.10, 0.5}, {0.65, 0.3, 0.07, -0.3}, {0.6, 0.7, 0.12, 0.4}, {0.25, 0.7, 0.06, -0.35}};
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; ++c) {
      const Vec2 p = where(Vec2(c, r) / (n - 1.0));
      for (const auto& [x, y, radius, height] : spots)
        picture.colours(c, r) +=
          static_cast<float>(height / (1 + std::exp(((p - Vec2(x, y)).norm() - radius) / 0.012)));
    }
  return picture;
}

/// A shear and bulge that keeps the border.
Vec2 bent(const Vec2& p) {
  const double bump = std::sin(M_PI * p[0]) * std::sin(M_PI * p[1]);
  return p + bump * Vec2(0.07, -0.05);
}

TEST(Match, FindsASmoothWarp) {
  constexpr int n = 96;
  const Picture a = blobs(n, [](const Vec2& p) { return bent(p); }); // a(x) = b(bent(x))
  const Picture b = blobs(n, [](const Vec2& p) { return p; });
  const auto error = [&](const LatticeMap& map) { // pixels
    double largest = 0;
    for (const Vec2& p : {Vec2(0.3, 0.35), Vec2(0.6, 0.7), Vec2(0.6, 0.3), Vec2(0.5, 0.7)})
      largest = std::max(largest, (map(p * (n - 1)) - bent(p) * (n - 1)).norm());
    return largest;
  };
  EXPECT_GT(error(lattice_of([](const Vec2& p) { return p; }, Vec2::Zero(), Vec2(n - 1, n - 1), 2, 2)), 6);
  for (const auto& [stiffness, most] : {std::pair(MatchOptions().stiffness, 1.2), std::pair(0.2, 0.8)}) {
    MatchOptions options;
    options.stiffness = stiffness;
    const LatticeMap map = match(a, b, options).there;
    EXPECT_GT(smallest_determinant(map), 0);
    EXPECT_LT(error(map), most) << stiffness;
  }
}

TEST(Match, TakesAGlobalTurnAndScaleOut) {
  constexpr int n = 96;
  Mat2 turn;
  turn << 0.85 * std::cos(0.5), -0.85 * std::sin(0.5), 0.85 * std::sin(0.5), 0.85 * std::cos(0.5);
  const Vec2 middle(0.5, 0.5);
  const auto turned = [&](const Vec2& p) { return Vec2(middle + turn * (p - middle)); };
  const Picture a = blobs(n, turned);
  const Picture b = blobs(n, [](const Vec2& p) { return p; });
  const auto error = [&](const Global global) {
    MatchOptions options;
    options.global = global;
    const LatticeMap map = match(a, b, options).there;
    EXPECT_GT(smallest_determinant(map), 0);
    double sum = 0;
    for (const Vec2& p : {Vec2(0.3, 0.35), Vec2(0.65, 0.7), Vec2(0.7, 0.3), Vec2(0.3, 0.7)})
      sum += (map(p * (n - 1)) - turned(p) * (n - 1)).norm() / 4;
    return sum;
  };
  EXPECT_LT(error(Global::rotation_and_scale), 0.3 * error(Global::none));
}

TEST(Match, PinsHold) {
  constexpr int n = 64;
  const Picture flat = blobs(n, [](const Vec2&) { return Vec2(9, 9); });
  MatchOptions options;
  options.pins = {{Vec2(20, 30), Vec2(26, 33)}};
  const LatticeMap map = match(flat, flat, options).there;
  EXPECT_NEAR((map(Vec2(20, 30)) - Vec2(26, 33)).norm(), 0, 0.3);
  EXPECT_GT(smallest_determinant(map), 0);
  options.pins = {{Vec2(20, 30), Vec2(26, 64)}};
  EXPECT_THROW(match(flat, flat, options), ParameterError);
}

TEST(Match, OpposedPinsDoNotFlip) {
  constexpr int n = 64;
  const Picture flat = blobs(n, [](const Vec2&) { return Vec2(9, 9); });
  MatchOptions options;
  options.pins = {{Vec2(20, 30), Vec2(40, 30)}, {Vec2(40, 30), Vec2(20, 30)}};
  EXPECT_GT(smallest_determinant(match(flat, flat, options).there), 0);
}

TEST(Match, MirroredInputGivesTheMirroredWarp) {
  constexpr int n = 65;
  const auto flipped = [](const Vec2& p) { return Vec2(1 - p[0], p[1]); };
  const Picture a = blobs(n, [](const Vec2&p) { return bent(p); }), b = blobs(n, [](const Vec2&p) { return p; });
  const Picture ma = blobs(n, [&](const Vec2&p) { return bent(flipped(p)); }), mb = blobs(n, flipped);
  const LatticeMap map = match(a, b, {}).there, mirrored = match(ma, mb, {}).there;
  for (const Vec2& p : {Vec2(20, 20), Vec2(40, 44), Vec2(33, 10)}) {
    const Vec2 q = mirrored(Vec2(n - 1 - p[0], p[1]));
    EXPECT_NEAR((Vec2(n - 1 - q[0], q[1]) - map(p)).norm(), 0, 0.1);
  }
}

TEST(Inverse, UndoesTheMap) {
  const LatticeMap map = lattice_of(bent, Vec2::Zero(), Vec2::Ones(), 17, 17);
  const LatticeMap back = inverse(map, Vec2::Zero(), Vec2::Ones(), 33, 33);
  EXPECT_GT(smallest_determinant(back), 0);
  for (const Vec2& node : back.nodes)
    EXPECT_TRUE((node.array() >= -1e-9).all() && (node.array() <= 1 + 1e-9).all());
  for (int r = 0; r < 33; ++r)
    for (int c = 0; c < 33; ++c)
      EXPECT_NEAR((map(back.node(c, r)) - back.source(c, r)).norm(), 0, 1e-8);
}

/// A star-shaped outline.
Vec2 outline(const double angle, const double wobble) {
  return (1 + wobble * std::cos(5 * angle)) * Vec2(std::cos(angle), std::sin(angle));
}

Curve outline_of(const int n, const double wobble, const Vec2& middle, const double radius) {
  Curve curve;
  for (int i = 0; i < n; ++i)
    curve.push_back(middle + radius * outline(2 * M_PI * i / n, wobble));
  return curve;
}

TEST(Fit, TakesPointsOfABoundaryToABoundaryWithoutAFold) {
  for (const auto inside : {Regularity::rigid, Regularity::jacobian})
    for (const double wobble : {0.0, 0.15, 0.25}) {
      std::vector<Pin> pairs;
      for (int i = 0; i < 256; ++i) {
        const double angle = 2 * M_PI * i / 256;
        pairs.push_back({outline(angle, 0), Vec2(300, 200) + 100 * outline(angle, wobble)});
      }
      const Affine start{100 * Mat2::Identity(), Vec2(300, 200)};
      const LatticeMap map = fit(pairs, start, Vec2(-1.1, -1.1), Vec2(1.1, 1.1), {.inside = inside});
      EXPECT_GT(smallest_determinant(map), 0);
      double mean = 0;
      for (const Pin& pair : pairs)
        mean += (map(pair.from) - pair.to).norm() / 256;
      EXPECT_LT(mean, 1) << wobble; // of a radius of 100
    }
}

TEST(Fit, FindsTheAffineMapBetweenCurves) {
  Mat2 linear;
  linear << 1.3, 0.2, 0.2, 0.8;
  const Curve from = outline_of(700, 0.25, Vec2(3, -8), 90);
  Curve to;
  for (const Vec2& p : from)
    to.push_back(Vec2(5, 7) + linear * p);
  std::rotate(to.begin(), to.begin() + 123, to.end());
  const Affine found = affine_between(from, to);
  EXPECT_LT((found.linear - linear).norm(), 1e-9);
  EXPECT_LT((found.shift - Vec2(5, 7)).norm(), 1e-7);
}

TEST(Fit, TakesACurveToACurveWithoutAFold) {
  const Grey section = [] {
    Grey mask(111, 111, 0);
    for (int r = 0; r < 111; ++r)
      for (int c = 0; c < 111; ++c)
        mask(c, r) = Vec2(c - 55, r - 55).norm() < 50 ? 1.0f : 0.0f;
    return mask;
  }();
  for (const auto inside : {Regularity::rigid, Regularity::jacobian})
    for (const double wobble : {0.0, 0.15, 0.25}) {
      const Curve from = outline_of(600, 0, Vec2::Zero(), 1), to = outline_of(700, wobble, Vec2(300, 200), 100);
      const LatticeMap map = fit(from, to, section, Vec2(-1.1, -1.1), Vec2(1.1, 1.1), {.inside = inside});
      EXPECT_GT(smallest_determinant(map), 0);
      Curve there;
      for (const Vec2& p : from)
        there.push_back(map(p));
      EXPECT_LT(gap(there, to).mean, 0.5) << wobble; // of a radius of 100
      EXPECT_LT(gap(to, there).largest, 2) << wobble;
    }
}

TEST(Partners, AreThePointsThemselvesWhereverACurveBegins) {
  const Curve curve = equally_spaced(outline_of(900, 0.2, Vec2::Zero(), 100), 256);
  Curve later = equally_spaced(curve, 1024);
  std::rotate(later.begin(), later.begin() + 300, later.end());
  const std::vector<int> found = partners(curve, later);
  for (int i = 0; i < 256; ++i)
    EXPECT_LT((later[found[i]] - curve[i]).norm(), 2) << i; // points of `later` are 0.8 apart
}

TEST(Partners, GoOnceAroundForwards) {
  const Curve from = equally_spaced(outline_of(900, 0.3, Vec2(3, 5), 90), 256);
  const Curve to = equally_spaced(outline_of(900, -0.2, Vec2::Zero(), 100), 1024);
  const std::vector<int> found = partners(from, to);
  int once = 0;
  for (int i = 0; i < 256; ++i) {
    const int step = (found[(i + 1) % 256] - found[i] + 1024) % 1024;
    EXPECT_LE(step, 16);
    once += step;
  }
  EXPECT_EQ(once, 1024);
}

} // namespace
} // namespace kerf::warp::match_test
