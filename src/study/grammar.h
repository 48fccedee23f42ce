#pragma once

/// What a study file may say: one scene, run in variants, asked for one number. Checked as strictly as a scene, by the
/// same means (scene/parameter_file.h).

#include "scene/text_grammar.h"

#include <string>
#include <vector>

namespace kerf::study {

struct StudyParameters {
  std::string title;
  std::string scene;
  std::string body;
  std::string answer, minus;
  std::string take = "end";
  double last_part = 0.1; ///< [1]
  std::string unit;
  std::string order_over;
  std::string times = "count";
  void describe(Parameters& p);
};

/// The value that the answer should have, in the unit of the answer.
struct ReferenceParameters {
  double reference = 0; ///< 0: none
  std::string source;
  void describe(Parameters& p);
};

/// What is changed of the scene.
struct SettingParameters {
  std::string set;
  void describe(Parameters& p);
};

/// The sections of a study.
std::vector<scene::SectionKind> grammar();

} // namespace kerf::study
