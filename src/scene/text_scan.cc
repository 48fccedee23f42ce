#include "scene/text_scan.h"

#include "scene/text_suggest.h"

#include <algorithm>
#include <fstream>
#include <sstream>

namespace kerf::scene {
namespace {

std::string trimmed(const std::string& text) {
  const char* const blanks = " \t\r\v\f";
  const auto first = text.find_first_not_of(blanks);
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// Words separated by single blanks, so that names compare.
std::string normalised(const std::string& text) {
  std::istringstream in(text);
  std::string name;
  for (std::string word; in >> word;)
    name += (name.empty() ? "" : " ") + word;
  return name;
}

ParameterError syntax_error(const Origin& at, const std::string& path, const std::string& value,
                            const std::string& rule, const std::string& remedy) {
  return ParameterError(Complaint{at.file, at.line, path, value, rule, remedy});
}

class Scanner {
 public:
  Scanner(const std::string& file, WrittenSection& root) : file_(file), open_{&root} { root.origin = {file, 0}; }

  /// One line without comment and continuation, and where it stands.
  void take(const std::string& line, const Lines& lines) {
    if (line.empty())
      return;
    lines_ = lines;
    const Origin at{file_, lines.first};
    const std::string word = line.substr(0, line.find_first_of(" \t=#"));
    const std::string rest = trimmed(line.substr(word.size()));
    if (word == "subsection")
      open(normalised(rest), at);
    else if (word == "end")
      close(rest, at);
    else if (word == "set")
      set(rest, at);
    else if (word == "include")
      throw syntax_error(at, "", line, "a scene is one file: include is not allowed",
                         "Copy the other file's text here, or change single values with --set");
    else
      throw syntax_error(at, path(""), line, "a line must begin with subsection, set or end",
                         suggestion(word, {"subsection", "set", "end"}, ""));
  }

  void finish() const {
    if (open_.size() > 1)
      throw syntax_error(open_.back()->origin, path(""), "", "the subsection is never closed",
                         "Write 'end' after its last line");
  }

 private:
  std::string path(const std::string& last) const {
    std::string text;
    for (std::size_t i = 1; i < open_.size(); ++i)
      text += (text.empty() ? "" : "/") + open_[i]->heading;
    return last.empty() ? text : text.empty() ? last : text + "/" + last;
  }

  void open(const std::string& heading, const Origin& at) {
    if (heading.empty() || heading.find('/') != std::string::npos)
      throw syntax_error(at, path(""), heading, "a subsection must have a heading without '/'",
                         "Write for example 'subsection Time'");
    if (const auto* first = open_.back()->find_section(heading))
      throw syntax_error(at, path(heading), "",
                         "the section is written twice, first in line " + std::to_string(first->origin.line),
                         "Put its keys together, or give it another name");
    open_.back()->sections.push_back({heading, at, lines_, {}, {}});
    open_.push_back(&open_.back()->sections.back());
  }

  void close(const std::string& rest, const Origin& at) {
    if (!rest.empty())
      throw syntax_error(at, path(""), "end " + rest, "'end' must stand alone on its line",
                         "Write what follows on the next line");
    if (open_.size() == 1)
      throw syntax_error(at, "", "end", "there is no open subsection to end",
                         "Remove this line, or an 'end' before it");
    open_.back()->lines.last = lines_.last;
    open_.pop_back();
  }

  void set(const std::string& rest, const Origin& at) {
    const auto equals = rest.find('=');
    const std::string name = normalised(rest.substr(0, equals));
    if (equals == std::string::npos || name.empty())
      throw syntax_error(at, path(""), "set " + rest, "must be 'set KEY = VALUE'", "Write the missing part");
    const std::string value = trimmed(rest.substr(equals + 1));
    if (open_.size() == 1)
      throw syntax_error(at, name, value, "a key must stand in a section",
                         "Write it between 'subsection ...' and 'end'");
    if (const auto* first = open_.back()->find_key(name))
      throw syntax_error(at, path(name), value,
                         "the key is set twice, first in line " + std::to_string(first->origin.line),
                         "Keep one of them");
    open_.back()->keys.push_back({name, value, at, lines_});
  }

  std::string file_;
  Lines lines_;                       // of what is taken
  std::vector<WrittenSection*> open_; // from the root to the innermost open section
};

/// Feeds the logical lines of a text: joined where one ends in a backslash, comments removed.
void scan(const std::string& text, const std::string& file, WrittenSection& root) {
  Scanner scanner(file, root);
  std::istringstream in(text);
  std::string physical, logical;
  int number = 0, first_number = 0;
  bool goes_on = false;
  while (std::getline(in, physical)) {
    ++number;
    if (!goes_on) {
      logical.clear();
      first_number = number;
    }
    std::string line = trimmed(physical);
    std::replace(line.begin(), line.end(), '\t', ' ');
    goes_on = !line.empty() && line.back() == '\\';
    if (goes_on)
      line.pop_back();
    const auto comment = line.find('#');
    if (goes_on && comment != std::string::npos)
      throw syntax_error({file, number}, "", trimmed(physical), "a comment must not swallow the next line",
                         "Remove the backslash at its end");
    logical += line.substr(0, comment);
    if (!goes_on)
      scanner.take(trimmed(logical), {first_number, number});
  }
  if (goes_on)
    throw syntax_error({file, number}, "", physical, "the last line cannot be continued", "Remove the backslash");
  scanner.finish();
}

/// First place of one of `separators` outside of [brackets], from `begin` on.
std::size_t find_outside_brackets(const std::string& text, const char separator, const std::size_t begin) {
  int depth = 0;
  for (std::size_t i = begin; i < text.size(); ++i) {
    if (text[i] == separator && depth == 0)
      return i;
    depth += text[i] == '[' ? 1 : text[i] == ']' && depth > 0 ? -1 : 0;
  }
  return std::string::npos;
}

/// "Body liver/Material/Density [kg/m^3]" -> its three names.
std::vector<std::string> split_path(const std::string& path) {
  std::vector<std::string> names;
  std::size_t begin = 0;
  for (std::size_t end; (end = find_outside_brackets(path, '/', begin)) != std::string::npos; begin = end + 1)
    names.push_back(normalised(path.substr(begin, end - begin)));
  names.push_back(normalised(path.substr(begin)));
  return names;
}

void apply(const std::string& override_text, WrittenSection& root) {
  const Origin at{"--set \"" + override_text + "\"", 0};
  const auto equals = find_outside_brackets(override_text, '=', 0);
  const auto names = split_path(override_text.substr(0, equals));
  const auto is_empty = [](const std::string& name) { return name.empty(); };
  if (equals == std::string::npos || names.size() < 2 || std::any_of(names.begin(), names.end(), is_empty))
    throw syntax_error(at, "", "", "must be \"Section/Key=value\"",
                       "Write every section from the top: \"Body liver/Material/Density [kg/m^3]=1000\"");
  const std::string value = trimmed(override_text.substr(equals + 1));
  if (override_text.find_first_of("#\n\r") != std::string::npos || (!value.empty() && value.back() == '\\'))
    throw syntax_error(at, "", "", "must have no '#', no line break and no backslash at the end",
                       "Write one plain value");

  WrittenSection* section = &root;
  for (std::size_t i = 0; i + 1 < names.size(); ++i) {
    auto* next = section->find_section(names[i]);
    if (!next)
      next = &section->sections.emplace_back(WrittenSection{names[i], at, {}, {}, {}});
    section = next;
  }
  if (auto* key = section->find_key(names.back()))
    *key = {names.back(), value, at, key->lines};
  else
    section->keys.push_back({names.back(), value, at, {}});
}

} // namespace

WrittenSection* WrittenSection::find_section(const std::string& wanted) {
  const auto it = std::find_if(sections.begin(), sections.end(), [&](const auto& s) { return s.heading == wanted; });
  return it == sections.end() ? nullptr : &*it;
}

WrittenKey* WrittenSection::find_key(const std::string& wanted) {
  const auto it = std::find_if(keys.begin(), keys.end(), [&](const auto& k) { return k.name == wanted; });
  return it == keys.end() ? nullptr : &*it;
}

SceneText scan_scene_text(const std::string& text, const std::string& file, const std::vector<std::string>& overrides) {
  const std::string mark = "\xef\xbb\xbf"; // some editors write it before UTF-8; it says nothing
  SceneText scene{file, text.starts_with(mark) ? text.substr(mark.size()) : text, {}};
  scan(scene.text, file, scene.root);
  for (const auto& override_text : overrides)
    apply(override_text, scene.root);
  return scene;
}

SceneText read_scene_text(const std::string& path, const std::vector<std::string>& overrides) {
  constexpr std::size_t most_bytes = 1 << 26;
  std::ifstream in(path, std::ios::binary);
  std::string text(1 << 16, '\0');
  std::size_t n = 0;
  while (in.read(text.data() + n, static_cast<std::streamsize>(text.size() - n)) && n < most_bytes) {
    n = text.size();
    text.resize(2 * n);
  }
  n += n < most_bytes ? static_cast<std::size_t>(in.gcount()) : 0;
  if (n == 0 || n >= most_bytes)
    throw DataError(Complaint{path, 0, "", "", n == 0 ? "the scene cannot be read" : "the scene is longer than 64 MB",
                              "Give the path of a .prm file that exists and is not empty"});
  text.resize(n);
  return scan_scene_text(text, path, overrides);
}

} // namespace kerf::scene
