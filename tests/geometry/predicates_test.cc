#include "geometry/predicates.h"

#include "tests/geometry/meshes.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

namespace kerf::geometry::predicates_test {
namespace {

using Corners = std::array<Vec3, 3>;

/// The rule by brute force, for integer coordinates from 0 to 4: everything is scaled by 2^30 and the triangle really
/// displaced, with eps = 2^-10, small enough for such coordinates. Exact in 128 bits.
struct Oracle {
  using Wide = __int128;
  using Point = std::array<Wide, 3>;

  static Point scaled(const Vec3& p) {
    constexpr double scale = 1 << 30;
    return {static_cast<Wide>(scale * p[0]), static_cast<Wide>(scale * p[1]), static_cast<Wide>(scale * p[2])};
  }
  static Point displaced(const Vec3& p) {
    const Point s = scaled(p);
    return {s[0] + (1 << 20), s[1] + (1 << 10), s[2] + 1};
  }
  static int orientation(const Point& a, const Point& b, const Point& c, const Point& p) {
    std::array<Point, 3> m;
    for (int d = 0; d < 3; ++d) {
      m[0][d] = b[d] - a[d];
      m[1][d] = c[d] - a[d];
      m[2][d] = p[d] - a[d];
    }
    const Wide det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                     m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                     m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    return (det > 0) - (det < 0);
  }
  static int side(const Vec3& p, const Corners& t) {
    return orientation(displaced(t[0]), displaced(t[1]), displaced(t[2]), scaled(p));
  }
  static bool crosses(const Vec3& p, const Vec3& q, const Corners& t) {
    if (side(p, t) * side(q, t) != -1)
      return false;
    const auto edge = [&](const int i, const int j) {
      return orientation(scaled(p), scaled(q), displaced(t[i]), displaced(t[j]));
    };
    return edge(0, 1) != 0 && edge(0, 1) == edge(1, 2) && edge(0, 1) == edge(2, 0);
  }
};

/// Points of a small lattice: nearly every draw touches something.
class Lattice {
 public:
  explicit Lattice(const unsigned seed) : random_(seed) {}
  Vec3 point() { return Vec3(number(), number(), number()); }
  Corners triangle() { return {point(), point(), point()}; }
  int number() { return coordinate_(random_); }

 private:
  std::mt19937 random_;
  std::uniform_int_distribution<int> coordinate_{0, 3};
};

TEST(Predicates, SideAgreesWithBruteForce) {
  Lattice draw(1);
  for (int i = 0; i < 200000; ++i) {
    const Vec3 p = draw.point();
    const Corners triangle = draw.triangle();
    ASSERT_EQ(side(p, triangle), Oracle::side(p, triangle)) << i;
  }
}

TEST(Predicates, CrossingAgreesWithBruteForce) {
  Lattice draw(2);
  int n_crossings = 0;
  for (int i = 0; i < 400000; ++i) {
    const Vec3 p = draw.point(), q = draw.point();
    const Corners triangle = draw.triangle();
    ASSERT_EQ(crosses(p, q, triangle), Oracle::crosses(p, q, triangle)) << i;
    n_crossings += crosses(p, q, triangle) ? 1 : 0;
  }
  EXPECT_GT(n_crossings, 10000);
}

TEST(Predicates, CrossingDependsOnNoOrder) {
  Lattice draw(3);
  for (int i = 0; i < 50000; ++i) {
    const Vec3 p = draw.point(), q = draw.point();
    Corners t = draw.triangle();
    const bool expected = crosses(p, q, t);
    const int expected_side = side(p, t);
    ASSERT_EQ(side(p, {t[1], t[2], t[0]}), expected_side);
    ASSERT_EQ(side(p, {t[0], t[2], t[1]}), -expected_side);
    std::array<int, 3> order = {0, 1, 2};
    do {
      ASSERT_EQ(crosses(p, q, {t[order[0]], t[order[1]], t[order[2]]}), expected);
      ASSERT_EQ(crosses(q, p, {t[order[0]], t[order[1]], t[order[2]]}), expected);
    } while (std::next_permutation(order.begin(), order.end()));
  }
}

TEST(Predicates, LinesAgreeWithSegments) {
  Lattice draw(4);
  for (int i = 0; i < 100000; ++i) {
    const int axis = i % 3;
    Vec3 p = draw.point(), q = p;
    p[axis] = -10;
    q[axis] = 10;
    const Corners triangle = draw.triangle();
    const int above = line_crosses(p, axis, triangle);
    ASSERT_EQ(above != 0, crosses(p, q, triangle));
    ASSERT_TRUE(above == 0 || above == side(q, triangle));
  }
}

/// Nearly degenerate, far from the origin, where rounded determinants have the wrong sign.
TEST(Predicates, SidesAreExactWhereRoundingFails) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> number(0, 1 << 20);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 a(number(random), number(random), number(random)), b(number(random), number(random), number(random)),
      c(number(random), number(random), number(random));
    const Vec3 in_plane = a + (b - a) + (c - a), off = in_plane + Vec3::Unit(i % 3);
    const Corners triangle = {a, b, c};
    const auto wide = [](const Vec3& v) {
      return Oracle::Point{Oracle::Wide(v[0]), Oracle::Wide(v[1]), Oracle::Wide(v[2])};
    };
    const int exact = Oracle::orientation(wide(a), wide(b), wide(c), wide(off));
    ASSERT_EQ(side(off, triangle), exact != 0 ? exact : side(in_plane, triangle));
    const double normal_x = (b - a).cross(c - a)[0]; // of integers below 2^42: exact
    ASSERT_TRUE(normal_x == 0 || side(in_plane, triangle) == (normal_x > 0 ? -1 : 1));
  }
}

