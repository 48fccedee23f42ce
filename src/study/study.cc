#include "study/study.h"

#include "base/interrupt.h"
#include "output/checkpoint_file.h"
#include "study/measure.h"
#include "study/resumed.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace kerf::study {

namespace {

constexpr char study_name[] = "study.h5", row_name[] = "row.h5", csv_name[] = "study.csv";

std::string in_words(const AnswerParameters& p) {
  return p.take + " of '" + p.answer + "'" + (p.minus.empty() ? "" : " minus '" + p.minus + "'");
}

/// Without rows.
output::StudyTable empty_table(const Plan& plan, const std::string& made_of, const output::Outcome outcome) {
  output::StudyTable table{
    plan.parameters.title, plan.text, plan.parameters.unit, in_words(plan.parameters), outcome, {}, made_of};
  for (const Norm& norm : plan.norms)
    table.norms.push_back({norm.name, norm.parameters.unit, in_words(norm.parameters)});
  table.points = plan.points;
  return table;
}

/// By cubes; where these are the same, by time steps.
bool is_finer(const output::StudyRow& a, const output::StudyRow& b) {
  return a.h != b.h ? a.h < b.h : a.dt < b.dt;
}

/// The completed row that another is measured by; none where it is not there.
const output::StudyRow* reference_row(const std::string& name, const std::vector<output::StudyRow>& rows,
                                      const output::StudyRow& row) {
  const output::StudyRow* found = nullptr;
  for (const output::StudyRow& other : rows)
    if (other.outcome == "completed" &&
        (other.name == name || (name == "finest" && other.family == row.family && (!found || is_finer(other, *found)))))
      found = &other;
  return found;
}

/// Takes what is not known of a row's references from another; a row says nothing about itself.
void take_references(const output::StudyRow& from, output::StudyRow& row) {
  const bool is_itself = &from == &row;
  const auto fill = [&](double& reference, const double value) {
    if (!std::isfinite(reference) && !is_itself)
      reference = value;
  };
  if (!std::isfinite(row.reference) && !is_itself)
    row.reference_source = "the row " + from.name;
  fill(row.reference, from.value);
  for (std::size_t k = 0; k < row.norms.size(); ++k)
    fill(row.norms[k].reference, from.norms[k].value);
  if (row.reference_displacements.empty() && !is_itself)
    row.reference_displacements = from.displacements;
}

/// "fem, fine" as a folder: "fem+fine", which no other row can be.
std::string folder_name(std::string name) {
  for (std::size_t at; (at = name.find(", ")) != std::string::npos;)
    name.replace(at, 2, "+");
  return name;
}

std::vector<const scene::SceneText*> scenes_of(const Plan& plan) {
  std::vector<const scene::SceneText*> scenes;
  for (const PlannedRow& row : plan.rows)
    scenes.push_back(&row.scene);
  return scenes;
}

} // namespace

void tell_orders(std::vector<output::StudyRow>& rows) {
  std::map<std::string, const output::StudyRow*> before;
  for (output::StudyRow& row : rows) {
    if (!std::isfinite(row.error))
      continue;
    const output::StudyRow*& last = before[row.family];
    const double ratio = !last ? 1 : last->h != row.h ? last->h / row.h : last->dt / row.dt;
    if (ratio != 1)
      row.order = std::log(std::abs(last->error / row.error)) / std::log(ratio);
    last = &row;
  }
}

void tell_references(const std::string& name, std::vector<output::StudyRow>& rows) {
  if (name.empty())
    return;
  for (output::StudyRow& row : rows) {
    if (const output::StudyRow* const from = reference_row(name, rows, row))
      take_references(*from, row);
    tell_errors(row);
  }
}

