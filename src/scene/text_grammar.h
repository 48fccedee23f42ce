#pragma once

/// Which sections a scene may have, and the check of a written scene against them.

#include "base/parameters.h"
#include "scene/text_scan.h"

#include <functional>
#include <string>
#include <vector>

namespace kerf::scene {

/// `subsection Time`, or as often as one likes, each with a name of its own: `subsection Body liver`. Titled: the name
/// may hold blanks and dots.
enum class Occurrence { once, named, titled };

/// A node of the grammar.
struct SectionKind {
  std::string kind; ///< "Body"
  Occurrence occurrence = Occurrence::once;
  std::string text;                          ///< what the section is for
  std::function<void(Parameters&)> describe; ///< lists the keys; empty when there are none. See keys_of.
  std::vector<SectionKind> children;
};

/// The keys of structs that have describe(Parameters&), with the structs' initial values as defaults.
template <class... Fields>
std::function<void(Parameters&)> keys_of() {
  return [](Parameters& p) { (Fields().describe(p), ...); };
}

/// What names, and names of titled sections, may be made of.
const std::string& name_characters();
const std::string& title_characters();

/// The keys of a kind, to check and to print, not to assign.
std::vector<Parameter> keys(const SectionKind& kind);

/// A heading, taken apart.
struct Heading {
  const SectionKind* kind = nullptr; ///< nullptr when no kind fits
  std::string name;                  ///< "liver"; empty for a section that occurs once
};
Heading match_heading(const std::string& heading, const std::vector<SectionKind>& kinds);

/// Throws ParameterError for the first unknown section or key, bad value or missing key.
void check_scene(const WrittenSection& root, const std::vector<SectionKind>& grammar);

} // namespace kerf::scene
