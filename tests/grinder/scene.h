#pragma once

/// Scenes as lists of sections, so that they can be drawn, changed and made smaller.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace kerf::grinder {

/// A section of a scene: its heading, and a line a key ("Key = value") or section inside.
std::string section(const std::string& heading, const std::vector<std::string>& lines);

struct Scene {
  std::vector<std::string> sections;
  std::string story;              ///< in a few words
  std::string file = "scene.prm"; ///< relative paths in it start at its folder
};

/// As `kerf run` reads it.
std::string text(const Scene& scene);

/// The sections of a file, without comments.
Scene read_scene(const std::filesystem::path& path);

/// Whether the section is one of a tool: a scene without it still is one.
bool is_tool(const std::string& section);

/// The number that the first of its keys of this name has; nothing when none is written.
std::optional<double> number_of(const Scene& scene, const std::string& key);

/// The scene with another number at the first of its keys of this name, which must be written.
Scene with_number(Scene scene, const std::string& key, double number);

} // namespace kerf::grinder
