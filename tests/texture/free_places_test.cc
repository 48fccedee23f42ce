#include "texture/free_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace kerf::texture::free_places_test {
namespace {

TEST(FreePlaces, AreTakenBeforeNewOnes) {
  FreePlaces places;
  EXPECT_EQ(places.take(10), 0u);
  EXPECT_EQ(places.take(3), 10u);
  EXPECT_EQ(places.take(5), 13u);
  EXPECT_EQ(places.take(6), 18u);
  EXPECT_EQ(places.take(1), 24u);
  places.give_back(0, 10);
  places.give_back(13, 5);
  EXPECT_EQ(places.take(4), 13u); // the shortest run with room
  EXPECT_EQ(places.take(1), 17u); // what was left of it
  places.give_back(10, 3);        // one run with those before
  EXPECT_EQ(places.take(13), 0u);
  EXPECT_EQ(places.end(), 25u);
  places.give_back(18, 6);
  places.give_back(24, 1); // the end comes back
  EXPECT_EQ(places.end(), 18u);
  EXPECT_EQ(places.take(2), 18u);
}

/// Of places that are free or not, where the next n are taken.
std::size_t first_for(const std::size_t n, const std::vector<bool>& is_taken) {
  std::size_t best = is_taken.size(), length = is_taken.size() + 1;
  for (std::size_t at = 0; at < is_taken.size(); ++at) {
    std::size_t end = at;
    while (end < is_taken.size() && !is_taken[end])
      ++end;
    if (end - at >= n && end - at < length) {
      best = at;
      length = end - at;
    }
    at = end;
  }
  return best;
}

/// Random ones against a list of all; those read back from an archive go on in the same way.
TEST(FreePlaces, AreThoseThatNothingLiesIn) {
  std::mt19937 random(11);
  FreePlaces places;
  std::vector<bool> is_taken; // up to the end
  std::vector<std::pair<std::size_t, std::size_t>> things;
  for (int i = 0; i < 5000; ++i) {
    if (const bool gives_back = random() % 100 < (i % 1000 < 500 ? 45 : 55); gives_back && !things.empty()) {
      std::swap(things[random() % things.size()], things.back());
      const auto [first, n] = things.back();
      things.pop_back();
      places.give_back(first, n);
      std::fill_n(is_taken.begin() + static_cast<std::ptrdiff_t>(first), n, false);
      while (!is_taken.empty() && !is_taken.back())
        is_taken.pop_back();
    } else {
      const std::size_t n = 1 + random() % 20, wanted = first_for(n, is_taken), first = places.take(n);
      ASSERT_EQ(first, wanted) << i;
      is_taken.resize(std::max(is_taken.size(), first + n));
      std::fill_n(is_taken.begin() + static_cast<std::ptrdiff_t>(first), n, true);
      things.emplace_back(first, n);
    }
    ASSERT_EQ(places.end(), is_taken.size()) << i;
    if (i % 100 == 0) {
      Archive archive;
      archive(places);
      Archive back(archive.bytes(), "test");
      places = {};
      back(places);
      EXPECT_EQ(back.n_left(), 0u);
    }
  }
}

} // namespace
} // namespace kerf::texture::free_places_test
