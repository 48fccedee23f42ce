#include "study/study.h"

#include "study/measure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <system_error>

namespace kerf::study {

namespace {

std::string in_words(const StudyParameters& p) {
  return p.take + " of '" + p.answer + "'" + (p.minus.empty() ? "" : " minus '" + p.minus + "'");
}

/// "fem, fine" as a folder: "fem+fine", which no other row can be.
std::string folder_name(std::string name) {
  for (std::size_t at; (at = name.find(", ")) != std::string::npos;)
    name.replace(at, 2, "+");
  return name;
}

} // namespace

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw DataError(Complaint{.file = folder.string(),
                              .rule = "the results folder cannot be made: " + error.message(),
                              .remedy = "Choose another folder with --output, or change its permissions"});
}

void tell_orders(std::vector<output::StudyRow>& rows) {
  std::map<std::string, const output::StudyRow*> before;
  for (output::StudyRow& row : rows) {
    if (!std::isfinite(row.error))
      continue;
    const output::StudyRow*& last = before[row.family];
    if (last && last->h != row.h)
      row.order = std::log(std::abs(last->error / row.error)) / std::log(last->h / row.h);
    last = &row;
  }
}

output::StudyTable run_study(const Plan& plan, const std::filesystem::path& folder, const output::RunInfo& info,
                             const std::function<void(const output::StudyRow&)>& done) {
  make_folder(folder);
  output::StudyTable table{plan.parameters.title, plan.text, plan.parameters.unit, in_words(plan.parameters), {}, {}};
  for (const PlannedRow& row : plan.rows) {
    table.rows.push_back(measure(plan, row, folder / "rows" / folder_name(row.name), info));
    tell_orders(table.rows);
    output::write_study_file(folder / "study.h5", table, info);
    done(table.rows.back());
  }
  const bool all_failed = std::none_of(table.rows.begin(), table.rows.end(),
                                       [](const output::StudyRow& row) { return row.outcome == "completed"; });
  table.outcome = all_failed ? output::Outcome::failed : output::Outcome::completed;
  output::write_study_file(folder / "study.h5", table, info);
  if (all_failed)
    throw NumericalError("every row of the study has failed. The first, " + table.rows.front().name + ", " +
                         table.rows.front().outcome);
  return table;
}

} // namespace kerf::study
