#pragma once

/// Functions that scenes write as text, by deal.II's expression parser; pi is known.

#include "scene/parameter_file.h"

#include <functional>

namespace kerf::scene {

/// Three expressions of the time t [s], separated by semicolons. Throws ParameterError at the section's key for what is
/// no such expression, or is not finite at t = 0.
std::function<Vec3(double time)> vector_of_time(const Section& section, const std::string& key,
                                                const std::string& expressions);

/// Three expressions of the rest position x, y, z [m] and the time t [s]; else as above, but what is not finite is told
/// where it is met.
std::function<Vec3(const Vec3& X, double time)> vector_of_place(const Section& section, const std::string& key,
                                                                const std::string& expressions);

/// The same of the rest position alone.
std::function<Vec3(const Vec3& X, double time)> vector_of_rest(const Section& section, const std::string& key,
                                                               const std::string& expressions);

/// One expression of the rest position and the time.
std::function<double(const Vec3& X, double time)> number_of_place(const Section& section, const std::string& key,
                                                                  const std::string& expression);

} // namespace kerf::scene
