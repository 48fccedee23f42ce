#include "output/stability_file.h"

#include "output/checkpoint_file.h"
#include "output/names.h"
#include "output/run_info.h"
#include "output/table_columns.h"

namespace kerf::output {

namespace {

constexpr const char* stability_rows = "/stability/rows";

/// Calls action(column) for every column, whatever its type.
template <class Action>
void for_each_stability_column(const Action& action) {
  using Row = StabilityRow;
  const Columns<Row, Action> columns{action};
  columns.text("sweep", &Row::sweep, "which of the study's");
  columns.text("variant", &Row::variant, "the way to run the scene");
  columns.text("cases", &Row::cases, "of the changes that the sweep combines");
  columns.text("changes", &Row::changes, "what was changed of the scene, separated by ' | '");
  columns.text("backend", &Row::backend, "the physics of the body");
  columns.text("integrator", &Row::integrator, "how its time advances");
  columns.number("dt", &Row::dt, "s", "time step");
  columns.text("outcome", &Row::outcome, "stable, damped out, drifted, not back, refused, stopped, or failed");
  columns.text("reason", &Row::reason, "why it was refused or stopped, or in what it failed");
  columns.number("start_energy", &Row::start_energy, "J", "kinetic and elastic, after what cuts at time 0");
  columns.number("largest_energy", &Row::largest_energy, "1", "of all steps, over that at the start");
  columns.number("last_energy", &Row::last_energy, "1", "over that at the start");
  columns.number("momentum", &Row::momentum, "1",
                 "its change, over that of all mass at the speed of the start's energy");
  columns.number("volume", &Row::volume, "1", "at the end, over that at rest");
  columns.count("steps", &Row::n_steps, "that were finished");
  columns.count("iterations", &Row::n_iterations, "of the linear solver in all steps");
  columns.count("divided", &Row::n_divided, "steps that were taken again in substeps");
  columns.number("cpu_time", &Row::cpu_seconds, "s", "of all threads in all steps");
  columns.number("predicted_step", &Row::predicted_step, "s",
                 "the integrator's stable step at the start; NaN: not asked");
  columns.number("largest_step", &Row::largest_step, "s",
                 "the longest one with which the energy at most doubles, by bisection; NaN: not asked");
}

} // namespace

void write_stability_file(const std::filesystem::path& path, const StabilityTable& table, const RunInfo& info) {
  {
    h5::WritableFile file(name_beside(path), JournaledFile::Mode::create);
    file.transaction([&] {
      const h5::Object& root = file.root();
      write_info(root, info);
      h5::set_attribute(root, "title", table.title);
      h5::set_attribute(root, "outcome", to_string(table.outcome));
      h5::set_attribute(root, "made_of", table.made_of);
      h5::create_group(root, "/stability");
      h5::write_text(root, "/stability/text", table.text);
      h5::create_group(root, stability_rows);
      for_each_stability_column([&](const auto& column) { write_column(root, stability_rows, column, table.rows); });
    });
  }
  take_name(path);
}

StabilityTable read_stability_file(const std::filesystem::path& path) {
  const h5::Object root = h5::open_read_only(path);
  StabilityTable table{h5::text_attribute(root, "title"),
                       h5::read_text(root, "/stability/text"),
                       read_outcome(root),
                       {},
                       h5::text_attribute(root, "made_of")};
  table.rows.resize(h5::n_rows(h5::open_dataset(root, column_path(stability_rows, "dt"))));
  for_each_stability_column([&](const auto& column) { read_column(root, stability_rows, column, table.rows); });
  return table;
}

} // namespace kerf::output
