#include "study/plan.h"

#include "scene/composing.h"
#include "scene/grammar.h"

#include <algorithm>

namespace kerf::study {

namespace {

using scene::Section;

/// One alternative: a variant, or a case of a change.
struct Choice {
  std::string name;
  const Section* section = nullptr;
  std::vector<std::string> sets;
  Reference reference;
};

/// Alternatives of which each row takes one.
struct Axis {
  std::string name; ///< of the change; empty: the variants
  std::vector<Choice> choices;
};

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

Choice read_choice(const Section& section) {
  Choice choice{section.name(), &section, {}, read_reference(section)};
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

std::vector<Axis> read_axes(const Section& root) {
  root.require("Variant");
  std::vector<Axis> axes = {read_axis("", root.all("Variant"))};
  for (const Section* change : root.all("Change")) {
    change->mark_read();
    change->require("Case");
    axes.push_back(read_axis(change->name(), change->all("Case")));
  }
  return axes;
}

/// The scene with the changes of the choices in place, checked against its grammar; what is wrong with a change is told
/// at the line of the study that makes it.
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
          throw choice->section->complaint("Set", scene::line("in '", set, "', ", complaint.path, ": ", complaint.rule),
                                           scene::clause(complaint.remedy));
    throw;
  }
}

PlannedRow plan_row(const std::string& scene, const std::vector<Axis>& axes, const std::vector<const Choice*>& choices,
                    const StudyParameters& study, Reference reference) {
  PlannedRow row;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const Choice& choice = *choices[i];
    row.name += (row.name.empty() ? "" : ", ") + choice.name;
    if (i == 0 || axes[i].name != study.order_over)
      row.family += (row.family.empty() ? "" : ", ") + choice.name;
    row.overrides.insert(row.overrides.end(), choice.sets.begin(), choice.sets.end());
    if (choice.reference.value != 0)
      reference = choice.reference;
  }
  row.reference = reference;
  row.scene = changed_scene(scene, choices);
  return row;
}

/// The next combination, the last axis fastest; false behind the last one.
bool advance(const std::vector<Axis>& axes, std::vector<std::size_t>& at) {
  for (std::size_t i = axes.size(); i-- > 0;) {
    if (++at[i] < axes[i].choices.size())
      return true;
    at[i] = 0;
  }
  return false;
}

void require_change(const Section& study, const StudyParameters& parameters, const std::vector<Axis>& axes) {
  const auto is_it = [&](const Axis& axis) { return axis.name == parameters.order_over; };
  if (!std::any_of(axes.begin(), axes.end(), is_it))
    throw study.complaint("Order over", "there is no section 'Change " + parameters.order_over + "'",
                          "Name a change of this study, or leave the key out");
}

} // namespace

Plan make_plan(const scene::SceneText& text) {
  const Section root = scene::parse_scene(text, grammar());
  const Section& study = root.require("Study");
  const auto parameters = study.read<StudyParameters>();
  const Reference reference = read_reference(study);
  const std::vector<Axis> axes = read_axes(root);
  require_change(study, parameters, axes);
  root.require_all_read();

  Plan plan{parameters, study, text.text, scene::resolved(parameters.scene, study), {}};
  std::vector<std::size_t> at(axes.size(), 0);
  do {
    std::vector<const Choice*> choices;
    for (std::size_t i = 0; i < axes.size(); ++i)
      choices.push_back(&axes[i].choices[at[i]]);
    plan.rows.push_back(plan_row(plan.scene, axes, choices, plan.parameters, reference));
  } while (advance(axes, at));
  return plan;
}

} // namespace kerf::study
