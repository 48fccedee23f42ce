#include "scene_arguments.h"

#include "base/error.h"
#include "scene/compose.h"

#include <cstdio>

namespace kerf::apps {

int check(const Arguments& arguments) {
  for (const std::string& argument : arguments)
    if (argument == "--output" || argument == "--threads" || argument == "--force" || argument == "--resume")
      throw ParameterError(
        Complaint{.value = argument, .rule = "check takes no such option", .remedy = "Nothing is run"});
  const SceneArguments parsed = parse_scene_arguments(arguments);
  const scene::World world = scene::compose(read_text(parsed));
  for (const std::string& line : world.composition)
    std::printf("%s\n", line.c_str());
  std::printf("%s is sound: %d steps of %g s.\n", parsed.scene.c_str(), world.n_steps, world.time_step);
  return 0;
}

} // namespace kerf::apps
