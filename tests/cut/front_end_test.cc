#include "surface/closing.h"

#include "tests/cut/cutting.h"

#include <Eigen/Geometry>

#include <cmath>
#include <iostream>
#include <numbers>
#include <set>

namespace kerf::cut::front_end_test {
namespace {

/// Where the surface of a flat cut closes: the vertices that both of its sides share; and its area.
struct Drawn {
  Points end;
  double area = 0; ///< of one side
};
Drawn drawn(const surface::Surface& surface, const Vec3& normal) {
  std::set<std::uint32_t> above, below;
  Drawn result;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    if (surface.labels[i] == grid::skin_label)
      continue;
    const auto& [a, b, c] = surface.triangles[i];
    const Vec3 twice = (surface.rest[b] - surface.rest[a]).cross(surface.rest[c] - surface.rest[a]);
    (twice.dot(normal) > 0 ? above : below).insert({a, b, c});
    result.area += 0.25 * twice.norm();
  }
  for (const std::uint32_t v : above)
    if (below.contains(v))
      result.end.push_back(surface.rest[v]);
  return result;
}

/// How far points lie off a disc's circle, in its plane (root mean square).
double off_circle(const Points& points, const Disc& disc) {
  double squares = 0;
  for (const Vec3& p : points) {
    const Vec3 d = p - disc.centre;
    squares += std::pow((d - d.dot(disc.normal) * disc.normal).norm() - disc.radius, 2);
  }
  return std::sqrt(squares / static_cast<double>(points.size()));
}

/// Up to x from the side x = 0, in the plane z = 5.4.
Rectangle rectangle_to(const double x) { return {Vec3(0.5 * x, 5, 5.4), Vec3(x, 0, 0), Vec3(0, 40, 0)}; }

/// At the skin vertices keep clear of it.
TEST(FrontEnd, IsDrawnWhereARectangleEnds) {
  for (const Fronts fronts : {Fronts::of_elements, Fronts::of_points})
    for (double x = 3.03; x < 6; x += 0.0725) {
      Cutting cutting(block(), fronts);
      cutting.cut(rectangle_to(x));
      const Drawn cut = drawn(cutting.surface, Vec3::UnitZ());
      ASSERT_GT(cut.end.size(), 15u);
      for (const Vec3& p : cut.end)
        EXPECT_NEAR(p[0], x, std::abs(p[1] - 5) < 4 ? 0.03 : 0.1) << x;
    }
}

class DrawnEnds : public testing::TestWithParam<Fronts> {};
INSTANTIATE_TEST_SUITE_P(FrontEnd, DrawnEnds, testing::Values(Fronts::of_elements, Fronts::of_points),
                         [](const auto& info) { return info.param == Fronts::of_points ? "of_points" : "of_elements"; });

TEST_P(DrawnEnds, AreWhereABladeIs) {
  for (const double step : {0.07, 0.3, 0.9}) {
    Cutting cutting(block(), GetParam());
    const Blade blade = {"blade", {Vec3(0, -20, 0), Vec3(0, 20, 0)}, {{0, Vec3(-2, 0, 5.4)}, {100, Vec3(98, 0, 5.4)}}};
    int n = 0;
    for (double t = 0; t < 9; t += step) {
      cutting.step(blade, t, t + step);
      const double x = t + step - 2;
      if (x < 1.5 || cutting.cutter.n_waiting() > 0)
        continue;
      for (const Vec3& p : drawn(cutting.surface, Vec3::UnitZ()).end)
        EXPECT_NEAR(p[0], x, std::abs(p[1] - 5) < 4 ? 0.13 : 0.2) << step;
      ++n;
    }
    EXPECT_GT(n, 3);
    expect_as_built(cutting);
  }
}

/// Anywhere and at any angle, but for single vertices where the cut only grazes a cell. (While it closed halfway through
/// cells: .32 cubes, 4 % of the area.)
TEST(FrontEnd, OfDiscsIsTheirCircle) {
  support::Random random(5);
  double sum = 0;
  constexpr int n = 40;
  for (int i = 0; i < n; ++i) {
    const Disc disc{Vec3(5, 5, 5) + 0.5 * support::random_vector(random), support::random_direction(random),
                    support::uniform(random, 2.2, 3.4)};
    Cutting cutting(block(), Fronts::of_elements);
    cutting.cut(disc);
    const Drawn cut = drawn(cutting.surface, disc.normal);
    ASSERT_GT(cut.end.size(), 30u);
    const double off = off_circle(cut.end, disc);
    EXPECT_LT(off, 0.25) << i;
    EXPECT_NEAR(cut.area / (std::numbers::pi * disc.radius * disc.radius), 1, 0.02) << i;
    sum += off / n;
  }
  EXPECT_LT(sum, 0.06);
  std::cout << "off by " << sum << " cubes\n";
}

/// It encloses nothing, and nothing else hangs on it: material is what it was.
TEST(FrontEnd, EnclosesNothing) {
  support::Random random(6);
  for (int i = 0; i < 20; ++i) {
    const Body ball = support::with_copies(support::with_placed_skin(support::ball(3.5, 1, support::random_offset(random))));
    Cutting with(ball, Fronts::of_elements), without(ball, Fronts::at_faces);
    const Vec3 n = support::random_direction(random), along = n.unitOrthogonal();
    const Blade blade = {"blade",
                         {-9 * n.cross(along), 9 * n.cross(along)},
                         {{0, -5 * along + support::uniform(random, -1, 1) * n}, {1, support::uniform(random, -1, 1) * along}}};
    for (int k = 0; k < 15; ++k) {
      with.step(blade, k / 15.0, (k + 1) / 15.0);
      without.step(blade, k / 15.0, (k + 1) / 15.0);
    }
    expect_alike(with, without);
    expect_as_built(with);
  }
}

/// What comes less far into a cell later takes nothing back.
TEST(FrontEnd, StaysWhereTheFarthestCutHasCome) {
  const auto expect_end = [](const Cutting& cutting, const double x) {
    const Drawn cut = drawn(cutting.surface, Vec3::UnitZ());
    ASSERT_GT(cut.end.size(), 15u);
    for (const Vec3& p : cut.end)
      EXPECT_NEAR(p[0], x, std::abs(p[1] - 5) < 4 ? 0.03 : 0.1);
  };
  for (const double less : {4.1, 4.35, 4.55}) {
    Cutting cutting(block(), Fronts::of_elements);
    cutting.cut(rectangle_to(4.6));
    cutting.cut(rectangle_to(less));
    expect_end(cutting, 4.6);
    expect_as_built(cutting);
    const Blade blade = {"blade", {Vec3(0, -20, 0), Vec3(0, 20, 0)}, {{0, Vec3(-2, 0, 5.4)}, {1, Vec3(less, 0, 5.4)}}};
    for (int k = 0; k < 20; ++k)
      cutting.step(blade, k / 20.0, (k + 1) / 20.0);
    expect_end(cutting, 4.6);
    expect_as_built(cutting);
  }
}

/// In a body that is sheared where it is cut, the circle is there.
TEST(FrontEnd, OfDiscsIsTheirCircleWhereBodiesAreSheared) {
  support::Random random(8);
  double sum = 0;
  constexpr int n = 20;
  for (int i = 0; i < n; ++i) {
    Mat3 F = Mat3::Identity();
    F(0, 1) = support::uniform(random, -0.4, 0.4);
    F(2, 0) = support::uniform(random, -0.4, 0.4);
    const Disc disc{F * Vec3(5, 5, 5) + 0.5 * support::random_vector(random), support::random_direction(random),
                    support::uniform(random, 2.2, 3)};
    Cutting cutting(block(), Fronts::of_elements);
    Points x = grid::rest_positions(cutting.body);
    for (Vec3& p : x)
      p = F * p;
    cutting.follow(cutting.cutter.at_once(cutting.body, {"cut", disc, 1}, x));
    const Drawn cut = drawn(cutting.surface, F.transpose() * disc.normal);
    ASSERT_GT(cut.end.size(), 30u);
    Points there;
    for (const Vec3& p : cut.end)
      there.push_back(F * p);
    sum += off_circle(there, disc) / n;
  }
  EXPECT_LT(sum, 0.06);
  std::cout << "off by " << sum << " cubes\n";
}

/// Two discs that cross: what is drawn of each stays near its own plane, but in cells that both divide. (1.2 % of the
/// vertices were off it while any front beside a face was taken for that of the cut which leads there.)
TEST(FrontEnd, IsThatOfItsOwnCut) {
  support::Random random(9);
  std::size_t n = 0, n_off = 0;
  for (int i = 0; i < 30; ++i) {
    Cutting cutting(block(), Fronts::of_elements);
    std::vector<Disc> discs;
    for (int k = 0; k < 2; ++k) {
      discs.push_back({Vec3(5, 5, 5) + support::random_vector(random), support::random_direction(random),
                       support::uniform(random, 1.5, 3)});
      cutting.follow(cutting.cutter.at_once(cutting.body,
                                            {"cut", discs.back(), static_cast<grid::CutLabel>(k + 1)},
                                            grid::rest_positions(cutting.body)));
    }
    expect_as_built(cutting);
    for (std::size_t t = 0; t < cutting.surface.triangles.size(); ++t)
      if (const grid::CutLabel label = cutting.surface.labels[t]; label != grid::skin_label)
        for (const std::uint32_t v : cutting.surface.triangles[t]) {
          const Disc& disc = discs[label - 1];
          ++n;
          n_off += std::abs(disc.normal.dot(cutting.surface.rest[v] - disc.centre)) > 0.3;
        }
  }
  std::cout << n_off << " of " << n << '\n';
  EXPECT_LT(double(n_off), 0.0105 * double(n));
}

} // namespace
} // namespace kerf::cut::front_end_test
