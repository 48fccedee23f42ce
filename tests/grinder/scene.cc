#include "tests/grinder/scene.h"

#include "base/parameters.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <numeric>

namespace kerf::grinder {

namespace {

std::string stripped(const std::string& line) {
  const std::string code = line.substr(0, line.find('#'));
  const std::size_t first = code.find_first_not_of(" \t"), last = code.find_last_not_of(" \t\r");
  return first == std::string::npos ? "" : code.substr(first, last - first + 1);
}

/// Where a key's value begins in a section, and how long it is; nothing when it is not written there.
std::optional<std::pair<std::size_t, std::size_t>> place_of(const std::string& section, const std::string& key) {
  const std::size_t line = section.find("set " + key);
  if (line == std::string::npos)
    return {};
  const std::size_t begin = section.find_first_not_of(" =", line + 4 + key.size());
  return std::pair{begin, section.find('\n', begin) - begin};
}

} // namespace

std::string section(const std::string& heading, const std::vector<std::string>& lines) {
  std::string all = "subsection " + heading + "\n";
  for (const std::string& line : lines)
    all += line.starts_with("subsection") ? line : "  set " + line + "\n";
  return all + "end\n";
}

std::string text(const Scene& scene) {
  return std::accumulate(scene.sections.begin(), scene.sections.end(), std::string());
}

Scene read_scene(const std::filesystem::path& path) {
  Scene scene{{}, path.stem().string(), path.string()};
  std::ifstream file(path);
  int depth = 0;
  for (std::string raw; std::getline(file, raw);) {
    const std::string line = stripped(raw);
    if (line.empty())
      continue;
    if (depth == 0)
      scene.sections.emplace_back();
    scene.sections.back() += line + '\n';
    depth += line.starts_with("subsection ") ? 1 : line == "end" ? -1 : 0;
  }
  return scene;
}

bool is_tool(const std::string& section) {
  constexpr std::array tools = {"Blade ", "Scissors ", "Cut surface ", "Forceps "};
  return std::any_of(tools.begin(), tools.end(),
                     [&](const char* const tool) { return section.starts_with("subsection " + std::string(tool)); });
}

std::optional<double> number_of(const Scene& scene, const std::string& key) {
  for (const std::string& section : scene.sections)
    if (const auto place = place_of(section, key))
      return std::stod(section.substr(place->first, place->second));
  return {};
}

Scene with_number(Scene scene, const std::string& key, const double number) {
  for (std::string& section : scene.sections)
    if (const auto place = place_of(section, key)) {
      section.replace(place->first, place->second, to_text(number));
      break;
    }
  return scene;
}

} // namespace kerf::grinder
