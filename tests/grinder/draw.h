#pragma once

/// What chance decides, and how it is written in a scene.

#include "base/parameters.h"
#include "base/vec.h"

#include <random>
#include <string>
#include <vector>

namespace kerf::grinder {

class Chance {
 public:
  /// The same name and seed draw the same everywhere in one build.
  Chance(const std::string& name, unsigned seed);

  double between(double low, double high);
  /// Evenly in its logarithm; both positive.
  double log_between(double low, double high);
  int number(int least, int most);
  /// True so often [1].
  bool happens(double probability);
  Vec3 direction();
  /// Unit, perpendicular to a unit vector.
  Vec3 across(const Vec3& direction);
  template <class T>
  const T& one_of(const std::vector<T>& things) {
    return things[static_cast<std::size_t>(number(0, static_cast<int>(things.size()) - 1))];
  }

 private:
  std::mt19937 random_;
};

/// "x, y, z"
std::string text(const Vec3& v);
/// "x, y, z; x, y, z"
std::string text(const Points& points);
/// "a, b"
std::string text(const std::vector<double>& numbers);

} // namespace kerf::grinder
