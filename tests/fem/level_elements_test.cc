// Elements of coarse copies, and which of them are taken over after a cut.

#include "fem/level_elements.h"

#include "fem/element.h"
#include "tests/fem/models.h"
#include "tests/fem/samples.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace kerf::fem::level_elements_test {
namespace {

/// 8 x 8 x 8 cubes, each with material of its own, of which one changes: one of the 64 coarse elements is summed anew,
/// and all are what they are without those before.
TEST(LevelElements, TakeOverWhatHasNotChanged) {
  constexpr int n = 8;
  Draw draw(353);
  const material::Elastic material{.density = 1000, .youngs_modulus = 1e5, .poissons_ratio = 0.3};
  CellsOfLevel cells;
  const auto corner = [](const int i, const int j, const int k) {
    return static_cast<std::uint32_t>(i + (n + 1) * (j + (n + 1) * k));
  };
  std::vector<Element> fine;
  const auto any_element = [&] {
    Moments moments = full_cube_moments();
    for (double& m : moments)
      m *= 1 + 0.1 * draw(-1, 1);
    return make_element(moments, 0.1, material, {});
  };
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        cells.place.push_back({i, j, k});
        fine.push_back(any_element());
        for (int v = 0; v < 8; ++v)
          cells.corners.push_back(corner(i + (v & 1), j + (v >> 1 & 1), k + (v >> 2)));
      }
  cells.n_corners = static_cast<std::size_t>(n + 1) * (n + 1) * (n + 1);
  const Coarsening coarsening = coarsened(cells);
  ASSERT_EQ(coarsening.coarse.n_copies(), 64u);
  const Element full = make_element(full_cube_moments(), 0.1, material, {});
  const std::vector<Kind> kinds(fine.size(), Kind::partial);
  const FineElements children{[&](const std::uint32_t c) -> const Element& { return fine[c]; }, kinds, full};
  const LevelElements before = coarse_elements(coarsening, children, 0.1, material, nullptr);
  std::vector<std::uint32_t> same(fine.size());
  for (std::uint32_t c = 0; c < same.size(); ++c)
    same[c] = c;
  fine[100] = any_element();
  same[100] = CellsOfLevel::unused;
  const CoarseBefore known{same, coarsening.parent, before};
  const LevelElements after = coarse_elements(coarsening, children, 0.1, material, &known),
                      anew = coarse_elements(coarsening, children, 0.1, material, nullptr);
  EXPECT_EQ(std::count(after.same_as.begin(), after.same_as.end(), CellsOfLevel::unused), 1);
  EXPECT_EQ(after.same_as[coarsening.parent[100]], CellsOfLevel::unused);
  for (std::size_t c = 0; c < 64; ++c) {
    EXPECT_EQ(after[c].hourglass, anew[c].hourglass) << c;
    EXPECT_EQ(after[c].mode_gradient, anew[c].mode_gradient) << c;
    EXPECT_EQ(after[c].bound, anew[c].bound) << c;
    EXPECT_EQ(after[c].hourglass == before[c].hourglass, c != coarsening.parent[100]) << c;
  }
}

} // namespace
} // namespace kerf::fem::level_elements_test
