#include "output/journaled_file.h"

#include "base/error.h"
#include "tests/output/child.h"
#include "tests/output/samples.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <random>

namespace kerf::output::journaled_file_test {
namespace {

constexpr auto page = JournaledFile::page_size;

std::vector<std::byte> filled(const std::size_t n, const int value) {
  return std::vector<std::byte>(n, static_cast<std::byte>(value));
}

std::vector<std::byte> on_disk(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

std::vector<std::byte> seen_by(const JournaledFile& file, const std::size_t n) {
  std::vector<std::byte> bytes(n);
  file.read(0, bytes);
  return bytes;
}

TEST(JournaledFile, ReadsBackWhatIsNotYetCommitted) {
  const TemporaryFolder folder;
  JournaledFile file(folder / "a", JournaledFile::Mode::create);
  file.write(0, filled(10, 1));
  file.commit(10);
  file.write(5, filled(2 * page, 2)); // from below the committed end to far above it
  auto expected = filled(5 + 2 * page, 2);
  std::fill_n(expected.begin(), 5, std::byte{1});
  EXPECT_EQ(seen_by(file, expected.size()), expected);
  file.commit(file.size());
  EXPECT_EQ(seen_by(file, expected.size()), expected);
}

TEST(JournaledFile, WhatIsCommittedStaysUntilTheNextCommit) {
  const TemporaryFolder folder;
  const auto before = filled(3 * page + 17, 1);
  {
    JournaledFile file(folder / "a", JournaledFile::Mode::create);
    file.write(0, before);
    file.commit(before.size());
    file.write(0, filled(before.size() + 5 * page, 2));
    const auto now = on_disk(folder / "a");
    ASSERT_GE(now.size(), before.size());
    EXPECT_TRUE(std::equal(before.begin(), before.end(), now.begin()));
  }
  EXPECT_EQ(on_disk(folder / "a"), before); // the rest was never committed
}

TEST(JournaledFile, GrowsAndShrinks) {
  const TemporaryFolder folder;
  int value = 0;
  auto mode = JournaledFile::Mode::create;
  for (const std::size_t n : {4 * page, page + 3, 9 * page + 1}) {
    {
      JournaledFile file(folder / "a", mode);
      for (int i = 0; i < 3; ++i) {
        file.write(0, filled(n, ++value));
        file.commit(n);
      }
      EXPECT_EQ(seen_by(file, n), filled(n, value));
    }
    EXPECT_EQ(on_disk(folder / "a"), filled(n, value)); // no journal is left
    mode = JournaledFile::Mode::modify;
  }
}

TEST(JournaledFile, TakesNoMoreOnceAbandoned) {
  const TemporaryFolder folder;
  JournaledFile file(folder / "a", JournaledFile::Mode::create);
  file.write(0, filled(page, 1));
  file.commit(page);
  file.write(0, filled(2 * page, 2));
  file.abandon("because");
  EXPECT_EQ(seen_by(file, 2 * page), filled(2 * page, 2));
  try {
    file.commit(2 * page);
    FAIL() << "an abandoned file was committed";
  } catch (const DataError& error) {
    EXPECT_STREQ(error.what(), "because");
  }
}

TEST(JournaledFile, HasOneWriter) {
  const TemporaryFolder folder;
  const JournaledFile file(folder / "a", JournaledFile::Mode::create);
  EXPECT_THROW(JournaledFile(folder / "a", JournaledFile::Mode::create), DataError);
  EXPECT_THROW(JournaledFile(folder / "a", JournaledFile::Mode::modify), DataError);
}

TEST(JournaledFile, RecoveryLeavesAnyOtherFileAlone) {
  const TemporaryFolder folder;
  std::mt19937 random(5);
  for (const std::size_t n : {0, 1, 31, 32, 33, 5000, 20000}) {
    auto bytes = filled(n, 0);
    for (auto& byte : bytes)
      byte = static_cast<std::byte>(random());
    std::ofstream(folder / "a", std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), n);
    recover(folder / "a");
    EXPECT_EQ(on_disk(folder / "a"), bytes);
  }
  EXPECT_THROW(recover(folder / "missing"), DataError);
}

/// Every commit fills a file with its own number, and is reported.
void fill_for_ever(const std::filesystem::path& path, const std::size_t n_bytes, const Report& report) {
  JournaledFile file(path, JournaledFile::Mode::create);
  for (std::uint32_t i = 1;; ++i) {
    file.write(0, filled(n_bytes, static_cast<int>(i % 256)));
    file.commit(n_bytes);
    report.send(i);
  }
}

/// Kills until three of them fell into the copying of pages, after which one number must still be everywhere.
TEST(JournaledFile, CommitsAllOrNothingUnderKills) {
  const TemporaryFolder folder;
  const auto path = folder / "a";
  std::mt19937 random(1);
  constexpr std::size_t n_bytes = 300 * page + 100;
  int n_repaired = 0;
  for (int run = 0; run < 1000 && n_repaired < 3; ++run) {
    Child child([&](Report& report) { fill_for_ever(path, n_bytes, report); });
    ASSERT_EQ(child.receive(), 1u);
    const auto start = std::chrono::steady_clock::now();
    ASSERT_EQ(child.receive(), 2u);
    const auto commit = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start);
    child.kill_after(commit * (random() % 1000) / 1000);

    const auto size_before = std::filesystem::file_size(path);
    recover(path);
    n_repaired += std::filesystem::file_size(path) != size_before; // it cuts the journal off
    const JournaledFile file(path, JournaledFile::Mode::modify);
    const auto bytes = seen_by(file, n_bytes);
    ASSERT_EQ(bytes, filled(n_bytes, static_cast<int>(bytes[0]))) << "run " << run;
  }
  EXPECT_EQ(n_repaired, 3);
}

} // namespace
} // namespace kerf::output::journaled_file_test
