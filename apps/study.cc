#include "run_info.h"
#include "scene_arguments.h"

#include "base/parallel.h"
#include "scene/recorder.h"
#include "study/stability.h"
#include "study/study.h"

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

} // namespace

int study(const Arguments& arguments) {
  const SceneArguments parsed = parse_scene_arguments(arguments);
  if (parsed.n_threads > 0)
    set_n_threads(parsed.n_threads);
  const scene::SceneText text = scene::read_scene_text(parsed.scene, parsed.overrides);
  if (study::is_stability_study(text)) {
    run_stability(text, parsed, run_info("study", arguments));
    return 0;
  }
  const study::Plan plan = study::make_plan(text);
  output::require_claimable(parsed.output, parsed.earlier);
  std::size_t n = 0;
  const auto say = [&](const output::StudyRow& row) {
    std::printf("row %zu of %zu: %s: %s\n", ++n, plan.rows.size(), row.name.c_str(), row.outcome.c_str());
    std::fflush(stdout);
  };
  const output::StudyTable table =
    study::run_study(plan, parsed.output, run_info("study", arguments), parsed.earlier, say);
  std::printf("\n%s\nvalue: %s\n\n%s\nresults in %s\n", table.title.c_str(), table.answer.c_str(),
              study::aligned(table).c_str(), parsed.output.c_str());
  return 0;
}

} // namespace kerf::apps
