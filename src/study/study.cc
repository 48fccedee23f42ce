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

constexpr char study_name[] = "study.h5";

std::string in_words(const StudyParameters& p) {
  return p.take + " of '" + p.answer + "'" + (p.minus.empty() ? "" : " minus '" + p.minus + "'");
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
    if (last && last->h != row.h)
      row.order = std::log(std::abs(last->error / row.error)) / std::log(last->h / row.h);
    last = &row;
  }
}

output::StudyTable run_study(const Plan& plan, const std::filesystem::path& folder, const output::RunInfo& info,
                             const output::Earlier earlier, const std::function<void(const output::StudyRow&)>& done) {
  const output::ResultsFolder claimed(folder, earlier, {study_name, output::name_beside(study_name).string()});
  const auto write = [&](output::StudyTable& table, const output::Outcome outcome) {
    table.outcome = outcome;
    output::write_study_file(folder / study_name, table, info);
  };
  output::StudyTable table{plan.parameters.title, plan.text, plan.parameters.unit, in_words(plan.parameters), {}, {}};
  table.made_of = made_of(info, plan.text, scenes_of(plan));
  if (earlier == output::Earlier::resume)
    table.rows = earlier_rows(folder / study_name, output::read_study_file, table.made_of);
  for (const output::StudyRow& row : table.rows)
    done(row);
  for (std::size_t r = table.rows.size(); r < plan.rows.size(); ++r) {
    const PlannedRow& row = plan.rows[r];
    try {
      table.rows.push_back(measure(plan, row, folder / "rows" / folder_name(row.name), info, earlier));
    } catch (const Interrupted&) {
      write(table, output::Outcome::interrupted);
      throw;
    }
    tell_orders(table.rows);
    write(table, output::Outcome::running);
    done(table.rows.back());
  }
  const bool all_failed = std::none_of(table.rows.begin(), table.rows.end(),
                                       [](const output::StudyRow& row) { return row.outcome == "completed"; });
  write(table, all_failed ? output::Outcome::failed : output::Outcome::completed);
  if (all_failed)
    throw NumericalError("every row of the study has failed. The first, " + table.rows.front().name + ", " +
                         table.rows.front().outcome);
  return table;
}

} // namespace kerf::study
