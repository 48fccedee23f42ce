#include "study/plan.h"

#include "base/error.h"
#include "scene/composing.h"
#include "scene/grammar.h"
#include "scene/inputs.h"
#include "study/choices.h"
#include "study/closed_form.h"
#include "study/reference_file.h"
#include "study/truth.h"
#include "study/units.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>

namespace kerf::study {

namespace {

using scene::Section;

/// What a section Truth finds, once for each section; the other rows are told what it told the first.
class Truths {
 public:
  explicit Truths(const Plan& plan) : plan_(plan) {
    for (const Norm& norm : plan.norms)
      with_frequency_ = with_frequency_ || norm.parameters.truth == "lowest frequency";
  }

  Reference of(const Section& truth) {
    if (plan_.parameters.unit != "m")
      throw plan_.study.complaint("Unit", "the section Truth finds a displacement in m",
                                  "Ask for one, or leave the section out");
    const auto [found, is_new] = found_.try_emplace(&truth);
    if (is_new)
      found->second = find_truth(truth, {plan_.points, with_frequency_}, truth_cache());
    return found->second;
  }

 private:
  const Plan& plan_;
  bool with_frequency_ = false;
  std::map<const Section*, Reference> found_;
};

/// What a choice, or the study, says its answer should be: as a number, or in one of its sections; `otherwise` where it
/// says nothing.
Reference said_by(const Plan& plan, const Section& section, const Reference& said, Truths& truths,
                  Reference otherwise) {
  const Section *truth = section.find("Truth"), *form = section.find("Closed form"),
                *file = section.find("Reference file");
  if ((said.value != 0) + (truth != nullptr) + (form != nullptr) + (file != nullptr) > 1)
    throw(section.kind().empty() ? plan.study : section)
      .complaint("Reference", "there are two references: a number, a section Truth, Closed form or Reference file",
                 "Leave out all but one of them");
  if (form)
    return evaluate_closed_form(*form, plan.parameters.unit);
  if (file)
    return read_reference_file(*file, plan.parameters.unit);
  return truth ? truths.of(*truth) : said.value != 0 ? said : otherwise;
}

double reference_of(const Norm& norm, const Reference& row) {
  if (norm.reference.value != 0 || norm.parameters.truth == "none")
    return norm.reference.value;
  const double found = norm.parameters.truth == "elastic energy" ? row.energy : row.frequency;
  return std::isfinite(found) ? found : 0;
}

PlannedRow plan_row(const Plan& plan, const std::vector<Axis>& axes, const std::vector<const Choice*>& choices,
                    Truths& truths, Reference reference) {
  PlannedRow row;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const Choice& choice = *choices[i];
    row.name += (row.name.empty() ? "" : ", ") + choice.name;
    if (i == 0 || axes[i].name != plan.parameters.order_over)
      row.family += (row.family.empty() ? "" : ", ") + choice.name;
    row.overrides.insert(row.overrides.end(), choice.sets.begin(), choice.sets.end());
    reference = said_by(plan, *choice.section, choice.reference, truths, reference);
  }
  row.reference = reference;
  for (const Norm& norm : plan.norms)
    row.norm_references.push_back(reference_of(norm, reference));
  row.scene = changed_scene(plan.scene, choices);
  return row;
}

void require_change(const Section& study, const StudyParameters& parameters, const std::vector<Axis>& axes) {
  const auto is_it = [&](const Axis& axis) { return axis.name == parameters.order_over; };
  if (!std::any_of(axes.begin(), axes.end(), is_it))
    throw study.complaint("Order over", "there is no section 'Change " + parameters.order_over + "'",
                          "Name a change of this study, or leave the key out");
}

std::vector<Norm> read_norms(const Section& root) {
  std::vector<Norm> norms;
  for (const Section* section : root.all("Norm")) {
    Norm norm{section->name(), section->read<NormParameters>(), *section, read_reference(*section)};
    std::replace(norm.name.begin(), norm.name.end(), ' ', '_');
    const std::string& truth = norm.parameters.truth;
    const std::string unit = truth == "elastic energy"     ? "J"
                             : truth == "lowest frequency" ? "1/s"
                                                           : norm.parameters.unit;
    if (!is_same_unit(unit, norm.parameters.unit))
      throw section->complaint("Unit", "the " + truth + " of the section Truth has the unit " + unit,
                               "Write 'set Unit = " + unit + "'");
    norms.push_back(std::move(norm));
  }
  return norms;
}

/// The points, then the grid: x fastest.
Points read_points(const Section& section) {
  const auto p = section.read<PointsParameters>();
  Points points = p.points;
  if (p.box.empty() != p.counts.empty() || (!p.box.empty() && p.box.size() != 2))
    throw section.complaint("Box [m]", "a grid has two corners, and counts", "Write both, or leave both out");
  if (!p.counts.empty() && (p.counts.size() != 3 || std::any_of(p.counts.begin(), p.counts.end(),
                                                                [](const double n) { return n != std::floor(n); })))
    throw section.complaint("Counts [1]", "must be three whole numbers", "Write 5, 3, 1");
  std::array<int, 3> n{};
  for (std::size_t d = 0; d < p.counts.size(); ++d)
    n[d] = static_cast<int>(p.counts[d]);
  const auto at = [&](const int d, const int i) {
    return p.box[0][d] + (p.box[1] - p.box[0])[d] * (n[d] > 1 ? double(i) / (n[d] - 1) : 0.5);
  };
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i)
        points.emplace_back(at(0, i), at(1, j), at(2, k));
  if (points.empty())
    throw section.complaint("there are no points", "Write 'set Points [m] = x, y, z; ...', or a box and counts");
  return points;
}

