#include "scene/text_grammar.h"

#include "scene/text_suggest.h"

#include <algorithm>
#include <cctype>

namespace kerf::scene {
namespace {

std::string heading_of(const SectionKind& kind) {
  return kind.kind + (kind.occurrence == Occurrence::once ? "" : " NAME");
}

/// What stands in `heading` after as many words as `kind` has; "NAME" when nothing does.
std::string name_part(const std::string& heading, const std::string& kind) {
  std::size_t begin = 0;
  for (auto n_words = 1 + std::count(kind.begin(), kind.end(), ' '); n_words > 0; --n_words) {
    begin = heading.find(' ', begin);
    if (begin == std::string::npos)
      return "NAME";
    ++begin;
  }
  return heading.substr(begin);
}

/// Paths of the sections below `kinds` that have a key or section called `word`.
std::vector<std::string> owners(const std::string& word, const std::vector<SectionKind>& kinds,
                                const std::string& path) {
  std::vector<std::string> found;
  for (const auto& kind : kinds) {
    const std::string here = (path.empty() ? "" : path + "/") + heading_of(kind);
    const auto list = keys(kind);
    if (std::any_of(list.begin(), list.end(), [&](const Parameter& p) { return p.name == word; }) ||
        match_heading(word, kind.children).kind)
      found.push_back(here);
    const auto below = owners(word, kind.children, here);
    found.insert(found.end(), below.begin(), below.end());
  }
  return found;
}

class Checker {
 public:
  explicit Checker(const std::vector<SectionKind>& grammar) : grammar_(grammar) {}

  void check_sections(const WrittenSection& parent, const std::vector<SectionKind>& kinds, const std::string& path) {
    for (const auto& section : parent.sections) {
      const std::string here = (path.empty() ? "" : path + "/") + section.heading;
      const auto match = match_heading(section.heading, kinds);
      if (!match.kind)
        throw unknown_section(section, kinds, here);
      check_name(section, match, here);
      check_is_meant(section, match, parent, here);
      check_keys(section, keys(*match.kind), here);
      check_sections(section, match.kind->children, here);
    }
  }

 private:
  static ParameterError error(const Origin& at, const std::string& path, const std::string& value,
                              const std::string& rule, const std::string& remedy) {
    return ParameterError(Complaint{at.file, at.line, path, value, rule, remedy});
  }

  /// The nearest name here, or the sections that have exactly this name, or what is allowed here.
  std::string remedy(const std::string& word, const std::vector<std::string>& names, const std::string& if_none) const {
    const auto elsewhere = owners(word, grammar_, "");
    if (nearest(word, names) || elsewhere.empty())
      return suggestion(word, names, if_none);
    std::string places;
    for (const auto& place : elsewhere)
      places += (places.empty() ? "" : " or ") + ("'" + place + "'");
    return "It belongs in " + places;
  }

  ParameterError unknown_section(const WrittenSection& section, const std::vector<SectionKind>& kinds,
                                 const std::string& path) const {
    std::vector<std::string> headings;
    for (const auto& kind : kinds)
      headings.push_back(kind.occurrence == Occurrence::once ? kind.kind
                                                             : kind.kind + " " + name_part(section.heading, kind.kind));
    const auto is_prefix = [&](const SectionKind& kind) { return section.heading.starts_with(kind.kind + " "); };
    const auto nameless = std::find_if(kinds.begin(), kinds.end(), is_prefix);
    if (nameless != kinds.end() && !nearest(section.heading, headings))
      return error(section.origin, path, "", "the section '" + nameless->kind + "' takes no name",
                   "Write 'subsection " + nameless->kind + "'");
    return error(section.origin, path, "", "there is no such section here",
                 remedy(section.heading, headings, "No sections are allowed here"));
  }

  static void check_name(const WrittenSection& section, const Heading& match, const std::string& path) {
    if (match.kind->occurrence == Occurrence::once)
      return;
    if (match.name.empty())
      throw error(section.origin, path, "", "the section must have a name",
                  "Write for example 'subsection " + match.kind->kind + " first'");
    // Names become groups of an HDF5 file and parts of file names.
    const bool is_title = match.kind->occurrence == Occurrence::titled;
    if (match.name.find_first_not_of(is_title ? title_characters() : name_characters()) != std::string::npos)
      throw error(section.origin, path, match.name,
                  is_title ? "a name must be letters, digits, '_', '-', '.' and blanks"
                           : "a name must be letters, digits, '_' and '-'",
                  "Write for example 'subsection " + match.kind->kind + " first'");
    constexpr std::size_t most = 100; // of the 255 bytes of a file's name
    if (match.name.size() > most)
      throw error(section.origin, path, "", "a name must have at most " + std::to_string(most) + " characters",
                  "Write a shorter one");
  }

