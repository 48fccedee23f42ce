#include "output/study_file.h"

#include "base/error.h"
#include "output/checkpoint_file.h"
#include "output/csv_file.h"
#include "output/names.h"
#include "output/run_info.h"

#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace kerf::output {
namespace {

constexpr const char *group = "/study/rows", *norms_group = "/study/norms", *points_name = "/study/points";

constexpr std::array<std::pair<const char*, std::string StudyNorm::*>, 3> norm_columns = {
  {{"name", &StudyNorm::name}, {"unit", &StudyNorm::unit}, {"answer", &StudyNorm::answer}}};
constexpr std::array<std::pair<const char*, std::vector<double> StudyRow::*>, 2> displacement_sets = {
  {{"/study/displacements", &StudyRow::displacements},
   {"/study/reference_displacements", &StudyRow::reference_displacements}}};

/// Three columns for each norm.
template <class Columns>
void describe_norms(const std::vector<StudyNorm>& norms, const Columns& columns) {
  for (std::size_t k = 0; k < norms.size(); ++k) {
    const auto field = [k](double NormValue::*number) {
      return [k, number](StudyRow& row) -> double& { return row.norms[k].*number; };
    };
    const auto& [name, unit, answer] = norms[k];
    columns.number("value_" + name, field(&NormValue::value), unit, answer);
    columns.number("reference_" + name, field(&NormValue::reference), unit, "what value_" + name + " should be");
    columns.number("error_" + name, field(&NormValue::error), "1", "value_" + name + " over its reference less one");
  }
}

/// Calls action(column) for every column, whatever its type.
template <class Action>
void for_each_column(const StudyTable& table, const Action& action) {
  const Columns<StudyRow, Action> columns{action};
  const std::string& unit = table.unit;
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
  columns.count("repetitions", &StudyRow::n_repetitions, "runs of the row, which differ in their times alone");
  columns.number("setup_time", &StudyRow::setup_seconds, "s", "wall-clock time of composing, the repetitions' median");
  columns.number("setup_spread", &StudyRow::setup_spread, "s", "largest less smallest of the repetitions");
  columns.number("setup_cpu_time", &StudyRow::setup_cpu_seconds, "s",
                 "of all threads while composing, the repetitions' median");
  columns.number("stepping_time", &StudyRow::stepping_seconds, "s",
                 "wall-clock time of all steps, without writing files, the repetitions' median");
  columns.number("stepping_spread", &StudyRow::stepping_spread, "s", "largest less smallest of the repetitions");
  columns.number("cpu_time", &StudyRow::cpu_seconds, "s",
                 "of all threads in all steps, without writing files, the repetitions' median: hardly depends on what else the "
                 "machine does");
  columns.number("cpu_spread", &StudyRow::cpu_spread, "s", "largest less smallest of the repetitions");
  columns.number("peak_memory", &StudyRow::peak_memory, "byte",
                 "most memory in RAM during the row, beyond what the process had before it");
  if (!table.points.empty()) {
    columns.number("error_L2", &StudyRow::error_l2, "1",
                   "root of the sum over the points of the squares of displacement less reference, over that of the "
                   "reference");
    columns.number("error_max", &StudyRow::error_max, "1",
                   "largest distance from the reference at a point, over the reference's largest displacement");
  }
  describe_norms(table.norms, columns);
  columns.text("outcome", &StudyRow::outcome, "completed, or failed: why");
}

void write_norms(const h5::Object& root, const std::vector<StudyNorm>& norms) {
  h5::create_group(root, norms_group);
  for (const auto& [name, field] : norm_columns) {
    std::vector<std::string> lines;
    for (const StudyNorm& norm : norms)
      lines.push_back(norm.*field);
    h5::write_lines(root, column_path(norms_group, name), lines);
  }
}

std::vector<StudyNorm> read_norms(const h5::Object& root) {
  std::vector<StudyNorm> norms;
  for (const auto& [name, field] : norm_columns) {
    const auto lines = h5::read_lines(root, column_path(norms_group, name));
    norms.resize(lines.size());
    for (std::size_t k = 0; k < lines.size(); ++k)
      norms[k].*field = lines[k];
  }
  return norms;
}

/// A row each, NaN where they are not known.
void write_displacements(const h5::Object& root, const char* name, std::vector<double> StudyRow::*field,
                         const StudyTable& table) {
  const std::size_t n = 3 * table.points.size();
  std::vector<double> all;
  for (const StudyRow& row : table.rows) {
    const std::vector<double> unknown(n, std::numeric_limits<double>::quiet_NaN());
    const std::vector<double>& known = (row.*field).empty() ? unknown : row.*field;
    all.insert(all.end(), known.begin(), known.end());
  }
  h5::set_attribute(h5::write_rows(root, name, {h5::Number::float64, n}, all.data(), table.rows.size()), "unit", "m");
}

void read_displacements(const h5::Object& root, const char* name, std::vector<double> StudyRow::*field,
                        StudyTable& table) {
  const auto all = h5::read_vector<double>(root, name);
  const auto n = std::ssize(table.points) * 3;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const auto first = all.begin() + std::ssize(table.points) * 3 * static_cast<std::ptrdiff_t>(i);
    if (std::isfinite(*first))
      (table.rows[i].*field).assign(first, first + n);
  }
}

void write_points(const h5::Object& root, const StudyTable& table) {
  if (table.points.empty())
    return;
  const auto points =
    h5::write_rows(root, points_name, {h5::Number::float64, 3}, table.points.data(), table.points.size());
  h5::set_attribute(points, "unit", "m");
  for (const auto& [name, field] : displacement_sets)
    write_displacements(root, name, field, table);
}

void read_points(const h5::Object& root, StudyTable& table) {
  if (!h5::exists(root, points_name))
    return;
  table.points = h5::read_items<double, Vec3>(root, points_name);
  for (const auto& [name, field] : displacement_sets)
    read_displacements(root, name, field, table);
}

void write_rows(const h5::Object& root, const StudyTable& table) {
  h5::set_attribute(h5::create_group(root, group), "answer", table.answer);
  for_each_column(table, [&](const auto& column) { write_column(root, group, column, table.rows); });
  write_norms(root, table.norms);
  write_points(root, table);
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
                   h5::text_attribute(root, "made_of"),
                   read_norms(root),
                   {}};
  table.rows.resize(h5::n_rows(h5::open_dataset(root, column_path(group, "value"))));
  for (StudyRow& row : table.rows)
    row.norms.resize(table.norms.size());
  read_points(root, table);
  for_each_column(table, [&](const auto& column) { read_column(root, group, column, table.rows); });
  return table;
}

void write_study_csv(const std::filesystem::path& path, const StudyTable& table) {
  CsvTable csv(table.rows.size());
  for_each_column(table, [&](const auto& column) {
    csv.add(csv_text(column.name + (column.unit == "1" ? "" : " [" + column.unit + "]")), column, table.rows);
  });
  csv.write(path);
}

} // namespace kerf::output
