// `kerf bench`: how fast each hot path is on this machine, over the size of a body, and against an earlier time.

#include "commands.h"
#include "run_info.h"

#include "base/error.h"
#include "base/parallel.h"
#include "base/parameters.h"
#include "bench/compare.h"
#include "bench/paths.h"
#include "output/results_folder.h"

#include <charconv>
#include <cstdio>
#include <optional>

namespace kerf::apps {

namespace {

struct BenchArguments {
  bench::Options options;
  int n_threads = 1;
  std::filesystem::path output = "results/bench";
  std::string against = {};
  output::Earlier earlier = output::Earlier::refuse;
};

[[noreturn]] void refuse(const std::string& option, const std::string& value, const std::string& rule,
                         const std::string& remedy) {
  throw ParameterError(Complaint{.path = option, .value = value, .rule = rule, .remedy = remedy});
}

double number_in(const std::string& option, const std::string& value, const double least, const double most) {
  double number = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  if (error != std::errc() || end != value.data() + value.size() || !(number >= least && number <= most))
    refuse(option, value, "must be a number from " + to_text(least) + " to " + to_text(most), "Write one");
  return number;
}

void require_path(const std::string& only) {
  std::string names;
  for (const std::string& name : bench::names_of_paths()) {
    if (name.find(only) != std::string::npos)
      return;
    names += (names.empty() ? "'" : ", '") + name + "'";
  }
  refuse("--only", only, "is in the name of no path", "There are " + names);
}

void read_option(const std::string& option, const std::string& value, BenchArguments& parsed) {
  if (option == "--only") {
    require_path(value);
    parsed.options.only = value;
  } else if (option == "--largest")
    parsed.options.largest = number_in(option, value, 216, 1e6);
  else if (option == "--samples")
    parsed.options.n_samples = static_cast<int>(number_in(option, value, 1, 1000));
  else if (option == "--threads")
    parsed.n_threads = static_cast<int>(number_in(option, value, 1, 1024));
  else if (option == "--output" && value.empty())
    refuse(option, "", "must name a folder", "Leave it out for results/bench");
  else if (option == "--output")
    parsed.output = value;
  else if (option == "--against")
    parsed.against = value;
  else
    refuse("", option, "is no option", "See kerf bench --help");
}

BenchArguments parse(const Arguments& arguments) {
  BenchArguments parsed;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] == "--force") {
      parsed.earlier = output::Earlier::replace;
      continue;
    }
    if (i + 1 == arguments.size())
      refuse(arguments[i], "", arguments[i].starts_with("--") ? "needs one value after it" : "is no option",
             "See kerf bench --help");
    read_option(arguments[i], arguments[i + 1], parsed);
    ++i;
  }
  return parsed;
}

void print(const bench::Comparison& comparison, const output::BenchTable& now, const output::BenchTable& before,
           const std::string& file) {
  std::printf("\nagainst %s: %zu of its %zu rows compared", file.c_str(), comparison.n_compared, before.rows.size());
  if (now.n_threads != before.n_threads)
    std::printf(", which were measured on %lld threads", static_cast<long long>(before.n_threads));
  std::printf("; %zu are slower by more than 10 %% and than their samples spread\n", comparison.fallen.size());
  for (const std::string& line : comparison.fallen)
    std::printf("slower: %s\n", line.c_str());
  for (const std::string& line : comparison.missing)
    std::printf("not measured now: %s\n", line.c_str());
}

} // namespace

int bench(const Arguments& arguments) {
  const BenchArguments parsed = parse(arguments);
  set_n_threads(parsed.n_threads);
  std::optional<output::BenchTable> before;
  if (!parsed.against.empty())
    before = output::read_bench_file(parsed.against);
  const output::ResultsFolder folder(parsed.output, parsed.earlier, {"bench.h5", "bench.csv"});
  const bench::Machine machine = bench::measure_machine();
  std::printf("%d threads: %.3g additions and multiplications a second, %.3g bytes a second from and to memory\n%s\n",
              n_threads(), machine.flops, machine.bandwidth, bench::heading().c_str());
  output::BenchTable table{n_threads(), machine.flops, machine.bandwidth};
  table.rows = bench::measure_paths(parsed.options, machine, [](const output::BenchRow& row) {
    std::printf("%s\n", bench::line_of(row).c_str());
    std::fflush(stdout);
  });
  output::write_bench_file(folder.path() / "bench.h5", table, run_info("bench", arguments));
  output::write_bench_csv(folder.path() / "bench.csv", table);
  constexpr double allowed = 0.1;
  if (before)
    print(bench::compare(table, *before, allowed), table, *before, parsed.against);
  std::printf("results in %s\n", folder.path().c_str());
  return 0;
}

} // namespace kerf::apps