TEST(Predicates, TrianglesWithoutAreaCrossNothing) {
  const Corners line = {Vec3(0, 0, 0), Vec3(2, 2, 2), Vec3(1, 1, 1)};
  const Corners point = {Vec3(1, 1, 1), Vec3(1, 1, 1), Vec3(1, 1, 1)};
  EXPECT_EQ(side({0, 1, 2}, line), 0);
  EXPECT_EQ(side({0, 1, 2}, point), 0);
  for (int x = -1; x <= 3; ++x)
    for (int y = -1; y <= 3; ++y) {
      EXPECT_FALSE(crosses(Vec3(x, y, -1), Vec3(y, x, 3), line));
      EXPECT_FALSE(crosses(Vec3(x, y, -1), Vec3(y, x, 3), point));
    }
}

TEST(Predicates, CrossingParameter) {
  const Corners triangle = {Vec3(0, 0, 0.25), Vec3(1, 0, 0.25), Vec3(0, 1, 0.25)};
  EXPECT_DOUBLE_EQ(crossing_parameter({0.1, 0.1, 0}, {0.1, 0.1, 1}, triangle), 0.25);
  EXPECT_DOUBLE_EQ(crossing_parameter({0.1, 0.1, 1}, {0.1, 0.1, 0}, triangle), 0.75);
  EXPECT_EQ(unit_normal(triangle), Vec3::UnitZ());
}

/// A fan of lattice triangles fills a square; lines through its corners, edges and inside meet it once.
TEST(Predicates, StripsNeitherLeakNorDouble) {
  constexpr int n = 4;
  Points rim;
  for (int i = 0; i < n; ++i)
    rim.emplace_back(i, 0, 0);
  for (int i = 0; i < n; ++i)
    rim.emplace_back(n, i, 0);
  for (int i = n; i > 0; --i)
    rim.emplace_back(i, n, 0);
  for (int i = n; i > 0; --i)
    rim.emplace_back(0, i, 0);
  for (int apex = 0; apex < 9; ++apex)
    for (int x = 0; x <= n; ++x)
      for (int y = 0; y <= n; ++y) {
        const Vec3 centre(1 + apex % 3, 1 + apex / 3, 0);
        std::array<int, 3> n_crossings{};
        for (std::size_t i = 0; i < rim.size(); ++i) {
          const Corners triangle = {centre, rim[i], rim[(i + 1) % rim.size()]};
          n_crossings[0] += crosses(Vec3(x, y, -1), Vec3(x, y, 1), triangle);
          n_crossings[1] += crosses(Vec3(x, y, 0), Vec3(x, y, 1), triangle);
          n_crossings[2] += crosses(Vec3(x, y, -1), Vec3(x, y, 0), triangle);
        }
        // The square moved by d holds x in (0, n] and y in (0, n], and lies above z = 0.
        const int expected = x > 0 && y > 0 ? 1 : 0;
        ASSERT_EQ(n_crossings[0], expected) << x << ' ' << y;
        ASSERT_EQ(n_crossings[1], expected) << x << ' ' << y;
        ASSERT_EQ(n_crossings[2], 0) << x << ' ' << y;
      }
}

