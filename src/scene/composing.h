#pragma once

/// What the makers of a world's parts share: reading sections that may be absent, paths, and the complaints of other
/// rooms told at the place in the scene that caused them.

#include "scene/parameter_file.h"

#include <filesystem>
#include <sstream>

namespace kerf::scene {

/// The keys of a section below `parent`; their defaults when the scene does not write it.
template <class Fields>
Fields read_if_written(const Section& parent, const std::string& kind) {
  const Section* section = parent.find(kind);
  return section ? section->read<Fields>() : Fields();
}

/// What another room says, to stand inside a sentence.
std::string clause(const std::string& sentence);

/// A room below knows the rule, the scene knows the place: the complaint of a room about a key, at the key's line.
ParameterError placed(const Section& section, const std::string& key, const ParameterError& error);

/// Relative paths start at the scene file.
std::string resolved(const std::filesystem::path& path, const Section& section);

/// In a section whose keys depend on a choice, "the shape 'disc'": throws ParameterError where it lacks a required key
/// of those `chosen`, or writes one that is in `all` only.
void require_keys_of_choice(const Section& section, const std::string& choice, const Parameters& chosen,
                            const Parameters& all);

/// Reads a section whose keys depend on a choice: those of `chosen`, which names it. `what`: "the shape 'disc'".
template <class Fields>
Fields read_of_choice(const Section& section, const std::string& what, Fields chosen) {
  Parameters mine, all;
  chosen.describe(mine);
  Fields every_one;
  every_one.describe(all);
  require_keys_of_choice(section, what, mine, all);
  section.read(chosen);
  return chosen;
}

/// The first step that begins at `time` [s] or later, from 1; n_steps + 1 when none does.
int first_step_from(double time, double time_step, int n_steps);

/// A line of the composition, from anything that prints.
template <class... Parts>
std::string line(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

} // namespace kerf::scene
