#pragma once

/// What a study file may say: one scene, run in variants, asked for one number. Checked as strictly as a scene, by the
/// same means (scene/parameter_file.h).

#include "scene/text_grammar.h"

#include <string>
#include <vector>

namespace kerf::study {

/// A number that is asked of a run.
struct AnswerParameters {
  std::string answer, minus;
  std::string take = "end";
  double last_part = 0.1; ///< [1]
  std::string unit;
  void describe(Parameters& p);
};

struct StudyParameters : AnswerParameters {
  std::string title;
  std::string scene;
  std::string body;
  std::string order_over;
  std::string reference_row;
  std::string times = "count";
  int repetitions = 1;
  void describe(Parameters& p);
};

/// Another number that is asked of each row.
struct NormParameters : AnswerParameters {
  std::string truth = "none";
  void describe(Parameters& p);
};

/// Where displacements are compared, at rest [m]: points, and a grid of them.
struct PointsParameters {
  Points points;
  Points box;                 ///< two corners, or none
  std::vector<double> counts; ///< [1] along each axis
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

/// Values that a key of the scene takes, each a case.
struct RangeParameters {
  std::string key;
  std::string values;
  std::vector<double> range;
  int number = 0;
  std::string spacing = "equal steps";
  void describe(Parameters& p);
};

/// The sections of a study.
std::vector<scene::SectionKind> grammar();

} // namespace kerf::study
