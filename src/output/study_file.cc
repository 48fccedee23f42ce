#include "output/study_file.h"

#include "base/error.h"
#include "output/checkpoint_file.h"
#include "output/names.h"
#include "output/run_info.h"
#include "output/table_columns.h"

namespace kerf::output {
namespace {

constexpr const char* group = "/study/rows";

/// Calls action(column) for every column, whatever its type; `unit` of the answer.
template <class Action>
void for_each_column(const std::string& unit, const Action& action) {
  const Columns<StudyRow, Action> columns{action};
  columns.text("name", &StudyRow::name, "variant and cases of the row");
  columns.text("family", &StudyRow::family, "the same in rows between which orders of convergence are told");
  columns.text("changes", &StudyRow::changes, "what was changed of the scene, separated by ' | '");
  columns.text("backend", &StudyRow::backend, "the physics of the body that is asked");
  columns.text("integrator", &StudyRow::integrator, "how its time advances");
  columns.number("h", &StudyRow::h, "m", "edge of the grid's cubes");
  columns.number("dt", &StudyRow::dt, "s", "time step");
  columns.count("dof", &StudyRow::n_dof, "coordinates of the particles of all bodies at the end, held ones included");
  columns.count("steps", &StudyRow::n_steps, "time steps that were finished");
  columns.count("iterations", &StudyRow::n_iterations, "of the linear solver in all steps of the body that is asked");
  columns.number("value", &StudyRow::value, unit, "the answer");
  columns.number("reference", &StudyRow::reference, unit, "what the answer should be");
  columns.text("reference_source", &StudyRow::reference_source, "where the reference comes from");
  columns.number("error", &StudyRow::error, "1", "value over reference less one");
  columns.number("order", &StudyRow::order, "1",
                 "order of convergence in h, from the errors of this row and of the row of its family before it");
  columns.number("setup_time", &StudyRow::setup_seconds, "s", "wall-clock time of composing");
  columns.number("stepping_time", &StudyRow::stepping_seconds, "s",
                 "wall-clock time of all steps, without writing files");
  columns.number(
    "cpu_time", &StudyRow::cpu_seconds, "s",
    "of all threads in all steps, writing the series included: hardly depends on what else the machine does");
  columns.number("peak_memory", &StudyRow::peak_memory, "byte",
                 "most memory in RAM during the row, beyond what the process had before it");
  columns.text("outcome", &StudyRow::outcome, "completed, or failed: why");
}

void write_rows(const h5::Object& root, const StudyTable& table) {
  h5::set_attribute(h5::create_group(root, group), "answer", table.answer);
  for_each_column(table.unit, [&](const auto& column) { write_column(root, group, column, table.rows); });
}

} // namespace

void write_study_file(const std::filesystem::path& path, const StudyTable& table, const RunInfo& info) {
  {
    h5::WritableFile file(name_beside(path), JournaledFile::Mode::create);
    file.transaction([&] {
      const h5::Object& root = file.root();
      write_info(root, info);
      h5::set_attribute(root, "title", table.title);
      h5::set_attribute(root, "outcome", to_string(table.outcome));
      h5::set_attribute(root, "made_of", table.made_of);
      h5::create_group(root, "/study");
      h5::write_text(root, "/study/text", table.text);
      write_rows(root, table);
    });
  }
  take_name(path);
}

StudyTable read_study_file(const std::filesystem::path& path) {
  const h5::Object root = h5::open_read_only(path);
  StudyTable table{h5::text_attribute(root, "title"),
                   h5::read_text(root, "/study/text"),
                   h5::text_attribute(h5::open_dataset(root, column_path(group, "value")), "unit"),
                   h5::text_attribute(h5::open_group(root, group), "answer"),
                   read_outcome(root),
                   {},
                   h5::text_attribute(root, "made_of")};
  table.rows.resize(h5::n_rows(h5::open_dataset(root, column_path(group, "value"))));
  for_each_column(table.unit, [&](const auto& column) { read_column(root, group, column, table.rows); });
  return table;
}

} // namespace kerf::output
