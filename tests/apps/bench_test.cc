// `kerf bench`: what it writes, what it names against an earlier file, what it refuses. How fast is nobody's to assert.

#include "bench/compare.h"
#include "bench/paths.h"
#include "output/bench_file.h"
#include "output/reader.h"
#include "tests/apps/program.h"
#include "tests/output/samples.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

namespace kerf::apps::bench_test {
namespace {

class Bench : public Program {
 protected:
  Result bench(const Words& more) const {
    Words words = {"bench", "--largest", "300", "--samples", "2", "--force"};
    words.insert(words.end(), more.begin(), more.end());
    return kerf(words);
  }
};

TEST_F(Bench, MeasuresEveryPath) {
  const Result result = bench({"--output", "out"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const output::BenchTable table = output::read_bench_file(folder / "out/bench.h5");
  EXPECT_GT(table.peak_flops, 1e8);
  EXPECT_GT(table.bandwidth, 1e8);
  std::set<std::string> names, not_counted;
  for (const output::BenchRow& row : table.rows) {
    names.insert(row.path);
    EXPECT_EQ(row.cells, 216) << row.path;
    EXPECT_GT(row.n, 0) << row.path;
    EXPECT_GT(row.seconds, 0) << row.path;
    EXPECT_NEAR(row.rate, double(row.n) / row.seconds, 1e-9 * row.rate) << row.path;
    EXPECT_NE(result.out.find(row.path), std::string::npos);
    if (!std::isnan(row.of_bandwidth)) {
      EXPECT_LT(row.of_bandwidth, 100) << row.path << ": does nothing";
    }
    if (row.path == "stiffness product, elements") {
      EXPECT_EQ(row.n, 216);
    }
    if (std::isnan(row.of_peak)) {
      not_counted.insert(row.path);
    } else {
      EXPECT_GT(row.of_peak, 0) << row.path;
      EXPECT_LT(row.of_peak, 1) << row.path;
    }
  }
  EXPECT_EQ(not_counted,
            (std::set<std::string>{"multigrid takes an equation", "explicit step, points",
                                   "shape matching step, half width 4", "implicit step, springs",
                                   "implicit step, points", "composing a body", "cutting, with all that follows",
                                   "cutting points, with all that follows", "visibility of points that are cut",
                                   "equilibrium, elements", "six modes, elements", "surface of a body",
                                   "a frame of run.h5", "an image", "colours of the inside"}));
  EXPECT_FALSE(std::filesystem::exists(folder / "cache")); // of warps, which lies beside a scene
  const auto all = bench::names_of_paths();
  EXPECT_EQ(names, std::set<std::string>(all.begin(), all.end()));
  const std::string csv = read_text(folder / "out/bench.csv");
  EXPECT_TRUE(csv.starts_with("path,item,cells,n,seconds,spread,rate,of_peak,of_bandwidth\n")) << csv;
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), static_cast<std::ptrdiff_t>(table.rows.size() + 1));
}

TEST_F(Bench, NamesWhatIsSlowerThanInAnEarlierFile) {
  ASSERT_EQ(bench({"--only", "energy", "--output", "out"}).exit_code, 0);
  output::BenchTable before = output::read_bench_file(folder / "out/bench.h5");
  ASSERT_EQ(before.rows.size(), 1u);
  const double rate = before.rows[0].rate;
  before.rows[0].rate = 1000 * rate;
  output::write_bench_file(folder / "faster.h5", before, output::sample_info());
  const Result slower = bench({"--only", "energy", "--output", "out", "--against", "faster.h5"});
  EXPECT_EQ(slower.exit_code, 0);
  EXPECT_NE(slower.out.find("slower: energy, elements, 216 cells: "), std::string::npos) << slower.out;
  before.rows[0].rate = rate / 1000;
  output::write_bench_file(folder / "slower.h5", before, output::sample_info());
  const Result faster = bench({"--only", "energy", "--output", "out", "--against", "slower.h5"});
  EXPECT_NE(faster.out.find("1 of its 1 rows compared; 0 are slower"), std::string::npos) << faster.out;
  before.rows[0].rate = 1000 * rate;
  before.rows[0].spread = 1;
  before.rows.push_back(before.rows[0]);
  before.rows[1].cells = 1000;
  output::write_bench_file(folder / "noisy.h5", before, output::sample_info());
  const Result noisy = bench({"--only", "energy", "--output", "out", "--against", "noisy.h5"});
  EXPECT_NE(noisy.out.find("1 of its 2 rows compared; 0 are slower"), std::string::npos) << noisy.out;
  EXPECT_NE(noisy.out.find("not measured now: energy, elements, 1000 cells"), std::string::npos) << noisy.out;
}

/// More than a tenth, that is; or more than samples of one row differ by.
TEST(Comparison, NamesWhatHasLostMoreThanIsAllowed) {
  for (const auto& [rate, spread, is_named] :
       {std::tuple(0.91, 0.0, false), std::tuple(0.88, 0.0, true), std::tuple(0.88, 0.2, false)}) {
    output::BenchTable before, now;
    before.rows = {{.path = "a path", .item = "items", .cells = 8, .n = 8, .seconds = 1, .spread = spread, .rate = 8}};
    now.rows = before.rows;
    now.rows[0].rate *= rate;
    EXPECT_EQ(bench::compare(now, before, 0.1).fallen.size(), is_named ? 1u : 0u) << rate << " " << spread;
  }
}

TEST_F(Bench, WhatCannotBeIsRefused) {
  expect_error(kerf({"bench", "--largest", "10"}), 1, {"--largest = '10'", "216"});
  expect_error(kerf({"bench", "--samples", "many"}), 1, {"--samples = 'many'", "number"});
  expect_error(kerf({"bench", "--only", "sorting"}), 1, {"--only = 'sorting'", "no path", "'surface follows'"});
  expect_error(kerf({"bench", "--against", "nothing.h5"}), 2, {"nothing.h5"});
  expect_error(kerf({"bench", "--fast", "1"}), 1, {"--fast", "no option"});
  expect_error(kerf({"bench", "--threads"}), 1, {"--threads", "needs one value"});
  std::filesystem::create_directory(folder / "out");
  write("out/bench.h5", "the user's");
  expect_error(kerf({"bench", "--output", "out", "--only", "energy"}), 2, {"out/bench.h5", "not known to be Kerf's"});
}

} // namespace
} // namespace kerf::apps::bench_test
