#pragma once

/// What the lumped masses say of a body's motion.

#include "base/vec.h"

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

  void add(const double mass, const Vec3& x, const Vec3& v) {
    const Vec3 more = mass * x, momentum = mass * v;
    *this += {{mass, momentum}, more, more.dot(x), 0.5 * momentum.dot(v)};
  }
  MassSums& operator+=(const MassSums& more) {
    all += more.all;
    moment += more.moment;
    second_moment += more.second_moment;
    kinetic_energy += more.kinetic_energy;
    return *this;
  }
};

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
