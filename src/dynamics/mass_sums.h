#pragma once

/// What the lumped masses say of a body's motion.

#include "base/vec.h"

#include <cstddef>
#include <span>

namespace kerf::dynamics {

/// Mass [kg] and momentum [kg m/s].
struct MassAndMomentum {
  double mass = 0;
  Vec3 momentum = Vec3::Zero();

  MassAndMomentum& operator+=(const MassAndMomentum& more) {
    mass += more.mass;
    momentum += more.momentum;
    return *this;
  }
};

/// Of a state. Not finite where a position or a velocity is not.
struct MassSums {
  MassAndMomentum all;
  Vec3 moment = Vec3::Zero(); ///< sum of m x [kg m]
  double second_moment = 0;   ///< sum of m x.x [kg m^2]
  double kinetic_energy = 0;  ///< [J]

  MassSums& operator+=(const MassSums& more) {
    all += more.all;
    moment += more.moment;
    second_moment += more.second_moment;
    kinetic_energy += more.kinetic_energy;
    return *this;
  }
};

/// Of the corners from one to another, by the mass of each [kg].
inline MassSums mass_sums(const std::span<const double> mass, const Points& x, const Points& v, const std::size_t begin,
                          const std::size_t end) {
  MassSums sum; // of its own: no other memory can be it
  for (std::size_t i = begin; i < end; ++i) {
    const Vec3 moment = mass[i] * x[i], momentum = mass[i] * v[i];
    sum += {{mass[i], momentum}, moment, moment.dot(x[i]), 0.5 * momentum.dot(v[i])};
  }
  return sum;
}

/// Of both ends of a step.
struct SumsOfStep {
  MassSums before, after;

  SumsOfStep& operator+=(const SumsOfStep& more) {
    before += more.before;
    after += more.after;
    return *this;
  }
};

} // namespace kerf::dynamics