/// Notes which row each case of a change is set in.
void add_cases(const std::vector<Axis>& axes, Plan& plan) {
  for (std::size_t i = 1; i < axes.size(); ++i)
    for (std::size_t c = 0; c < axes[i].choices.size(); ++c) {
      const Choice& choice = axes[i].choices[c];
      PlannedCase one{*choice.section, choice.key, {}};
      for (const std::string& set : choice.sets)
        one.paths.push_back(set.substr(0, set.find('=')));
      std::vector<std::size_t> at(axes.size(), 0);
      std::size_t row = 0;
      do
        if (at[i] == c)
          one.rows.push_back(row);
      while (++row, advance(axes, at));
      if (!one.paths.empty())
        plan.cases.push_back(std::move(one));
    }
}

void require_reference_row(const Plan& plan) {
  const std::string& name = plan.parameters.reference_row;
  const auto is_it = [&](const PlannedRow& row) { return row.name == name; };
  if (!name.empty() && name != "finest" && std::none_of(plan.rows.begin(), plan.rows.end(), is_it))
    throw plan.study.complaint("Reference row", "the study has no such row",
                               "Name one as tables do, such as '" + plan.rows.front().name + "', or write 'finest'");
  if (name == "finest" && plan.parameters.order_over.empty())
    throw plan.study.complaint("Reference row", "there is no finest row: no orders are told over a change",
                               "Write 'set Order over', or the name of a row");
}

/// Points without anything to compare their displacements with.
void require_displacements(const Plan& plan) {
  const auto knows = [&](const PlannedRow& row) { return !row.reference.displacements.empty(); };
  if (!plan.points.empty() && plan.parameters.reference_row.empty() &&
      std::none_of(plan.rows.begin(), plan.rows.end(), knows))
    throw plan.at.complaint("no reference knows the displacement of these points",
                            "Write a section Truth, or 'set Reference row' in the section Study");
}

} // namespace

Plan make_plan(const scene::SceneText& text) {
  const Section root = scene::parse_scene(text, grammar());
  const Section& study = root.require("Study");
  const auto parameters = study.read<StudyParameters>();
  const std::vector<Axis> axes = read_axes(root);
  if (!parameters.order_over.empty())
    require_change(study, parameters, axes);

  Plan plan{parameters, study, scene::standalone_text(text, grammar()), scene::resolved(parameters.scene, study), {}};
  if (!std::ifstream(plan.scene))
    throw DataError(
      study.complaint("Scene", "the scene cannot be read", "Name a file that you may read, from this one's folder")
        .complaint());
  plan.norms = read_norms(root);
  if (const Section* points = root.find("Points")) {
    plan.points = read_points(*points);
    plan.at = *points;
  }
  Truths truths(plan);
  const Reference reference = said_by(plan, root, read_reference(study), truths, {});
  std::vector<std::size_t> at(axes.size(), 0);
  do {
    std::vector<const Choice*> choices;
    for (std::size_t i = 0; i < axes.size(); ++i)
      choices.push_back(&axes[i].choices[at[i]]);
    plan.rows.push_back(plan_row(plan, axes, choices, truths, reference));
  } while (advance(axes, at));
  root.require_all_read();
  add_cases(axes, plan);
  require_reference_row(plan);
  require_displacements(plan);
  return plan;
}

bool has_reference(const Plan& plan) {
  const auto is_known = [](const double value) { return value != 0; };
  return !plan.parameters.reference_row.empty() ||
         std::any_of(plan.rows.begin(), plan.rows.end(), [&](const PlannedRow& row) {
           return is_known(row.reference.value) || !row.reference.displacements.empty() ||
                  std::any_of(row.norm_references.begin(), row.norm_references.end(), is_known);
         });
}

} // namespace kerf::study
