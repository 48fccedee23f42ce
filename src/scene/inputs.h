#pragma once

/// What a run reads, told so that the run can be repeated: its scene with all that the command line has changed, and
/// the hashes of the files that it names.

#include "scene/text_grammar.h"

#include <string>
#include <vector>

namespace kerf::scene {

/// The text of the scene with overrides in place and the names of files absolute: comments and lines stay where they
/// are, but for those that change. Read again, from anywhere, it is the same scene. `grammar` says which keys name
/// files.
std::string standalone_text(const SceneText& scene, const std::vector<SectionKind>& grammar);

/// Absolute paths of the files that the scene reads, in the scene's order, each once.
std::vector<std::string> input_files(const SceneText& scene, const std::vector<SectionKind>& grammar);

/// A line for each file that the scene reads, in the scene's order, as `sha256sum` prints it: hash, two blanks,
/// absolute path. Throws DataError for one that cannot be read.
std::vector<std::string> hashes_of_inputs(const SceneText& scene, const std::vector<SectionKind>& grammar);

} // namespace kerf::scene
