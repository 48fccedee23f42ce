#include "study/resumed.h"

#include "base/sha256.h"
#include "scene/grammar.h"
#include "scene/inputs.h"

#include <set>
#include <span>

namespace kerf::study {

namespace {

std::string hash_of_file(const std::string& path) {
  try {
    return sha256_of_file(path);
  } catch (const DataError&) {
    return "-";
  }
}

} // namespace

std::string made_of(const output::RunInfo& program, const std::string& study,
                    const std::vector<const scene::SceneText*>& scenes) {
  std::string all = program.version + "\n" + program.git_commit + "\n" + study;
  std::set<std::string> files;
  for (const scene::SceneText* const scene : scenes) {
    all += "\n" + scene::standalone_text(*scene, scene::grammar());
    for (const std::string& file : scene::input_files(*scene, scene::grammar()))
      if (files.insert(file).second)
        all += "\n" + hash_of_file(file) + "  " + file;
  }
  return sha256(std::as_bytes(std::span(all)));
}

} // namespace kerf::study
