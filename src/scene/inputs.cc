#include "scene/inputs.h"

#include "base/sha256.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <sstream>

namespace kerf::scene {

namespace {

using Kinds = std::vector<SectionKind>;

std::string absolute(const std::string& path, const SceneText& scene) {
  const auto folder = std::filesystem::absolute(scene.file).parent_path();
  return (std::filesystem::path(path).is_relative() ? folder / path : std::filesystem::path(path))
    .lexically_normal()
    .string();
}

/// Where a scene can say it: # begins a comment.
std::string absolute_in_text(const std::string& path, const SceneText& scene) {
  const std::string full = absolute(path, scene);
  return full.find('#') == std::string::npos ? full : path;
}

bool names_file(const WrittenKey& key, const SectionKind& kind) {
  const auto all = keys(kind);
  return !key.value.empty() &&
         std::any_of(all.begin(), all.end(), [&](const Parameter& p) { return p.is_file && p.name == key.name; });
}

/// Calls f(key, kind of its section) for every key that is written, from the top.
using Visit = std::function<void(const WrittenKey&, const SectionKind&)>;
void for_each_key(const WrittenSection& parent, const Kinds& kinds, const Visit& f) {
  for (const WrittenSection& section : parent.sections) {
    const SectionKind* const kind = match_heading(section.heading, kinds).kind;
    if (!kind)
      continue; // whoever composes the scene says so
    for (const WrittenKey& key : section.keys)
      f(key, *kind);
    for_each_key(section, kind->children, f);
  }
}

/// What takes the place of lines of the text, by number; what is inserted before a line.
struct Changes {
  std::map<int, std::string> instead, before;
};

std::string set_line(const std::string& name, const std::string& value, const std::string& why) {
  return "set " + name + " = " + value + (why.empty() ? "" : " # " + why) + "\n";
}

class Editor {
 public:
  Editor(const SceneText& scene, const Kinds& grammar) : scene_(scene) {
    for_each_key(scene.root, grammar, [&](const WrittenKey& key, const SectionKind& kind) {
      values_[&key] = names_file(key, kind) ? absolute_in_text(key.value, scene) : key.value;
    });
  }

  std::string edited() {
    change(scene_.root, past_the_end);
    std::istringstream in(scene_.text);
    std::string text, line;
    for (int number = 1; std::getline(in, line); ++number) {
      text += changes_.before[number];
      const auto other = changes_.instead.find(number);
      const std::string indent = line.substr(0, std::min(line.find_first_not_of(" \t"), line.size()));
      text += other == changes_.instead.end() ? line + "\n" : other->second.empty() ? "" : indent + other->second;
    }
    return text + changes_.before[past_the_end];
  }

 private:
  static constexpr int past_the_end = 1 << 30;

  std::string value_of(const WrittenKey& key) const {
    const auto found = values_.find(&key);
    return found == values_.end() ? key.value : found->second;
  }

  /// `end`: the line of the section's end.
  void change(const WrittenSection& parent, const int end) {
    for (const WrittenKey& key : parent.keys)
      change(key, end);
    for (const WrittenSection& section : parent.sections)
      if (section.lines.first > 0)
        change(section, section.lines.last);
      else
        changes_.before[end] += print(section);
  }

  void change(const WrittenKey& key, const int end) {
    const bool is_overridden = key.origin.line == 0;
    if (!is_overridden && value_of(key) == key.value)
      return;
    const std::string line = set_line(key.name, value_of(key), is_overridden ? "--set" : "");
    if (key.lines.first == 0) {
      changes_.before[end] += line;
      return;
    }
    for (int number = key.lines.first; number <= key.lines.last; ++number)
      changes_.instead[number] = number == key.lines.first ? line : "";
  }

  std::string print(const WrittenSection& section) const {
    std::string text = "subsection " + section.heading + " # --set\n";
    for (const WrittenKey& key : section.keys)
      text += set_line(key.name, value_of(key), "");
    for (const WrittenSection& child : section.sections)
      text += print(child);
    return text + "end\n";
  }

  const SceneText& scene_;
  std::map<const WrittenKey*, std::string> values_;
  Changes changes_;
};

} // namespace

std::string standalone_text(const SceneText& scene, const Kinds& grammar) { return Editor(scene, grammar).edited(); }

std::vector<std::string> input_files(const SceneText& scene, const Kinds& grammar) {
  std::vector<std::string> paths;
  for_each_key(scene.root, grammar, [&](const WrittenKey& key, const SectionKind& kind) {
    if (!names_file(key, kind))
      return;
    const std::string path = absolute(key.value, scene);
    if (std::find(paths.begin(), paths.end(), path) == paths.end())
      paths.push_back(path);
  });
  return paths;
}

std::vector<std::string> hashes_of_inputs(const SceneText& scene, const Kinds& grammar) {
  std::vector<std::string> lines;
  for (const std::string& path : input_files(scene, grammar))
    lines.push_back(sha256_of_file(path) + "  " + path);
  return lines;
}

} // namespace kerf::scene
