#include "scene/composing.h"

#include <algorithm>
#include <cmath>

namespace kerf::scene {

std::string clause(const std::string& sentence) { return sentence.substr(0, sentence.find_last_not_of(" .") + 1); }

ParameterError placed(const Section& section, const std::string& key, const ParameterError& error) {
  const Complaint& complaint = error.complaint();
  const std::string detail = complaint.value.empty() ? "" : " (here " + complaint.value + ")";
  return section.complaint(key, complaint.rule + detail, clause(complaint.remedy));
}

std::string resolved(const std::filesystem::path& path, const Section& section) {
  const auto folder = std::filesystem::path(section.origin().file).parent_path();
  return (path.is_relative() ? folder / path : path).string();
}

void require_keys_of_choice(const Section& section, const std::string& choice, const Parameters& chosen,
                            const Parameters& all) {
  std::string names;
  for (const Parameter& key : chosen.list()) {
    names += (names.empty() ? "" : ", ") + key.name;
    if (key.required && !section.writes(key.name))
      throw section.complaint(choice + " must have the key '" + key.name + "'",
                              "Write 'set " + key.name + " = ...'. " + key.text);
  }
  for (const Parameter& key : all.list()) {
    const auto is_it = [&](const Parameter& p) { return p.name == key.name; };
    if (section.writes(key.name) && std::none_of(chosen.list().begin(), chosen.list().end(), is_it))
      throw section.complaint(key.name, choice + " does not read this key",
                              "Remove it: the keys of " + choice + " are " + names);
  }
}

int first_step_from(const double time, const double time_step, const int n_steps) {
  constexpr double rounding = 1e-6; // of a step: a time that is a multiple of it is meant to be one
  const double steps_before = std::ceil(time / time_step - rounding);
  return 1 + static_cast<int>(std::clamp(steps_before, 0.0, static_cast<double>(n_steps)));
}

} // namespace kerf::scene
