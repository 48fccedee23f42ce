// What goes into an archive comes out bit by bit; bytes that are cut short or of another kind are refused.

#include "base/archive.h"
#include "base/vec.h"

#include <gtest/gtest.h>

#include <limits>

namespace kerf::archive_test {
namespace {

using ThingId = Id<struct ThingTag>;

struct Part {
  double number = 0;
  std::vector<ThingId> ids;
  bool operator==(const Part&) const = default;
  void archive(Archive& a) { a(number, ids); }
};

struct Whole {
  Points points;
  std::deque<Part> queue;
  std::map<std::string, Points> by_name;
  std::set<ThingId> set;
  std::unordered_map<std::uint64_t, std::uint32_t> hashed;
  std::optional<Part> there, not_there;
  std::array<Part, 2> pair;
  Table<ThingId, std::uint16_t> table;
  bool flag = false;
  bool operator==(const Whole&) const = default;
  void archive(Archive& a) {
    a.name("whole");
    a(points, queue, by_name, set, hashed, there, not_there, pair, table.items(), flag);
  }
};

bool same_bits(Whole a, Whole b) {
  Archive first, second;
  first(a);
  second(b);
  return first.bytes() == second.bytes();
}

Whole sample() {
  Whole w;
  w.points = {{1, -0.0, 1e-310}, {std::numeric_limits<double>::infinity(), 2, 3}};
  w.queue = {{1.5, {ThingId(3), ThingId()}}, {2.5, {}}};
  w.by_name["acceleration"] = w.points;
  w.set = {ThingId(7), ThingId(2)};
  for (std::uint32_t i = 0; i < 100; ++i)
    w.hashed[i * 0x9e3779b97f4a7c15u] = i;
  w.there = Part{4, {ThingId(1)}};
  w.pair[1].number = 5;
  w.table.items() = {1, 2, 3};
  w.flag = true;
  return w;
}

TEST(Archive, GivesBackEveryBit) {
  Whole before = sample(), after;
  after.not_there = Part{1, {}};
  Archive writes;
  writes(before);
  Archive reads(writes.bytes(), "bytes");
  reads(after);
  EXPECT_EQ(reads.n_left(), 0u);
  EXPECT_TRUE(same_bits(before, after));
  EXPECT_EQ(after.set, before.set);
  EXPECT_EQ(after.hashed, before.hashed);
  EXPECT_FALSE(after.not_there);
  EXPECT_TRUE(std::signbit(after.points[0][1]));
  after.queue[0].ids[0] = ThingId(4);
  EXPECT_FALSE(same_bits(before, after));
}

TEST(Archive, RefusesWhatEndsTooEarly) {
  Whole whole = sample();
  Archive writes;
  writes(whole);
  for (std::size_t n = 0; n < writes.bytes().size(); ++n) {
    Archive reads({writes.bytes().begin(), writes.bytes().begin() + static_cast<std::ptrdiff_t>(n)}, "bytes");
    Whole back;
    EXPECT_THROW(reads(back), DataError) << n;
  }
}

TEST(Archive, RefusesAnotherName) {
  Archive writes;
  writes.name("half");
  Archive reads(writes.bytes(), "FILE");
  try {
    reads.name("whole");
    FAIL();
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("FILE: cannot be read back: 'whole' was expected"), std::string::npos)
      << error.what();
  }
}

} // namespace
} // namespace kerf::archive_test
