#include "scene/text_print.h"

#include "scene/observables.h"

#include <sstream>

namespace kerf::scene {
namespace {

constexpr std::size_t page_width = 100;

/// Words as comment lines.
void print_comment(std::ostream& out, const std::string& text, const std::string& indent) {
  std::istringstream words(text);
  std::string line = indent + "#";
  for (std::string word; words >> word;) {
    if (line.size() + 1 + word.size() > page_width && line.size() > indent.size() + 1) {
      out << line << "\n";
      line = indent + "#";
    }
    line += " " + word;
  }
  if (line.size() > indent.size() + 1)
    out << line << "\n";
}

void print_key(std::ostream& out, const Parameter& key, const std::string& indent) {
  print_comment(out, key.text, indent);
  print_comment(out, (key.required ? "Must be set; " : "") + key.rule + ".", indent);
  // The initial value of a key that must be set need not be a legal one.
  const bool legal = key.check(key.fallback).empty() && !key.fallback.empty();
  out << indent << "set " << key.name << " =" << (legal ? " " + key.fallback : "") << "\n";
}

void print_kinds(std::ostream& out, const std::vector<SectionKind>& kinds, const std::string& indent) {
  for (const auto& kind : kinds) {
    if (&kind != &kinds.front())
      out << "\n";
    const bool named = kind.occurrence != Occurrence::once;
    print_comment(out, kind.text, indent);
    if (named)
      print_comment(out, "As often as needed, each with a name of its own in place of NAME.", indent);
    out << indent << "subsection " << kind.kind << (named ? " NAME" : "") << "\n";
    const auto list = keys(kind);
    for (const auto& key : list)
      print_key(out, key, indent + "  ");
    if (!list.empty() && !kind.children.empty())
      out << "\n";
    print_kinds(out, kind.children, indent + "  ");
    out << indent << "end\n";
  }
}

} // namespace

std::string print_parameters(const std::vector<SectionKind>& grammar) {
  std::ostringstream out;
  print_kinds(out, grammar, "");
  return out.str();
}

std::string print_observables() {
  std::ostringstream out;
  print_comment(out, "Observables, for Names of the section Observables: name [unit]: meaning.", "");
  for (const Observable& one : body_observables())
    print_comment(out, one.name + " [" + one.unit + "]: " + one.source + ".", "");
  for (const ObservableGroup& group : observable_groups())
    print_comment(out, group.name + " [" + group.unit + "]: " + group.text + ".", "");
  return out.str();
}

} // namespace kerf::scene
