#include "image/distance.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace kerf::image::distance_test {
namespace {

TEST(Distance, IsThatOfASearch) {
  Grey mask(37, 23, 0);
  for (const auto& [c, r] : {std::pair{3, 4}, {30, 20}, {31, 20}, {17, 0}})
    mask(c, r) = 1;
  const Raster<double> found = squared_distances(mask);
  for (int r = 0; r < 23; ++r)
    for (int c = 0; c < 37; ++c) {
      int least = 1 << 20;
      for (int q = 0; q < 23; ++q)
        for (int p = 0; p < 37; ++p)
          if (mask(p, q) > 0)
            least = std::min(least, (p - c) * (p - c) + (q - r) * (q - r));
      EXPECT_EQ(found(c, r), least);
    }
}

TEST(Distance, IsOutOfReachWithoutAMask) {
  for (const double value : squared_distances(Grey(5, 4, 0)).values)
    EXPECT_GE(value, 1e12);
}

TEST(Closed, FillsWhatIsNarrowAndNothingElse) {
  Grey mask(60, 40, 0);
  const auto is_gap = [](const int c) { return (c >= 20 && c < 24) || (c >= 35 && c < 45); };
  for (int r = 5; r < 40; ++r) // to the picture's border, beyond which there is nothing
    for (int c = 5; c < 55; ++c)
      mask(c, r) = is_gap(c) ? 0.0f : 1.0f;
  const Grey filled = closed(mask, 3);
  for (int r = 8; r < 34; ++r) {
    EXPECT_EQ(filled(22, r), 1);
    EXPECT_EQ(filled(40, r), 0);
    EXPECT_EQ(filled(2, r), 0);
    EXPECT_EQ(filled(57, r), 0);
  }
  for (std::size_t i = 0; i < mask.values.size(); ++i)
    EXPECT_GE(filled.values[i], mask.values[i]);
}

} // namespace
} // namespace kerf::image::distance_test
