#include "base/fingerprint.h"
#include "base/loan.h"
#include "base/parallel.h"

#include <gtest/gtest.h>

#include <cstring>
#include <set>

namespace kerf::loan_test {
namespace {

TEST(Loan, IsOfTheSmallestMemoryThatIsLargeEnough) {
  struct Item {
    double value;
  };
  { const Loan<Item> small(10, Item{}), large(1000, Item{}), middle(100, Item{}); }
  const auto room_of = [](const std::size_t n) { return Loan<Item>(n, Item{})->capacity(); };
  EXPECT_EQ(room_of(50), 100u);
  EXPECT_EQ(room_of(5), 10u);
  EXPECT_EQ(room_of(500), 1000u);
  EXPECT_EQ(room_of(2000), 2000u); // in place of the largest
  const Loan<Item> first(50, Item{}), second(50, Item{}), third(50, Item{});
  EXPECT_EQ(first->capacity(), 100u);
  EXPECT_EQ(second->capacity(), 2000u);
  EXPECT_EQ(third->capacity(), 50u); // in place of the one for ten
}

TEST(Loan, OfNoneTakesNoMemory) {
  struct Item {
    double value;
  };
  { const Loan<Item> one(10, Item{}); }
  const Loan<Item> none = Loan<Item>::none();
  EXPECT_EQ(none->capacity(), 0u);
  EXPECT_EQ(Loan<Item>()->capacity(), 10u);
}

TEST(Loan, WithRoomIsEmpty) {
  struct Item {
    double value;
  };
  { const Loan<Item> one(10, Item{1}); }
  const Loan<Item> again = Loan<Item>::with_room(7);
  EXPECT_TRUE(again.empty());
  EXPECT_EQ(again->capacity(), 10u);
}

TEST(Fingerprint, TellsEveryBit) {
  Points points(3, Vec3(0.5, -1, 2));
  std::set<std::uint64_t> seen = {fingerprint(points), fingerprint({})};
  for (Vec3& p : points)
    for (int k = 0; k < 3; ++k)
      for (int bit = 0; bit < 64; ++bit) {
        const double before = p[k];
        std::uint64_t bits;
        std::memcpy(&bits, &before, sizeof bits);
        bits ^= std::uint64_t(1) << bit;
        std::memcpy(&p[k], &bits, sizeof bits);
        seen.insert(fingerprint(points));
        p[k] = before;
      }
  EXPECT_EQ(seen.size(), 2u + 3 * 3 * 64);
}

TEST(Fingerprint, TellsOrderAndNumber) {
  const Vec3 a(1, 2, 3), b(4, 5, 6), zero = Vec3::Zero();
  EXPECT_NE(fingerprint({a, b}), fingerprint({b, a}));
  EXPECT_NE(fingerprint({a, b}), fingerprint({a}));
  EXPECT_NE(fingerprint({a, zero}), fingerprint({a}));
  EXPECT_NE(fingerprint({zero}), fingerprint({zero, zero}));
  EXPECT_EQ(fingerprint({a, b}), fingerprint({a, b}));
}

TEST(Fingerprint, IsTheSameForAnyNumberOfThreads) {
  Points points;
  for (int i = 0; i < 20000; ++i)
    points.emplace_back(i, 0.1 * i, -i);
  const int n = n_threads();
  set_n_threads(1);
  const std::uint64_t one = fingerprint(points);
  set_n_threads(2);
  EXPECT_EQ(fingerprint(points), one);
  set_n_threads(n);
  std::swap(points[3], points[15000]); // of two parts
  EXPECT_NE(fingerprint(points), one);
}

} // namespace
} // namespace kerf::loan_test
