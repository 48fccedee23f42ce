#pragma once

/// What a run can report of a body over time: one row a quantity, each a pure function.

#include "scene/body.h"

#include <string>
#include <vector>

namespace kerf::scene {

struct BodyObservable {
  std::string name;   ///< "kinetic energy"
  std::string unit;   ///< "J"
  std::string source; ///< formula
  std::function<double(const Body&)> value;
};

/// All that can be asked for.
const std::vector<BodyObservable>& body_observables();

/// Null when there is none of that name.
const BodyObservable* find_observable(const std::string& name);

} // namespace kerf::scene