/// Boxes of lattice cubes: every vertex, edge and face is met by lattice segments. A node is inside the displaced cube
/// of which it is the upper corner.
class Voxels : public testing::TestWithParam<unsigned> {
 protected:
  static constexpr int n = 3;

  void SetUp() override {
    std::mt19937 random(GetParam());
    for (int x = 0; x < n; ++x)
      for (int y = 0; y < n; ++y)
        for (int z = 0; z < n; ++z)
          if (random() % 2 == 0) {
            filled_.insert({x, y, z});
            mesh_ = together(std::move(mesh_), box_mesh(Vec3(x, y, z), Vec3(x + 1, y + 1, z + 1)));
          }
  }
  bool is_inside(const Vec3& p) const {
    return filled_.contains({static_cast<int>(p[0]) - 1, static_cast<int>(p[1]) - 1, static_cast<int>(p[2]) - 1});
  }
  bool is_crossed_oddly(const Vec3& p, const Vec3& q) const {
    int n_crossings = 0;
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i)
      n_crossings += crosses(p, q, corners(mesh_, i)) ? 1 : 0;
    return n_crossings % 2 == 1;
  }

  std::set<Index3> filled_;
  TriangleMesh mesh_;
};

TEST_P(Voxels, SegmentsTellInsideFromOutside) {
  std::mt19937 random(GetParam() + 100);
  std::uniform_int_distribution<int> number(0, n + 1);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p(number(random), number(random), number(random)), q(number(random), number(random), number(random));
    ASSERT_EQ(is_crossed_oddly(p, q), is_inside(p) != is_inside(q));
  }
}

TEST_P(Voxels, LoopsOfFourEdgesCrossEvenly) {
  for (int axis = 0; axis < 3; ++axis)
    for (int k = 0; k < 64; ++k) {
      const Vec3 p(k % 4, k / 4 % 4, k / 16), u = Vec3::Unit((axis + 1) % 3), v = Vec3::Unit((axis + 2) % 3);
      const int n_odd = is_crossed_oddly(p, p + u) + is_crossed_oddly(p + u, p + u + v) +
                        is_crossed_oddly(p + u + v, p + v) + is_crossed_oddly(p + v, p);
      ASSERT_EQ(n_odd % 2, 0);
    }
}

INSTANTIATE_TEST_SUITE_P(Random, Voxels, testing::Range(0u, 6u));

/// Points closer to an edge than doubles can tell when they subtract (the picture of Kettner, Mehlhorn, Pion, Schirra,
/// Yap, Classroom examples of robustness problems in geometric computations, 2008): the exact sign decides.
TEST(Predicates, DecideBelowRoundOff) {
  const double u = std::ldexp(1.0, -53); // half an ulp of the differences that are formed, and less
  const Corners below_diagonal = {Vec3(-12, -12, 0), Vec3(24, -12, 0), Vec3(24, 24, 0)};
  for (int x = 0; x < 64; ++x)
    for (int y = 0; y < 64; ++y) {
      if (x == y)
        continue;
      for (int axis = 0; axis < 3; ++axis) { // the same picture seen along each axis
        const auto turned = [axis](const Vec3& p) -> Vec3 {
          Vec3 q;
          for (int d = 0; d < 3; ++d)
            q[(axis + 1 + d) % 3] = p[d];
          return q;
        };
        const Corners triangle = {turned(below_diagonal[0]), turned(below_diagonal[1]), turned(below_diagonal[2])};
        const Vec3 p(0.5 + x * u, 0.5 + y * u, -1), q(0.5 + x * u, 0.5 + y * u, 1);
        ASSERT_EQ(line_crosses(turned(p), axis, triangle) != 0, y < x) << x << " " << y << " axis " << axis;
        ASSERT_EQ(crosses(turned(p), turned(q), triangle), y < x) << x << " " << y << " axis " << axis;
      }
    }
}

} // namespace
} // namespace kerf::geometry::predicates_test
