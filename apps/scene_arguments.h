#pragma once

#include "commands.h"
#include "output/results_folder.h"
#include "scene/text_scan.h"

#include <filesystem>

namespace kerf::apps {

/// What `run`, `check` and others are told.
struct SceneArguments {
  std::string scene;               ///< the first
  std::vector<std::string> scenes; ///< all; more than one for `run` alone
  std::vector<std::string> overrides;
  std::filesystem::path output; ///< results/SCENE when not given; of several scenes what is given, or results
  int n_jobs = 0;               ///< at a time, of several scenes or rows; 0: not said
  int row = 0;                  ///< of a study, from 1; 0: all
  int n_threads = 0;            ///< 0: as many as there are processors for it
  output::Earlier earlier = output::Earlier::refuse; ///< what to do about an earlier run's results
};

/// Whether a command takes several scenes, or a study, which has rows.
enum class Scenes { one, several, study };

/// Throws ParameterError for what is no valid argument.
SceneArguments parse_scene_arguments(const Arguments& arguments, Scenes scenes = Scenes::one);

/// The scene or the study, as written. Throws ParameterError as read_scene_text() does, and where it is the other of
/// the two.
scene::SceneText read_text(const SceneArguments& arguments, Scenes scenes = Scenes::one);

/// Appends what a process for one of several scenes or rows is told as well: changes of the scene, and what to do about
/// earlier results.
void add_common(const SceneArguments& arguments, std::vector<std::string>& words);

/// FOLDER/SCENE, without the scene's own folder and ending.
std::filesystem::path default_output(const std::string& scene, const std::filesystem::path& folder = "results");

} // namespace kerf::apps
