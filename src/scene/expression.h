#pragma once

#include "scene/parameter_file.h"

#include <functional>

namespace kerf::scene {

/// Three expressions of the time t [s], separated by semicolons, as a displacement [m]. Throws ParameterError at the
/// section's key "Displacement [m]" for what is no such expression.
std::function<Vec3(double time)> displacement_of_time(const Section& section, const std::string& expressions);

} // namespace kerf::scene
