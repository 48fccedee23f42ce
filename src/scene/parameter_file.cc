#include "scene/parameter_file.h"

#include <deal.II/base/exceptions.h>
#include <deal.II/base/parameter_handler.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace kerf::scene {
namespace {

void declare(dealii::ParameterHandler& handler, const WrittenSection& parent, const std::vector<SectionKind>& kinds) {
  for (const auto& section : parent.sections) {
    const SectionKind& kind = *match_heading(section.heading, kinds).kind;
    handler.enter_subsection(section.heading);
    for (const auto& key : keys(kind))
      handler.declare_entry(key.name, key.fallback, dealii::Patterns::Anything(), key.text);
    declare(handler, section, kind.children);
    handler.leave_subsection();
  }
}

/// The written scene with overrides in place.
void print(std::ostream& out, const WrittenSection& parent) {
  for (const auto& key : parent.keys)
    out << "set " << key.name << " = " << key.value << "\n";
  for (const auto& section : parent.sections) {
    out << "subsection " << section.heading << "\n";
    print(out, section);
    out << "end\n";
  }
}

void parse(dealii::ParameterHandler& handler, const SceneText& scene, const std::vector<SectionKind>& grammar) {
  declare(handler, scene.root, grammar);
  std::ostringstream text;
  print(text, scene.root);
  handler.parse_input_from_string(text.str());
}

/// deal.II's messages carry stack traces; whatever our checks let through is told without one.
[[noreturn]] void throw_unforeseen(const SceneText& scene, const std::string& what) {
  throw ParameterError(Complaint{scene.file, 0, "", "", "the scene cannot be parsed: " + what,
                                 "Compare its sections with what 'kerf params' prints"});
}

std::string joined(const std::string& path, const std::string& name) { return path.empty() ? name : path + "/" + name; }

} // namespace

/// Makes sections out of what deal.II parsed.
class SectionReader {
 public:
  explicit SectionReader(dealii::ParameterHandler& handler) : handler_(handler) {}

  void read_sections(Section& parent, const WrittenSection& written, const std::vector<SectionKind>& kinds) {
    for (const auto& child : written.sections) {
      const auto heading = match_heading(child.heading, kinds);
      handler_.enter_subsection(child.heading);
      Section& section = parent.sections_.emplace_back();
      section.kind_ = heading.kind->kind;
      section.name_ = heading.name;
      section.path_ = joined(parent.path_, child.heading);
      section.origin_ = child.origin;
      read_values(section, child, *heading.kind);
      read_sections(section, child, heading.kind->children);
      handler_.leave_subsection();
    }
  }

 private:
  void read_values(Section& section, const WrittenSection& written, const SectionKind& kind) {
    for (const auto& key : keys(kind)) {
      Section::Value value{key.name, handler_.get(key.name), std::nullopt};
      for (const auto& written_key : written.keys)
        if (written_key.name == key.name)
          value.origin = written_key.origin;
      section.values_.push_back(value);
    }
  }

  dealii::ParameterHandler& handler_;
};

Section parse_scene(const SceneText& scene, const std::vector<SectionKind>& grammar) {
  check_scene(scene.root, grammar);
  try {
    dealii::ParameterHandler handler;
    parse(handler, scene, grammar);
    Section root;
    root.origin_ = scene.root.origin;
    SectionReader(handler).read_sections(root, scene.root, grammar);
    return root;
  } catch (const dealii::ExceptionBase& error) {
    std::ostringstream what;
    error.print_info(what);
    throw_unforeseen(scene, what.str());
  } catch (const std::exception& error) {
    throw_unforeseen(scene, error.what());
  }
}

std::vector<const Section*> Section::all(const std::string& kind) const {
  std::vector<const Section*> found;
  for (const auto& section : sections_)
    if (section.kind_ == kind)
      found.push_back(&section);
  return found;
}

const Section* Section::find(const std::string& kind) const {
  const auto it = std::find_if(sections_.begin(), sections_.end(), [&](const Section& s) { return s.kind_ == kind; });
  return it == sections_.end() ? nullptr : &*it;
}

const Section& Section::require(const std::string& kind) const {
  if (const auto* section = find(kind))
    return *section;
  throw ParameterError(Complaint{origin_.file, origin_.line, joined(path_, kind), "", "the section must be written",
                                 "Write 'subsection " + kind + "' and its 'end'"});
}

const Section::Value* Section::find_value(const std::string& key) const {
  const auto it = std::find_if(values_.begin(), values_.end(), [&](const Value& v) { return v.key == key; });
  return it == values_.end() ? nullptr : &*it;
}

bool Section::writes(const std::string& key) const {
  const auto* value = find_value(key);
  return value && value->origin;
}

void Section::assign(const Parameters& parameters) const {
  read_ = true;
  for (const auto& parameter : parameters.list()) {
    const auto* value = find_value(parameter.name);
    if (!value)
      throw std::logic_error("the grammar of section '" + path_ + "' has no key '" + parameter.name + "'");
    const std::string wrong = parameter.assign(value->text);
    if (!wrong.empty())
      throw complaint(parameter.name, wrong, parameter.text);
    read_keys_.insert(parameter.name);
  }
}

ParameterError Section::complaint(const std::string& key, const std::string& rule, const std::string& remedy) const {
  const auto* value = find_value(key);
  const Origin& at = value && value->origin ? *value->origin : origin_;
  return ParameterError(Complaint{at.file, at.line, joined(path_, key), value ? value->text : "", rule, remedy});
}

ParameterError Section::complaint(const std::string& rule, const std::string& remedy) const {
  return ParameterError(Complaint{origin_.file, origin_.line, path_, "", rule, remedy});
}

std::vector<Complaint> Section::unread() const {
  const bool only_holds_sections = values_.empty() && (!sections_.empty() || path_.empty());
  if (!read_ && !only_holds_sections)
    return {complaint("nothing reads this section", "Remove it, or write what uses it").complaint()};
  std::vector<Complaint> all;
  for (const auto& value : values_)
    if (value.origin && !read_keys_.count(value.key))
      all.push_back(complaint(value.key, "nothing reads this key", "Remove it, or write what uses it").complaint());
  for (const auto& section : sections_) {
    const auto below = section.unread();
    all.insert(all.end(), below.begin(), below.end());
  }
  return all;
}

void Section::require_all_read() const {
  const auto all = unread();
  if (!all.empty())
    throw ParameterError(all.front());
}

std::string effective_text(const Section& root) {
  std::string text;
  for (const auto& value : root.values_)
    text += "set " + value.key + " = " + value.text + "\n";
  for (const auto& section : root.sections_)
    text += "subsection " + section.kind_ + (section.name_.empty() ? "" : " " + section.name_) + "\n" +
            effective_text(section) + "end\n";
  return text;
}

} // namespace kerf::scene
