#include "tests/support/threads.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <random>
#include <stdexcept>
#include <thread>

namespace kerf::parallel_test {
namespace {

/// n items, each after `most` at most of those that come up to `far` before it.
Precedence random_precedence(const std::uint32_t n, const std::uint32_t far, const std::uint32_t most,
                             std::mt19937& random) {
  Precedence all;
  for (std::uint32_t i = 0; i < n; ++i) {
    std::vector<std::uint32_t> before;
    for (std::uint32_t k = 0; k < most && i > 0; ++k)
      before.push_back(i - 1 - static_cast<std::uint32_t>(random() % std::min(i, far)));
    all.add(before);
  }
  return all;
}

TEST(ParallelInOrder, BeginsWithAnItemWhenThoseBeforeItAreDone) {
  std::mt19937 random(1);
  for (int turn = 0; turn < 50; ++turn) {
    const Precedence items = random_precedence(1 + random() % 300, 1 + random() % 60, random() % 4, random);
    std::vector<std::atomic<int>> done(items.n());
    std::atomic<std::size_t> n_early = 0;
    const auto work = [&](const std::size_t i) {
      for (const std::uint32_t before : items.before(i))
        n_early += done[before] != 1 ? 1 : 0;
      double sum = 0;
      for (int k = 0; k < 2000; ++k)
        sum += 1.0 / (1 + k);
      done[i] += sum > 1 ? 1 : 2;
    };
    with_threads(4, [&] { parallel_in_order(items, work); });
    EXPECT_EQ(n_early, 0u);
    for (const auto& times : done)
      EXPECT_EQ(times, 1);
  }
}

/// However busy the machine is: each of two items waits for the other to begin.
TEST(ParallelInOrder, HasTwoItemsAtOnce) {
  Precedence items;
  items.add({});
  items.add({});
  std::atomic<int> n_begun = 0, n_met = 0;
  const auto meet = [&](std::size_t) {
    ++n_begun;
    const auto latest = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (n_begun < 2 && std::chrono::steady_clock::now() < latest)
      std::this_thread::yield();
    n_met += n_begun == 2 ? 1 : 0;
  };
  with_threads(4, [&] { parallel_in_order(items, meet); });
  EXPECT_EQ(n_met, 2);
}

/// Nor begins with anything more than what other threads had taken.
TEST(ParallelInOrder, HandsOnAnErrorAndHangsNobody) {
  std::mt19937 random(2);
  for (int turn = 0; turn < 20; ++turn) {
    const Precedence items = random_precedence(20000, 30, 2, random);
    std::atomic<std::size_t> n_begun = 0;
    const auto work = [&](const std::size_t i) {
      ++n_begun;
      if (i == 40)
        throw std::runtime_error("no");
    };
    with_threads(4, [&] { EXPECT_THROW(parallel_in_order(items, work), std::runtime_error); });
    EXPECT_LT(n_begun, items.n());
  }
}

TEST(Precedence, KnowsHowManyItemsCanBeWorkedOnAtOnce) {
  Precedence chain, two, alone;
  EXPECT_EQ(chain.width(), 0);
  for (std::uint32_t i = 0; i < 10; ++i) {
    chain.add(i == 0 ? std::vector<std::uint32_t>{} : std::vector{i - 1});
    two.add(i < 2 ? std::vector<std::uint32_t>{} : std::vector{i - 2});
    alone.add({});
  }
  EXPECT_EQ(chain.width(), 1);
  EXPECT_EQ(two.width(), 2);
  EXPECT_EQ(alone.width(), 10);
}

TEST(Beside, CallsBothOnceAndThemWithLoops) {
  for (const int n_threads : {1, 2, 4}) {
    std::vector<int> first(1000, 0), second(1000, 0);
    const auto count = [](std::vector<int>& times) {
      parallel_for(times.size(), [&](const std::size_t i) { ++times[i]; });
    };
    with_threads(n_threads, [&] { beside([&] { count(first); }, [&] { count(second); }); });
    EXPECT_EQ(first, std::vector<int>(1000, 1));
    EXPECT_EQ(second, std::vector<int>(1000, 1));
  }
}

TEST(Beside, HandsOnTheErrorOfEither) {
  const auto fail = [] { throw std::runtime_error("no"); };
  const auto pass = [] {};
  for (const int n_threads : {1, 4})
    with_threads(n_threads, [&] {
      EXPECT_THROW(beside(fail, pass), std::runtime_error);
      EXPECT_THROW(beside(pass, fail), std::runtime_error);
    });
}

} // namespace
} // namespace kerf::parallel_test
