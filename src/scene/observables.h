#pragma once

/// What a run can report of a body over time: one row a quantity, each a pure function of the body.

#include "scene/body.h"

#include <string>
#include <vector>

namespace kerf::scene {

/// Quantities of one number.
const std::vector<Observable>& body_observables();

/// Null when there is none of that name.
const Observable* find_observable(const std::string& name);

/// The tools of a scene, by name.
struct ToolNames {
  std::vector<std::string> forceps;
  std::vector<std::string> cuts; ///< what makes label 1, 2, ...: blades, then surfaces
};

/// A name that stands for several series: one for each support, tool, cut, load or probe that a scene has, and
/// component.
struct ObservableGroup {
  std::string name; ///< "reactions"
  std::string unit;
  std::string text; ///< what each series is
  std::vector<Observable> (*of)(const Body& body, const ToolNames& tools);
};
const std::vector<ObservableGroup>& observable_groups();

/// Names of both, for people: "kinetic energy, ...".
std::string observable_names();

/// The series that a name stands for. Empty when there is none of that name, or nothing that it
/// is about.
std::vector<Observable> observables_named(const std::string& name, const Body& body, const ToolNames& tools);

/// Whether a name needs Body::accounts.
bool needs_accounts(const std::string& name);

} // namespace kerf::scene
