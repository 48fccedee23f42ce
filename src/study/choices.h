#pragma once

/// What the rows of a study choose from: variants, and cases of changes, each with its changes of the scene. The values
/// of a change's key are cases too (study/ranges.h).

#include "scene/parameter_file.h"
#include "study/plan.h"

namespace kerf::study {

/// One alternative: a variant, or a case of a change.
struct Choice {
  std::string name;
  const scene::Section* section = nullptr;
  std::string key; ///< of the section, that says the changes
  std::vector<std::string> sets;
  Reference reference = {};
};

/// Alternatives of which each row takes one.
struct Axis {
  std::string name; ///< of the change; empty: the variants
  std::vector<Choice> choices;
};

Reference read_reference(const scene::Section& section);

/// What stands between the '|' of a list, without blanks around it.
std::vector<std::string> split(const std::string& list);

/// The variants, then the changes in their order. Throws ParameterError for what is not there or is empty.
std::vector<Axis> read_axes(const scene::Section& root);

/// The next combination, the last axis fastest; false behind the last one.
bool advance(const std::vector<Axis>& axes, std::vector<std::size_t>& at);

/// The scene with the changes of the choices in place, checked against its grammar, without images and surface files;
/// what is wrong with a change is told at the line of the study that makes it.
scene::SceneText changed_scene(const std::string& path, const std::vector<const Choice*>& choices);

} // namespace kerf::study
