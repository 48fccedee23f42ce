#include "base/id.h"
#include "base/parallel.h"
#include "base/timer.h"
#include "base/parallel.h"
#include "base/shared_union_find.h"
#include "base/union_find.h"
#include "base/vec.h"

#include <gtest/gtest.h>

#include <cmath>
#include <type_traits>

namespace kerf::containers_test {
namespace {

using AppleId = Id<struct AppleTag>;
using PearId = Id<struct PearTag>;

static_assert(!std::is_convertible_v<AppleId, PearId> && !std::is_constructible_v<PearId, AppleId>);
static_assert(!std::is_convertible_v<int, AppleId>);

TEST(Id, IsInvalidUntilGiven) {
  EXPECT_FALSE(AppleId().valid());
  EXPECT_TRUE(AppleId(0).valid());
  EXPECT_LT(AppleId(1), AppleId(2));
  EXPECT_EQ(AppleId(7), AppleId(7));
}

TEST(Table, IsIndexedByItsKey) {
  Table<AppleId, double> weight(2, 0.5);
  const AppleId third = weight.push_back(3);
  EXPECT_EQ(third, AppleId(2));
  EXPECT_EQ(weight[AppleId(1)], 0.5);
  EXPECT_EQ(weight[third], 3);
  double sum = 0;
  for (const auto apple : ids<AppleId>(weight.size()))
    sum += weight[apple];
  EXPECT_EQ(sum, 4);
}

TEST(ParallelFor, GivesTheSameForAnyNumberOfThreads) {
  const int before = n_threads();
  std::vector<std::vector<double>> results;
  for (const int n : {1, 2, 3}) {
    set_n_threads(n);
    EXPECT_EQ(n_threads(), n);
    std::vector<double> roots(1001);
    parallel_for(roots.size(), [&](const std::size_t i) { roots[i] = std::sqrt(static_cast<double>(i)); });
    results.push_back(roots);
  }
  set_n_threads(before);
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
  EXPECT_EQ(results[0][100], 10);
}

TEST(ScopedTimer, AddsToItsStage) {
  Timings timings{{"cut", 5}};
  { const ScopedTimer timer(timings, "cut"); }
  EXPECT_GE(timings["cut"], 5);
  EXPECT_LT(timings["cut"], 6);
  EXPECT_EQ(timings.size(), 1u);
}

TEST(UnionFind, NumbersSetsByTheirSmallestMember) {
  for (const bool reversed : {false, true}) {
    UnionFind sets(6);
    const std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs = {{4, 1}, {5, 3}, {3, 1}};
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const auto [a, b] = pairs[reversed ? pairs.size() - 1 - i : i];
      sets.unite(a, b);
    }
    EXPECT_EQ(sets.root(5), 1u);
    std::vector<std::uint32_t> set_of;
    EXPECT_EQ(sets.number(set_of), 3u);
    EXPECT_EQ(set_of, std::vector<std::uint32_t>({0, 1, 2, 1, 1, 1}));
  }
}

/// Whatever threads unite, sets are the same, and so are their numbers; those who do not count have none.
TEST(UnionFind, IsTheSameWhenThreadsShareIt) {
  constexpr std::uint32_t n = 50000, none = 0xffffffff;
  const auto partner = [](const std::uint32_t i) { return i * 2654435761u % n / 7 * 7 + i % 7; };
  const auto counts = [](const std::uint32_t i) { return i % 7 != 3; };
  UnionFind alone(n);
  for (std::uint32_t i = 0; i < n; ++i)
    if (partner(i) < n)
      alone.unite(i, partner(i));
  std::vector<std::uint32_t> expected, number(n, none), set_of;
  alone.number(expected);
  std::uint32_t n_counted = 0;
  for (std::uint32_t i = 0; i < n; ++i)
    if (counts(i))
      number[i] = alone.root(i) == i ? n_counted++ : number[alone.root(i)];
  for (const int threads : {1, 2, 4}) {
    set_n_threads(threads);
    SharedUnionFind shared(n);
    parallel_for(n, [&](const std::size_t i) {
      if (const auto c = static_cast<std::uint32_t>(i); partner(c) < n)
        shared.unite(c, partner(c));
    });
    shared.number(set_of);
    EXPECT_EQ(set_of, expected) << threads;
    EXPECT_EQ(shared.number(set_of, none, counts), n_counted);
    EXPECT_EQ(set_of, number) << threads;
  }
}

TEST(Box, IsClosed) {
  const Box box{Vec3(0, 0, 0), Vec3(1, 2, 3)};
  EXPECT_TRUE(box.contains({1, 2, 3}));
  EXPECT_FALSE(box.contains({1, 2, 3.1}));
  EXPECT_TRUE(Box().contains({1e9, 0, 0}));
}

} // namespace
} // namespace kerf::containers_test
