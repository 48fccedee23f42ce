#pragma once

/// From a study's text to the rows it will run: every variant in every case of every change.

#include "scene/parameter_file.h"
#include "study/grammar.h"

#include <limits>
#include <string>
#include <vector>

namespace kerf::study {

struct Reference {
  double value = 0; ///< in the unit of the answer; 0: none
  std::string source;
  /// What a section Truth knows beside it; NaN and empty where nobody has asked.
  double energy = std::numeric_limits<double>::quiet_NaN();    ///< [J]
  double frequency = std::numeric_limits<double>::quiet_NaN(); ///< [1/s]
  Points displacements = {};                                   ///< at the points of the study [m]
};

/// A further number that is asked of each row.
struct Norm {
  std::string name; ///< without blanks: "crack_opening"
  NormParameters parameters;
  scene::Section section; ///< for complaints
  Reference reference;
};

/// A run that will be one row.
struct PlannedRow {
  std::string name;   ///< "fem, fine": variant, then cases; letters, digits, '_', '-', '.', blanks, ", "
  std::string family; ///< the same without the case of the change that orders are told over
  std::vector<std::string> overrides;
  scene::SceneText scene; ///< with the overrides in place, without images and surface files
  Reference reference;
  std::vector<double> norm_references; ///< of each norm, in its unit; 0: none
};

/// A case of a change that sets something: whether any row reads it can be seen only when rows are composed.
struct PlannedCase {
  scene::Section section;             ///< for complaints
  std::string key;                    ///< of the section, that says the changes
  std::vector<std::string> paths;     ///< what it sets: "Body bar/Phyxels/Spacing [m]"
  std::vector<std::size_t> rows = {}; ///< in which it is set
};

struct Plan {
  StudyParameters parameters;
  scene::Section study; ///< the section `Study`, for complaints
  std::string text;     ///< of the study, standalone
  std::string scene;    ///< path of the scene
  std::vector<PlannedRow> rows;
  std::vector<Norm> norms = {};
  std::vector<PlannedCase> cases = {};
  Points points = {};     ///< where displacements are compared, at rest [m]
  scene::Section at = {}; ///< the section `Points`, for complaints
};

/// Throws ParameterError for what the study says and cannot be, with its file and line, and for every change that the
/// scene does not know; DataError for files that cannot be read. Nothing is composed yet.
Plan make_plan(const scene::SceneText& text);

/// Whether any row, or norm of it, has something to be measured by.
bool has_reference(const Plan& plan);

} // namespace kerf::study
