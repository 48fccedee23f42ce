#pragma once

/// From the text of a study of stability to its rows: one scene, in variants, under cases of changes. A sweep names the
/// changes whose cases it combines; of the others each row takes the first case, so a sweep looks along a line or a
/// plane through a common point.

#include "scene/parameter_file.h"

#include <string>
#include <vector>

namespace kerf::study {

struct StabilityParameters {
  std::string title;
  std::string scene;
  int n_steps = 100;
  void describe(Parameters& p);
};

struct SweepParameters {
  std::string variants, changes; ///< names, separated by commas; no variants: all
  std::string ask = "outcome";
  void describe(Parameters& p);
};

enum class Ask { outcome, largest_step };

struct StabilityCase {
  std::string sweep, variant, cases; ///< "stiffness and step", "fem", "1e5, 1e-3"
  std::vector<std::string> overrides;
  scene::SceneText scene; ///< with the overrides in place
  Ask ask = Ask::outcome;
};

struct StabilityPlan {
  StabilityParameters parameters;
  std::string text; ///< of the study, standalone
  std::vector<StabilityCase> cases;
};

/// Whether a file is a study of stability: it has a section of that name.
bool is_stability_study(const scene::SceneText& text);

/// Throws as make_plan().
StabilityPlan make_stability_plan(const scene::SceneText& text);

/// The scene again with another time step [s], and an end after `n_steps` of them.
scene::SceneText with_step(const scene::SceneText& scene, double time_step, int n_steps);

} // namespace kerf::study
