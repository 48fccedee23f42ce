#pragma once

/// From a study's text to the rows it will run: every variant in every case of every change.

#include "scene/parameter_file.h"
#include "study/grammar.h"

#include <string>
#include <vector>

namespace kerf::study {

struct Reference {
  double value = 0; ///< in the unit of the answer; 0: none
  std::string source;
};

/// A run that will be one row.
struct PlannedRow {
  std::string name;   ///< "fem, fine": variant, then cases; letters, digits, '_', '-', ", "
  std::string family; ///< the same without the case of the change that orders are told over
  std::vector<std::string> overrides;
  scene::SceneText scene; ///< with the overrides in place, without images and surface files
  Reference reference;
};

struct Plan {
  StudyParameters parameters;
  scene::Section study; ///< the section `Study`, for complaints
  std::string text;     ///< of the study, standalone
  std::string scene;    ///< path of the scene
  std::vector<PlannedRow> rows;
};

/// Throws ParameterError for what the study says and cannot be, with its file and line, and for every change that the
/// scene does not know; DataError for files that cannot be read. Nothing is composed yet.
Plan make_plan(const scene::SceneText& text);

} // namespace kerf::study
