#include "study/choices.h"

#include "scene/composing.h"
#include "scene/grammar.h"
#include "study/ranges.h"

#include <algorithm>
#include <set>

namespace kerf::study {

using scene::Section;

namespace {

Choice read_choice(const Section& section) {
  Choice choice{section.name(), &section, "Set", {}, read_reference(section)};
  const std::string set = section.read<SettingParameters>().set;
  if (!set.empty())
    choice.sets = split(set);
  for (const std::string& one : choice.sets)
    if (one.empty())
      throw section.complaint("Set", "there is nothing between two '|', or before or after one",
                              "Write Section/Key=value | Section/Key=value");
  return choice;
}

Axis read_axis(const std::string& name, const std::vector<const Section*>& sections) {
  Axis axis{name, {}};
  for (const Section* section : sections)
    axis.choices.push_back(read_choice(*section));
  return axis;
}

void require_different_names(const Axis& axis, const Section& section) {
  std::set<std::string> names;
  for (const Choice& choice : axis.choices)
    if (!names.insert(choice.name).second)
      throw section.complaint("there are two cases '" + choice.name + "'", "Leave out one of them");
}

} // namespace

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find('|', begin), list.size());
    const std::string part = list.substr(begin, end - begin);
    const auto first = part.find_first_not_of(' ');
    parts.push_back(first == std::string::npos ? "" : part.substr(first, part.find_last_not_of(' ') - first + 1));
    begin = end + 1;
  }
  return parts;
}

Reference read_reference(const Section& section) {
  const auto parameters = section.read<ReferenceParameters>();
  if (parameters.reference != 0 && parameters.source.empty())
    throw section.complaint("Reference", "a reference must have a source",
                            "Write 'set Reference source = ...': a formula, a table, a finer computation");
  if (parameters.reference == 0 && !parameters.source.empty())
    throw section.complaint("Reference source", "there is no reference that it could be the source of",
                            "Write 'set Reference = ...', not 0");
  return {parameters.reference, parameters.source};
}

std::vector<Axis> read_axes(const Section& root) {
  root.require("Variant");
  std::vector<Axis> axes = {read_axis("", root.all("Variant"))};
  for (const Section* change : root.all("Change")) {
    axes.push_back(read_axis(change->name(), change->all("Case")));
    const std::vector<Choice> values = read_values(*change);
    axes.back().choices.insert(axes.back().choices.end(), values.begin(), values.end());
    if (axes.back().choices.empty())
      change->require("Case");
    require_different_names(axes.back(), *change);
  }
  return axes;
}

bool advance(const std::vector<Axis>& axes, std::vector<std::size_t>& at) {
  for (std::size_t i = axes.size(); i-- > 0;) {
    if (++at[i] < axes[i].choices.size())
      return true;
    at[i] = 0;
  }
  return false;
}

scene::SceneText changed_scene(const std::string& path, const std::vector<const Choice*>& choices) {
  std::vector<std::string> overrides;
  for (const Choice* choice : choices)
    overrides.insert(overrides.end(), choice->sets.begin(), choice->sets.end());
  try {
    scene::SceneText text = scene::read_scene_text(path, overrides);
    scene::parse_scene(text, scene::grammar());
    std::erase_if(text.root.sections,
                  [](const auto& section) { return section.heading == "Images" || section.heading == "Surface file"; });
    return text;
  } catch (const ParameterError& error) {
    const Complaint& complaint = error.complaint();
    for (const Choice* choice : choices)
      for (const std::string& set : choice->sets)
        if (complaint.file == "--set \"" + set + "\"")
          throw choice->section->complaint(choice->key,
                                           scene::line("in '", set, "', ", complaint.path, ": ", complaint.rule),
                                           scene::clause(complaint.remedy));
    throw;
  }
}

} // namespace kerf::study
