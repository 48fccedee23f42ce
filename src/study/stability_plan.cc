#include "study/stability_plan.h"

#include "scene/composing.h"
#include "scene/grammar.h"
#include "scene/inputs.h"
#include "study/choices.h"

#include <algorithm>

namespace kerf::study {

namespace {

using scene::keys_of;
using scene::Occurrence;
using scene::Section;

const std::string step_key = "Time step [s]", end_key = "End time [s]";

std::vector<scene::SectionKind> stability_grammar() {
  std::vector<scene::SectionKind> kinds = grammar();
  kinds.front() = {"Stability", Occurrence::once, "What is run.", keys_of<StabilityParameters>(), {}};
  kinds.push_back(
    {"Sweep", Occurrence::named, "Which cases are combined, and asked what.", keys_of<SweepParameters>(), {}});
  return kinds;
}

std::vector<std::string> names_in(const std::string& list) {
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin < list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string part = list.substr(begin, end - begin);
    if (const auto first = part.find_first_not_of(' '); first != std::string::npos)
      names.push_back(part.substr(first, part.find_last_not_of(' ') - first + 1));
    begin = end + 1;
  }
  return names;
}

template <class Named>
void require_known(const Section& sweep, const std::string& key, const std::vector<std::string>& names,
                   const std::vector<Named>& known, const std::string& kind) {
  for (const std::string& name : names)
    if (std::none_of(known.begin(), known.end(), [&](const Named& one) { return one.name == name; }))
      throw sweep.complaint(key, "there is no section '" + kind + " " + name + "'",
                            "Name sections of this study, separated by commas");
}

/// The axes of a sweep: all cases of what it names, the first case of what it does not.
std::vector<Axis> axes_of(const Section& section, const SweepParameters& sweep, std::vector<Axis> axes) {
  const auto variants = names_in(sweep.variants), changes = names_in(sweep.changes);
  require_known(section, "Variants", variants, axes[0].choices, "Variant");
  require_known(section, "Changes", changes, std::vector<Axis>(axes.begin() + 1, axes.end()), "Change");
  const auto is_in = [](const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (!variants.empty())
    std::erase_if(axes[0].choices, [&](const Choice& variant) { return !is_in(variants, variant.name); });
  for (std::size_t i = 1; i < axes.size(); ++i)
    if (!is_in(changes, axes[i].name))
      axes[i].choices.resize(1);
  return axes;
}

void add_cases(const Section& section, const std::vector<Axis>& all, StabilityPlan& plan) {
  const auto sweep = section.read<SweepParameters>();
  const std::vector<Axis> axes = axes_of(section, sweep, all);
  std::vector<std::size_t> at(axes.size(), 0);
  do {
    StabilityCase one{
      .sweep = section.name(), .variant = axes[0].choices[at[0]].name, .cases = {}, .overrides = {}, .scene = {}};
    one.ask = sweep.ask == "largest step" ? Ask::largest_step : Ask::outcome;
    std::vector<const Choice*> choices;
    for (std::size_t i = 0; i < axes.size(); ++i) {
      choices.push_back(&axes[i].choices[at[i]]);
      one.overrides.insert(one.overrides.end(), choices.back()->sets.begin(), choices.back()->sets.end());
      if (i > 0 && axes[i].choices.size() > 1)
        one.cases += (one.cases.empty() ? "" : ", ") + choices.back()->name;
    }
    one.scene = changed_scene(plan.parameters.scene, choices);
    const double dt =
      scene::parse_scene(one.scene, scene::grammar()).require("Time").read<scene::TimeParameters>().time_step;
    one.scene = with_step(one.scene, dt, plan.parameters.n_steps);
    plan.cases.push_back(std::move(one));
  } while (advance(axes, at));
}

} // namespace

void StabilityParameters::describe(Parameters& p) {
  p.text("Title", title, "What is asked, in a sentence.");
  p.file("Scene", scene, "The scene that all rows run, relative to this file. Its first body is watched.");
  p.require_last();
  p.integer("Steps [1]", n_steps, {.min = 1, .max = 1e6}, "Of every row, whatever their length.");
}

void SweepParameters::describe(Parameters& p) {
  p.text("Variants", variants, "Names of those that are run, separated by commas. Empty: all.");
  p.text("Changes", changes,
         "Names of those whose cases are combined, separated by commas. Of the others each row takes the first case.");
  p.choice("Ask", ask, {"outcome", "largest step"},
           "What becomes of the body; or the longest time step with which its energy at most doubles, by bisection.");
}

bool is_stability_study(const scene::SceneText& text) {
  return std::any_of(text.root.sections.begin(), text.root.sections.end(),
                     [](const scene::WrittenSection& section) { return section.heading == "Stability"; });
}

StabilityPlan make_stability_plan(const scene::SceneText& text) {
  const Section root = scene::parse_scene(text, stability_grammar());
  const Section& study = root.require("Stability");
  StabilityPlan plan{study.read<StabilityParameters>(), scene::standalone_text(text, stability_grammar()), {}};
  plan.parameters.scene = scene::resolved(plan.parameters.scene, study);
  const std::vector<Axis> axes = read_axes(root);
  root.require("Sweep");
  for (const Section* sweep : root.all("Sweep"))
    add_cases(*sweep, axes, plan);
  root.require_all_read();
  return plan;
}

scene::SceneText with_step(const scene::SceneText& scene, const double time_step, const int n_steps) {
  scene::SceneText changed = scene;
  scene::WrittenSection& time = *changed.root.find_section("Time");
  time.find_key(step_key)->value = to_text(time_step);
  time.find_key(end_key)->value = to_text(n_steps * time_step);
  return changed;
}

} // namespace kerf::study