  static std::string without_digits(std::string text) {
    std::erase_if(text, [](const unsigned char c) { return std::isdigit(c) != 0; });
    return text;
  }
  /// An override may add a section, but not where its name looks like a slip. Numbers may differ.
  static void check_is_meant(const WrittenSection& section, const Heading& match, const WrittenSection& parent,
                             const std::string& path) {
    if (!section.origin.is_override() || match.kind->occurrence == Occurrence::once)
      return;
    std::vector<std::string> in_scene;
    for (const WrittenSection& other : parent.sections)
      if (!other.origin.is_override() && other.heading.starts_with(match.kind->kind + " ")) {
        const std::string name = other.heading.substr(match.kind->kind.size() + 1);
        if (without_digits(name) != without_digits(match.name))
          in_scene.push_back(name);
      }
    if (const auto meant = nearest(match.name, in_scene))
      throw error(section.origin, path, "", "there is no such section in the scene",
                  "Did you mean '" + match.kind->kind + " " + *meant +
                    "'? A new one must have a name that is less like it");
  }

  void check_keys(const WrittenSection& section, const std::vector<Parameter>& allowed, const std::string& path) const {
    for (const auto& key : section.keys)
      check_key(key, allowed, path);
    for (const auto& parameter : allowed) {
      const auto is_it = [&](const WrittenKey& key) { return key.name == parameter.name && !key.value.empty(); };
      if (parameter.required && std::none_of(section.keys.begin(), section.keys.end(), is_it))
        throw error(section.origin, path + "/" + parameter.name, "",
                    "the section must set this key, which " + parameter.rule,
                    "Write 'set " + parameter.name + " = ...': " + parameter.text);
    }
  }

  void check_key(const WrittenKey& key, const std::vector<Parameter>& allowed, const std::string& path) const {
    const auto it =
      std::find_if(allowed.begin(), allowed.end(), [&](const Parameter& p) { return p.name == key.name; });
    if (it == allowed.end()) {
      std::vector<std::string> names;
      for (const auto& parameter : allowed)
        names.push_back(parameter.name);
      throw error(key.origin, path + "/" + key.name, key.value, "there is no such key in this section",
                  remedy(key.name, names, "This section has no keys"));
    }
    const std::string rule = it->check(key.value);
    if (rule.empty() || (it->required && key.value.empty())) // a missing key, told as such
      return;
    const auto word = nearest(key.value, it->words);
    std::string text = it->text;
    if (!it->fallback.empty() && it->check(it->fallback).empty()) {
      if (text.ends_with('.')) // which the complaint has
        text.pop_back();
      text += (it->required ? " (such as " : " (default ") + it->fallback + ")";
    }
    throw error(key.origin, path + "/" + key.name, key.value, rule, word ? "Did you mean '" + *word + "'?" : text);
  }

  const std::vector<SectionKind>& grammar_;
};

} // namespace

const std::string& name_characters() {
  static const std::string all = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-";
  return all;
}

const std::string& title_characters() {
  static const std::string all = name_characters() + ". ";
  return all;
}

std::vector<Parameter> keys(const SectionKind& kind) {
  Parameters parameters;
  if (kind.describe)
    kind.describe(parameters);
  return parameters.list();
}

Heading match_heading(const std::string& heading, const std::vector<SectionKind>& kinds) {
  Heading best;
  for (const auto& kind : kinds) {
    if (heading == kind.kind)
      return {&kind, ""};
    // "Body force left" is a 'Body force', not a 'Body' called "force left".
    if (kind.occurrence != Occurrence::once && heading.starts_with(kind.kind + " ") &&
        (!best.kind || kind.kind.size() > best.kind->kind.size()))
      best = {&kind, heading.substr(kind.kind.size() + 1)};
  }
  return best;
}

void check_scene(const WrittenSection& root, const std::vector<SectionKind>& grammar) {
  Checker(grammar).check_sections(root, grammar, "");
}

} // namespace kerf::scene
