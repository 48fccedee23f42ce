#include "run_info.h"
#include "scene_arguments.h"

#include "base/parallel.h"
#include "scene/recorder.h"
#include "study/study.h"

#include <cstdio>

namespace kerf::apps {

int study(const Arguments& arguments) {
  const SceneArguments parsed = parse_scene_arguments(arguments);
  if (parsed.n_threads > 0)
    set_n_threads(parsed.n_threads);
  const study::Plan plan = study::make_plan(scene::read_scene_text(parsed.scene, parsed.overrides));
  output::require_claimable(parsed.output, parsed.earlier);
  std::size_t n = 0;
  const auto say = [&](const output::StudyRow& row) {
    std::printf("row %zu of %zu: %s: %s\n", ++n, plan.rows.size(), row.name.c_str(), row.outcome.c_str());
    std::fflush(stdout);
  };
  const output::StudyTable table = study::run_study(plan, parsed.output, run_info("study", arguments), parsed.earlier, say);
  std::printf("\n%s\nvalue: %s\n\n%s\nresults in %s\n", table.title.c_str(), table.answer.c_str(),
              study::aligned(table).c_str(), parsed.output.c_str());
  return 0;
}

} // namespace kerf::apps
