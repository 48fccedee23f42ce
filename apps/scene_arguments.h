#pragma once

#include "commands.h"

#include <filesystem>

namespace kerf::apps {

/// What `run` and `check` are told.
struct SceneArguments {
  std::string scene;
  std::vector<std::string> overrides;
  std::filesystem::path output; ///< results/SCENE when not given
  int n_threads = 0;            ///< 0: as many as there are processors
};

/// Throws ParameterError for what is no valid argument.
SceneArguments parse_scene_arguments(const Arguments& arguments);

} // namespace kerf::apps
