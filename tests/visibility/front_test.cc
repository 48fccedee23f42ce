#include "visibility/front.h"

#include "base/error.h"
#include "geometry/predicates.h"
#include "tests/visibility/cases.h"
#include "visibility/field.h"

#include <gtest/gtest.h>

#include <limits>

namespace kerf::visibility::front_test {
namespace {

CutFaces cut_of(const std::vector<std::vector<Face>>& parts) {
  CutFaces cut;
  for (const std::vector<Face>& part : parts)
    cut.add(part);
  return cut;
}

double length_of(const Front& front) {
  double sum = 0;
  for (const FrontEdge& edge : front.edges())
    sum += edge.length();
  return sum;
}

std::vector<Face> two_sided(const std::vector<Face>& faces) {
  std::vector<Face> both = faces;
  for (const Face& face : faces)
    both.push_back({face[0], face[2], face[1]});
  return both;
}

/// A closed box, its walls of 2 x 2 squares, so that strips that end in its middle planes share corners with it.
std::vector<Face> box(const double half) {
  std::vector<Face> faces;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-half, half})
      for (const double u : {-half, 0.})
        for (const double v : {-half, 0.}) {
          const auto corner = [&](const double x, const double y) {
            Vec3 p = Vec3::Constant(side);
            p[(axis + 1) % 3] = x;
            p[(axis + 2) % 3] = y;
            return p;
          };
          const Vec3 a = corner(u, v), b = corner(u + half, v), c = corner(u + half, v + half), d = corner(u, v + half);
          faces.push_back({a, b, c});
          faces.push_back({a, c, d});
        }
  return faces;
}

TEST(CutFaces, FindsWhatASearchOneByOneFinds) {
  Random random(1);
  CutFaces cut;
  int n_found = 0;
  for (const int n : {1, 1, 2, 7, 100, 3, 200, 0, 1}) {
    std::vector<Face> faces(n);
    for (Face& face : faces) {
      const Vec3 middle = random.vector();
      for (Vec3& corner : face)
        corner = middle + 0.3 * random.vector();
    }
    cut.add(faces);
    for (int i = 0; i < 100; ++i) {
      const Vec3 p = random.vector(), q = random.vector();
      std::vector<std::uint32_t> expected;
      for (std::uint32_t f = 0; f < cut.all().size(); ++f)
        if (geometry::crosses(p, q, cut.all()[f]))
          expected.push_back(f);
      EXPECT_EQ(cut.crossed(p, q), expected);
      EXPECT_EQ(cut.separates(p, q), !expected.empty());
      n_found += static_cast<int>(expected.size());
    }
  }
  EXPECT_GT(n_found, 500);
}

TEST(CutFaces, RefusesCornersThatAreNowhere) {
  CutFaces cut;
  const Vec3 nowhere(0, std::numeric_limits<double>::quiet_NaN(), 0);
  const Face face{nowhere, Vec3::Zero(), Vec3::Ones()};
  EXPECT_THROW(cut.add({&face, 1}), NumericalError);
  EXPECT_TRUE(cut.all().empty());
}

TEST(Front, IsTheBorderOfASheet) {
  const CutFaces cut = cut_of(growing_strip(-1, 1, 8, 0.5, 0.2));
  const Front front(cut);
  EXPECT_NEAR(length_of(front), 6, 1e-14);
  EXPECT_EQ(front.edges().size(), 18u);
  for (const FrontEdge& edge : front.edges()) {
    const Vec3 middle = 0.5 * edge.from + 0.5 * edge.to;
    EXPECT_NEAR(edge.outwards.norm(), 1, 1e-14);
    EXPECT_GT(edge.outwards.dot(middle - Vec3(0, 0, 0.2)), 0.49); // away from the middle of the strip
    EXPECT_EQ(edge.outwards[2], 0);
  }
}

TEST(Front, CountsBothSidesOfACutOnce) {
  const CutFaces cut = cut_of({two_sided(strip(-1, 1, 0.5, 0)), two_sided(strip(1, 2, 0.5, 0))});
  EXPECT_NEAR(length_of(Front(cut)), 2 * (3 + 1), 1e-14);
}

TEST(Front, MergingStripsHaveFrontsUntilTheyMeet) {
  std::vector<std::vector<Face>> parts = merging_strips(1, 4, 0.5, 0);
  const std::vector<Face> last = parts.back();
  parts.pop_back();
  CutFaces cut = cut_of(parts);
  const Front before(cut);
  EXPECT_NEAR(length_of(before), 2 * 2 * (0.75 + 1), 1e-14);
  EXPECT_NE(before.sheet(0), before.sheet(2)); // left, right
  cut.add(last);
  const Front after(cut);
  EXPECT_NEAR(length_of(after), 2 * (2 + 1), 1e-14);
  EXPECT_EQ(after.sheet(0), after.sheet(2));
}

TEST(Front, NoneWhereTheCutLiesOnTheSkin) {
  const std::vector<Face> skin = box(1);
  EXPECT_EQ(Front(cut_of({skin})).edges().size(), 0u);
  // Half through: one front of length 2. Its other edges are on the skin, two of them without common corners.
  const Front half(cut_of({skin, strip(-1, 0.25, 1, 0)}));
  EXPECT_NEAR(length_of(half), 2, 1e-14);
  // Through.
  EXPECT_EQ(Front(cut_of({skin, strip(-1, 0.25, 1, 0), strip(0.25, 1, 1, 0)})).edges().size(), 0u);
}

TEST(Front, NoneWhereALaterFaceRunsOver) {
  const Front front(cut_of({strip(-1, 0.3, 0.5, 0), strip(-1, 1, 0.5, 0)}));
  for (const FrontEdge& edge : front.edges()) {
    EXPECT_FALSE(edge.from[0] == 0.3 && edge.to[0] == 0.3);
  }
}

TEST(Front, FacesWithoutAreaHaveNone) {
  const Vec3 a(0, 0, 0), b(1, 0, 0);
  EXPECT_EQ(Front(cut_of({{Face{a, a, a}, Face{a, b, b}, Face{a, b, 0.5 * a + 0.5 * b}}})).edges().size(), 0u);
  EXPECT_EQ(Front(CutFaces()).edges().size(), 0u);
}

} // namespace
} // namespace kerf::visibility::front_test
