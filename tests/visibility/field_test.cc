#include "visibility/field.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <map>

namespace kerf::visibility::field_test {
namespace {

CriterionChoice choice(const std::string& name) {
  CriterionChoice c;
  c.criterion = name;
  return c;
}

/// The picture of figure 2.9: a point above a cut, seen from the side.
constexpr int n_side = 80;
const Plane picture{Vec3(-1, 0, -1), Vec3(2. / n_side, 0, 0), Vec3(0, 0, 2. / n_side), n_side, n_side};
constexpr double support = 1, height = -0.25;

std::vector<double> field(const std::string& name, const std::vector<Face>& cut) {
  return weight_field(choice(name), cut, Vec3::Zero(), support, picture);
}
double at(const std::vector<double>& weights, const double x, const double z) {
  return weights[static_cast<int>((z + 1) / 2 * n_side) * n_side + static_cast<int>((x + 1) / 2 * n_side)];
}

std::vector<Face> with_gap(const double left, const double right) {
  std::vector<Face> cut = strip(-3, left, 3, height);
  for (const Face& face : strip(right, 3, 3, height))
    cut.push_back(face);
  return cut;
}

TEST(Field, IsTheKernelWithoutACut) {
  const std::vector<double> expected = field("visibility", {});
  EXPECT_GT(at(expected, 0, 0), 0.99);
  EXPECT_EQ(at(expected, 0.9, 0.9), 0);
  for (const std::string& name : criteria())
    EXPECT_EQ(field(name, {}), expected);
}

/// Thesis, page of figure 2.9, first row: all criteria separate the two sides behind the front; visibility jumps at the
/// horizon, the others do not; extended visibility decays fastest around the tip.
TEST(Field, OneFrontLooksLikeTheFigure) {
  const std::vector<Face> cut = strip(-3, 0.1, 3, height);
  const std::vector<double> free = field("visibility", {});
  std::map<std::string, double> jump;
  for (const std::string& name : criteria()) {
    const std::vector<double> weights = field(name, cut);
    // Next to the cut on the near side: only the cones of extended visibility touch it, but it stays bound.
    for (double x = -0.9; x < 0.1; x += 0.1) {
      const double near = at(weights, x, height + 0.02), all = at(free, x, height + 0.02);
      if (name == "extended visibility") {
        EXPECT_GT(near, 0.6 * all);
      } else {
        EXPECT_EQ(near, all) << name;
      }
    }
    EXPECT_LT(at(weights, -0.6, height - 0.05), 0.01) << name;
    EXPECT_NEAR(at(weights, 0.8, -0.2), at(free, 0.8, -0.2), 1e-3) << name;
    // Along an arc of radius 0.5 below the cut, across the horizon.
    double last = at(weights, 0.5 * std::cos(-1.9), 0.5 * std::sin(-1.9));
    for (double angle = -1.9; angle < -0.6; angle += 0.05) {
      const double value = at(weights, 0.5 * std::cos(angle), 0.5 * std::sin(angle));
      jump[name] = std::max(jump[name], std::abs(value - last));
      last = value;
    }
  }
  EXPECT_GT(jump["visibility"], 0.35);
  EXPECT_LT(jump["diffraction"], 0.15);
  EXPECT_LT(jump["transparency"], 0.15);
  EXPECT_LT(jump["extended visibility"], 0.15);
  // Just behind the tip, below the cut.
  const double extended = at(field("extended visibility", cut), 0, height - 0.1);
  EXPECT_LT(extended, 0.5 * at(field("diffraction", cut), 0, height - 0.1));
  EXPECT_LT(extended, 0.5 * at(field("transparency", cut), 0, height - 0.1));
}

/// Second row: when the gap is nearly closed, diffraction and transparency do not know it yet, extended visibility has
/// taken nearly all.
TEST(Field, TwoFrontsLookLikeTheFigure) {
  const std::vector<Face> nearly = with_gap(0.1, 0.1002), closed = with_gap(0.1, 0.1);
  for (const std::string& name : criteria())
    EXPECT_EQ(at(field(name, closed), 0.1, -0.5), 0) << name;
  EXPECT_GT(at(field("diffraction", nearly), 0.1, -0.5), 0.3);
  EXPECT_GT(at(field("transparency", nearly), 0.1, -0.5), 0.3);
  EXPECT_LT(at(field("extended visibility", nearly), 0.1, -0.5), 0.01);
}

TEST(LargestJump, IsOfNeighbours) {
  EXPECT_EQ(largest_jump(std::vector<double>{1, 0.5, 0.75, 0}), 0.75);
  EXPECT_EQ(largest_jump(std::vector<double>{1}), 0);
  EXPECT_EQ(largest_jump({}), 0);
}

/// Figure 2.19: the finer the steps of the cut, the smaller those of the weight, with one front for all but visibility;
/// with two that merge only for extended visibility.
TEST(History, OnlyExtendedVisibilityIsContinuousWhereFrontsMerge) {
  const Pair pair{Vec3::Zero(), Vec3(0.1, 0.03, -0.6), support};
  for (const std::string& name : criteria()) {
    double one = 0, merging = 0;
    for (const int n : {20, 160}) {
      const auto alone = weight_history(choice(name), growing_strip(-1.5, 1.5, n, 1.5, height), pair);
      const auto both = weight_history(choice(name), merging_strips(1.5, n, 1.5, height), pair);
      ASSERT_EQ(alone.size(), n + 1u);
      EXPECT_EQ(alone.back(), 0) << name;
      EXPECT_EQ(both.back(), 0) << name;
      EXPECT_TRUE(std::is_sorted(alone.rbegin(), alone.rend())) << name;
      EXPECT_TRUE(std::is_sorted(both.rbegin(), both.rend())) << name;
      one = largest_jump(alone) / alone.front();
      merging = largest_jump(both) / both.front();
    }
    std::printf("%-20s largest jump of the weight, 160 steps: one front %.3f, merging fronts %.3f\n", name.c_str(), one,
                merging);
    if (name == "visibility") {
      EXPECT_EQ(one, 1);
    } else {
      EXPECT_LT(one, 0.1) << name;
    }
    if (name == "extended visibility") {
      EXPECT_LT(merging, 0.06);
    } else {
      EXPECT_GT(merging, 0.9) << name;
    }
  }
}

TEST(MergingStrips, ShareTheirLastCorners) {
  const auto parts = merging_strips(0.3, 7, 1, 0.1);
  ASSERT_EQ(parts.size(), 7u);
  int n_shared = 0;
  for (const Face& face : parts.back())
    for (const Vec3& corner : face)
      n_shared += corner[0] == 0;
  EXPECT_EQ(n_shared, 6);
}

} // namespace
} // namespace kerf::visibility::field_test
