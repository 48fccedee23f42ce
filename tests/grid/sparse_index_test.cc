#include "grid/sparse_index.h"

#include "tests/support/bodies.h"

#include <gtest/gtest.h>

#include <map>

namespace kerf::grid::sparse_index_test {
namespace {

using Key = Id<struct KeyTag>;
using support::Random;

TEST(SparseIndex, IsAMapWithADefault) {
  Random random(4);
  for (const std::size_t n : {1, 15, 16, 17, 1000}) {
    SparseIndex<Key> index(n);
    std::map<std::size_t, std::uint32_t> plain;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t key = random() % n;
      index.at(Key(key)) = plain[key] = static_cast<std::uint32_t>(random());
    }
    for (std::size_t key = 0; key < n; ++key) {
      const auto found = plain.find(key);
      ASSERT_EQ(index[Key(key)], found == plain.end() ? SparseIndex<Key>::none : found->second);
    }
  }
}

TEST(SparseIndex, TakesRoomForGroupsThatHoldSomething) {
  SparseIndex<Key> index(16000);
  const std::size_t empty = index.n_bytes();
  EXPECT_LE(empty, 16000u / 4);
  for (std::size_t key = 320; key < 336; ++key)
    index.at(Key(key)) = 7;
  EXPECT_EQ(index.n_bytes(), empty + 16 * sizeof(std::uint32_t));
}

} // namespace
} // namespace kerf::grid::sparse_index_test
