#include "output/bench_file.h"

#include "output/checkpoint_file.h"
#include "output/csv_file.h"
#include "output/names.h"
#include "output/run_info.h"

namespace kerf::output {

namespace {

constexpr const char* bench_rows = "/bench/rows";

/// Calls action(column) for every column, whatever its type.
template <class Action>
void for_each_bench_column(const Action& action) {
  using Row = BenchRow;
  const Columns<Row, Action> columns{action};
  columns.text("path", &Row::path, "what is measured");
  columns.text("item", &Row::item, "what is counted");
  columns.count("cells", &Row::cells, "of the body");
  columns.count("n", &Row::n, "items that a call works on");
  columns.number("seconds", &Row::seconds, "s", "of a call on the clock, median of the repetitions");
  columns.number("spread", &Row::spread, "1", "between the quartiles of the repetitions, over the median");
  columns.number("rate", &Row::rate, "1/s", "items a second");
  columns.number("of_peak", &Row::of_peak, "1", "operations needed, over what the machine does; NaN: not counted");
  columns.number("of_bandwidth", &Row::of_bandwidth, "1", "bytes needed, over what it moves; NaN: not counted");
}

} // namespace

void write_bench_file(const std::filesystem::path& path, const BenchTable& table, const RunInfo& info) {
  {
    h5::WritableFile file(name_beside(path), JournaledFile::Mode::create);
    file.transaction([&] {
      const h5::Object& root = file.root();
      write_info(root, info);
      h5::set_attribute(root, "outcome", to_string(Outcome::completed));
      const h5::Object bench = h5::create_group(root, "/bench");
      h5::set_attribute(bench, "threads", table.n_threads);
      h5::set_attribute(bench, "peak_flops", table.peak_flops);
      h5::set_attribute(bench, "bandwidth", table.bandwidth);
      h5::create_group(root, bench_rows);
      for_each_bench_column([&](const auto& column) { write_column(root, bench_rows, column, table.rows); });
    });
  }
  take_name(path);
}

void write_bench_csv(const std::filesystem::path& path, const BenchTable& table) {
  CsvTable csv(table.rows.size());
  for_each_bench_column([&](const auto& column) { csv.add(column.name, column, table.rows); });
  csv.write(path);
}

BenchTable read_bench_file(const std::filesystem::path& path) {
  const h5::Object root = h5::open_read_only(path);
  const h5::Object bench = h5::open_group(root, "/bench");
  BenchTable table{h5::integer_attribute(bench, "threads"), h5::number_attribute(bench, "peak_flops"),
                   h5::number_attribute(bench, "bandwidth")};
  table.rows.resize(h5::n_rows(h5::open_dataset(root, column_path(bench_rows, "seconds"))));
  for_each_bench_column([&](const auto& column) { read_column(root, bench_rows, column, table.rows); });
  return table;
}

} // namespace kerf::output
