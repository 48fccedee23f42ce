#include "study/plan.h"

#include "scene/composing.h"
#include "scene/grammar.h"
#include "scene/inputs.h"
#include "study/choices.h"
#include "study/truth.h"

#include <algorithm>

namespace kerf::study {

namespace {

using scene::Section;

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

void require_change(const Section& study, const StudyParameters& parameters, const std::vector<Axis>& axes) {
  const auto is_it = [&](const Axis& axis) { return axis.name == parameters.order_over; };
  if (!std::any_of(axes.begin(), axes.end(), is_it))
    throw study.complaint("Order over", "there is no section 'Change " + parameters.order_over + "'",
                          "Name a change of this study, or leave the key out");
}

/// The reference of the study: what it says, or what its section Truth finds.
Reference reference_of(const Section& root, const Section& study, const StudyParameters& parameters) {
  const Reference said = read_reference(study);
  const Section* truth = root.find("Truth");
  if (!truth)
    return said;
  if (said.value != 0)
    throw study.complaint("Reference", "there is a section Truth that finds one", "Leave out one of them");
  if (parameters.unit != "m")
    throw study.complaint("Unit", "the section Truth finds a displacement in m",
                          "Ask for one, or leave the section out");
  return find_truth(*truth, truth_cache());
}

} // namespace

Plan make_plan(const scene::SceneText& text) {
  const Section root = scene::parse_scene(text, grammar());
  const Section& study = root.require("Study");
  const auto parameters = study.read<StudyParameters>();
  const std::vector<Axis> axes = read_axes(root);
  require_change(study, parameters, axes);
  const Reference reference = reference_of(root, study, parameters);
  root.require_all_read();

  Plan plan{parameters, study, scene::standalone_text(text, grammar()), scene::resolved(parameters.scene, study), {}};
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
