#include "run_info.h"
#include "scene_arguments.h"
#include "study_jobs.h"

#include "base/parallel.h"
#include "scene/recorder.h"
#include "study/measure.h"
#include "study/stability.h"
#include "study/study.h"

#include <algorithm>
#include <cstdio>

namespace kerf::apps {

namespace {

void run_stability(const scene::SceneText& text, const SceneArguments& parsed, const output::RunInfo& info) {
  const study::StabilityPlan plan = study::make_stability_plan(text);
  output::require_claimable(parsed.output, parsed.earlier);
  std::size_t n = 0;
  const auto say = [&](const output::StabilityRow& row) {
    std::printf("row %zu of %zu: %s, %s, %s: %s\n", ++n, plan.cases.size(), row.sweep.c_str(), row.variant.c_str(),
                row.cases.c_str(), row.outcome.c_str());
    std::fflush(stdout);
  };
  const output::StabilityTable table = study::run_stability_study(plan, parsed.output, info, parsed.earlier, say);
  std::printf("\n%s\n\n%s\nresults in %s\n", table.title.c_str(), study::aligned(table).c_str(), parsed.output.c_str());
}

/// The k-th row alone, told as one line. Throws NumericalError if it has failed.
void run_row(const study::Plan& plan, const SceneArguments& parsed, const output::RunInfo& info) {
  const auto k = static_cast<std::size_t>(parsed.row) - 1;
  if (k >= plan.rows.size())
    throw ParameterError(Complaint{.path = "--row",
                                   .value = std::to_string(parsed.row),
                                   .rule = "the study has " + std::to_string(plan.rows.size()) + " rows",
                                   .remedy = "Count from 1"});
  const output::StudyRow row = study::run_row(plan, k, parsed.output, info, parsed.earlier);
  std::printf("row %d of %zu: %s: %s\n", parsed.row, plan.rows.size(), row.name.c_str(), row.outcome.c_str());
  if (row.outcome != "completed")
    throw NumericalError("the row " + row.name + " has " + row.outcome);
}

/// The exit code tells the worst of the rows; the table has all of them, with their reasons.
void require_completed(const output::StudyTable& table) {
  const auto has_failed = [](const output::StudyRow& row) { return row.outcome != "completed"; };
  const auto first = std::find_if(table.rows.begin(), table.rows.end(), has_failed);
  if (first != table.rows.end())
    throw NumericalError(std::to_string(std::count_if(first, table.rows.end(), has_failed)) + " of " +
                         std::to_string(table.rows.size()) + " rows have failed. The first, " + first->name + ", " +
                         first->outcome);
}

} // namespace

int study(const Arguments& arguments) {
  const SceneArguments parsed = parse_scene_arguments(arguments, Scenes::study);
  if (parsed.row > 0 && parsed.n_jobs > 0)
    throw ParameterError(Complaint{.path = "--row", .rule = "runs one row, --jobs all", .remedy = "Give one of them"});
  if (parsed.n_threads > 0)
    set_n_threads(parsed.n_threads);
  const scene::SceneText text = read_text(parsed, Scenes::study);
  if (study::is_stability_study(text)) {
    if (parsed.n_jobs + parsed.row > 0)
      throw ParameterError(Complaint{
        .file = parsed.scene, .rule = "is a study of stability: its rows take no time, and have no --jobs or --row"});
    run_stability(text, parsed, run_info("study", arguments));
    return 0;
  }
  const study::Plan plan = study::make_plan(text);
  if (parsed.row > 0) {
    run_row(plan, parsed, run_info("study", arguments));
    return 0;
  }
  output::require_claimable(parsed.output, parsed.earlier);
  if (parsed.earlier != output::Earlier::resume)
    study::require_changes_read(plan);
  if (!study::has_reference(plan))
    std::printf(
      "no errors will be told: the study has no reference. Write 'set Reference', a section Truth, or 'set Reference "
      "row'\n");
  std::size_t n = 0;
  const auto say = [&](const output::StudyRow& row) {
    std::printf("row %zu of %zu: %s: %s\n", ++n, plan.rows.size(), row.name.c_str(), row.outcome.c_str());
    std::fflush(stdout);
  };
  const output::RunInfo info = run_info("study", arguments);
  const output::StudyTable table = run_study_jobs(plan, parsed, info, say);
  std::printf("\n%s\nvalue: %s\n\n%s\nresults in %s\n", table.title.c_str(), table.answer.c_str(),
              study::aligned(table).c_str(), parsed.output.c_str());
  require_completed(table);
  return 0;
}

} // namespace kerf::apps