StudyRows::StudyRows(const Plan& plan, const std::filesystem::path& folder, const output::RunInfo& info,
                     const output::Earlier earlier)
  : plan_(plan),
    folder_(folder),
    info_(info),
    claimed_(folder, earlier,
             {study_name, output::name_beside(study_name).string(), csv_name, output::name_beside(csv_name).string()}),
    made_of_(made_of(info, plan.text, scenes_of(plan))),
    rows_(plan.rows.size()) {
  if (earlier != output::Earlier::resume)
    return;
  const auto known = earlier_rows(folder / study_name, output::read_study_file, made_of_);
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    for (const output::StudyRow& row : known)
      if (row.name == plan.rows[k].name)
        rows_[k] = row;
    if (!has(k) && is_written(k))
      rows_[k] = read_row(k);
  }
}

void StudyRows::put(const std::size_t k, output::StudyRow row) {
  rows_[k] = std::move(row);
  write(table(output::Outcome::running));
}

bool StudyRows::is_written(const std::size_t k) const {
  return std::filesystem::exists(folder_ / row_folder(plan_, k) / row_name);
}

output::StudyRow StudyRows::read_row(const std::size_t k) const {
  const auto file = folder_ / row_folder(plan_, k) / row_name;
  auto rows = earlier_rows(file, output::read_study_file, made_of_);
  if (rows.size() != 1)
    throw DataError(file.string() + " does not hold one row of a study");
  return std::move(rows.front());
}

output::StudyTable StudyRows::table(const output::Outcome outcome) const {
  output::StudyTable table = empty_table(plan_, made_of_, outcome);
  for (const auto& row : rows_)
    if (row)
      table.rows.push_back(*row);
  if (table.rows.size() == rows_.size())
    tell_references(plan_.parameters.reference_row, table.rows);
  tell_orders(table.rows);
  return table;
}

void StudyRows::write(const output::StudyTable& table) const {
  output::write_study_file(folder_ / study_name, table, info_);
  output::write_study_csv(folder_ / csv_name, table);
}

output::StudyTable StudyRows::finish() {
  const bool all_failed =
    std::none_of(rows_.begin(), rows_.end(), [](const auto& row) { return row->outcome == "completed"; });
  const output::StudyTable whole = table(all_failed ? output::Outcome::failed : output::Outcome::completed);
  write(whole);
  if (all_failed)
    throw NumericalError("every row of the study has failed. The first, " + whole.rows.front().name + ", " +
                         whole.rows.front().outcome);
  return whole;
}

std::filesystem::path row_folder(const Plan& plan, const std::size_t k) {
  return std::filesystem::path("rows") / folder_name(plan.rows[k].name);
}

output::StudyTable run_study(const Plan& plan, const std::filesystem::path& folder, const output::RunInfo& info,
                             const output::Earlier earlier, const std::function<void(const output::StudyRow&)>& done) {
  StudyRows rows(plan, folder, info, earlier);
  for (std::size_t k = 0; k < plan.rows.size(); ++k) {
    try {
      if (!rows.has(k))
        rows.put(k, measure(plan, plan.rows[k], folder / row_folder(plan, k), info, earlier));
    } catch (const Interrupted&) {
      rows.interrupt();
      throw;
    }
    done(rows.row(k));
  }
  return rows.finish();
}

output::StudyRow run_row(const Plan& plan, const std::size_t k, const std::filesystem::path& folder,
                         const output::RunInfo& info, const output::Earlier earlier) {
  const auto own = folder / row_folder(plan, k), file = own / row_name;
  const std::string of = made_of(info, plan.text, scenes_of(plan));
  if (earlier == output::Earlier::resume)
    if (auto rows = earlier_rows(file, output::read_study_file, of); !rows.empty())
      return std::move(rows.front());
  output::StudyTable table = empty_table(plan, of, output::Outcome::completed);
  table.rows.push_back(measure(plan, plan.rows[k], own, info, earlier));
  const output::ResultsFolder claimed(own, output::Earlier::resume, {row_name, output::name_beside(row_name).string()});
  output::write_study_file(file, table, info);
  return std::move(table.rows.front());
}

} // namespace kerf::study
