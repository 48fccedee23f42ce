#include "output/study_file.h"

#include "base/error.h"
#include "output/checkpoint_file.h"
#include "output/h5_array.h"
#include "output/names.h"
#include "output/run_info.h"

#include <type_traits>

namespace kerf::output {
namespace {

constexpr const char* group = "/study/rows";

template <class T>
struct Column {
  const char* name;
  T StudyRow::*field;
  std::string unit, description;
};

/// Calls action(column) for every column, whatever its type; `unit` of the answer.
template <class Action>
void for_each_column(const std::string& unit, const Action& action) {
  const auto text = [&](const char* name, std::string StudyRow::*field, const char* description) {
    action(Column<std::string>{name, field, "1", description});
  };
  const auto number = [&](const char* name, double StudyRow::*field, const std::string& its_unit,
                          const char* description) {
    action(Column<double>{name, field, its_unit, description});
  };
  const auto count = [&](const char* name, std::int64_t StudyRow::*field, const char* description) {
    action(Column<std::int64_t>{name, field, "1", description});
  };
  text("name", &StudyRow::name, "variant and cases of the row");
  text("family", &StudyRow::family, "the same in rows between which orders of convergence are told");
  text("changes", &StudyRow::changes, "what was changed of the scene, separated by ' | '");
  text("backend", &StudyRow::backend, "the physics of the body that is asked");
  text("integrator", &StudyRow::integrator, "how its time advances");
  number("h", &StudyRow::h, "m", "edge of the grid's cubes");
  number("dt", &StudyRow::dt, "s", "time step");
  count("dof", &StudyRow::n_dof, "coordinates of the particles of all bodies at the end, held ones included");
  count("steps", &StudyRow::n_steps, "time steps that were finished");
  count("iterations", &StudyRow::n_iterations, "of the linear solver in all steps of the body that is asked");
  number("value", &StudyRow::value, unit, "the answer");
  number("reference", &StudyRow::reference, unit, "what the answer should be");
  text("reference_source", &StudyRow::reference_source, "where the reference comes from");
  number("error", &StudyRow::error, "1", "value over reference less one");
  number("order", &StudyRow::order, "1",
         "order of convergence in h, from the errors of this row and of the row of its family before it");
  number("setup_time", &StudyRow::setup_seconds, "s", "wall-clock time of composing");
  number("stepping_time", &StudyRow::stepping_seconds, "s", "wall-clock time of all steps, without writing files");
  number("cpu_time", &StudyRow::cpu_seconds, "s",
         "of all threads in all steps, writing the series included: hardly depends on what else the machine does");
  number("peak_memory", &StudyRow::peak_memory, "byte",
         "most memory in RAM during the row, beyond what the process had before it");
  text("outcome", &StudyRow::outcome, "completed, or failed: why");
}

template <class T>
h5::Object write_column(const h5::Object& root, const std::string& name, const std::vector<T>& values) {
  if constexpr (std::is_same_v<T, std::string>)
    return h5::write_lines(root, name, values);
  else
    return h5::write_vector(root, name, values);
}

template <class T>
std::vector<T> read_column(const h5::Object& root, const std::string& name) {
  if constexpr (std::is_same_v<T, std::string>)
    return h5::read_lines(root, name);
  else
    return h5::read_vector<T>(root, name);
}

std::string path_of(const char* column) { return std::string(group) + "/" + column; }

void write_rows(const h5::Object& root, const StudyTable& table) {
  h5::set_attribute(h5::create_group(root, group), "answer", table.answer);
  for_each_column(table.unit, [&]<class T>(const Column<T>& column) {
    std::vector<T> values;
    for (const StudyRow& row : table.rows)
      values.push_back(row.*column.field);
    const h5::Object dataset = write_column(root, path_of(column.name), values);
    h5::set_attribute(dataset, "unit", column.unit);
    h5::set_attribute(dataset, "description", column.description);
  });
}

} // namespace

void write_study_file(const std::filesystem::path& path, const StudyTable& table, const RunInfo& info) {
  const auto beside = name_beside(path);
  {
    h5::WritableFile file(beside, JournaledFile::Mode::create);
    file.transaction([&] {
      const h5::Object& root = file.root();
      write_info(root, info);
      h5::set_attribute(root, "title", table.title);
      h5::set_attribute(root, "outcome", to_string(table.outcome));
      h5::create_group(root, "/study");
      h5::write_text(root, "/study/text", table.text);
      write_rows(root, table);
    });
  }
  std::error_code error;
  std::filesystem::rename(beside, path, error);
  if (error)
    throw DataError({.file = path.string(),
                     .rule = "cannot be written: " + error.message(),
                     .remedy = "Name a file in a folder that exists and where you may write"});
}

StudyTable read_study_file(const std::filesystem::path& path) {
  const h5::Object root = h5::open_read_only(path);
  StudyTable table{h5::text_attribute(root, "title"),
                   h5::read_text(root, "/study/text"),
                   h5::text_attribute(h5::open_dataset(root, path_of("value")), "unit"),
                   h5::text_attribute(h5::open_group(root, group), "answer"),
                   read_outcome(root),
                   {}};
  table.rows.resize(h5::n_rows(h5::open_dataset(root, path_of("value"))));
  for_each_column(table.unit, [&]<class T>(const Column<T>& column) {
    const auto values = read_column<T>(root, path_of(column.name));
    if (values.size() != table.rows.size())
      throw DataError({.file = root.file,
                       .path = path_of(column.name),
                       .value = std::to_string(values.size()),
                       .rule = "must have an entry for each of the " + std::to_string(table.rows.size()) + " rows",
                       .remedy = "Read a file that Kerf wrote"});
    for (std::size_t i = 0; i < values.size(); ++i)
      table.rows[i].*column.field = values[i];
  });
  return table;
}

} // namespace kerf::output
