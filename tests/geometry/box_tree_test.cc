#include "geometry/box_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace kerf::geometry::box_tree_test {
namespace {

/// Corners on a coarse raster, so that many boxes only touch, are flat, or stand in the same place.
std::vector<Box> random_boxes(std::mt19937& random, const int n) {
  std::uniform_int_distribution<int> place(0, 20), size(0, 4);
  std::vector<Box> boxes;
  for (int i = 0; i < n; ++i) {
    const Vec3 lower(place(random), place(random), place(random));
    boxes.push_back({lower, lower + Vec3(size(random), size(random), size(random))});
  }
  return boxes;
}

TEST(BoxTree, FindsWhatASearchOneByOneFinds) {
  std::mt19937 random(1);
  std::size_t n_found = 0;
  for (const int n : {0, 1, 2, 8, 9, 17, 100, 3000}) {
    const auto boxes = random_boxes(random, n);
    const BoxTree tree(boxes);
    for (const Box& query : random_boxes(random, 100)) {
      std::vector<std::uint32_t> expected, found;
      for (std::uint32_t i = 0; i < boxes.size(); ++i)
        if (overlap(boxes[i], query))
          expected.push_back(i);
      tree.for_each(query, [&](const std::uint32_t i) { found.push_back(i); });
      std::sort(found.begin(), found.end());
      EXPECT_EQ(found, expected);
      n_found += found.size();
    }
  }
  EXPECT_GT(n_found, 1000u);
}

TEST(BoxTree, TakesBoxesInOnePlace) {
  const BoxTree tree(std::vector<Box>(50, Box{Vec3::Zero(), Vec3::Ones()}));
  int n = 0;
  tree.for_each({Vec3::Ones(), Vec3::Constant(2)}, [&](std::uint32_t) { ++n; });
  EXPECT_EQ(n, 50);
  tree.for_each({Vec3::Constant(1.5), Vec3::Constant(2)}, [&](std::uint32_t) { ADD_FAILURE(); });
}

} // namespace
} // namespace kerf::geometry::box_tree_test
