#pragma once

/// What the grinder asks of a body, whatever its physics. All that knows how a body keeps it is in look.cc.

#include "scene/body.h"

namespace kerf::grinder {

/// One piece: what the copies hold together.
struct PieceLook {
  std::size_t n_particles = 0;
  double fastest = 0;                 ///< particle [m/s]
  double ordinary = 0;                ///< 99th percentile of the speeds [m/s]
  std::size_t who = 0;                ///< the fastest
  double rest_volume = 0, volume = 0; ///< that the surface encloses [m^3]
  double rest_reach = 0, reach = 0;   ///< of its farthest surface vertex from the mean of all [m]
  bool is_held = false;               ///< by a support
};

struct Look {
  bool is_finite = true;
  std::vector<PieceLook> pieces = {};
  double kinetic = 0, elastic = 0, gravity = 0; ///< [J]
  double missing = 0, work_of_cut = 0;          ///< as observables say [J]
  double stretch = 1; ///< that one in a hundred copies with half a cube's nodes exceeds, of an edge over that at rest [1]
};

/// Speeds of particles with less than `least_mass` [cubes] do not count.
Look look_at(const scene::Body& body, double least_mass = 0);

/// A particle in words: its place at rest, its mass, the copies that know it.
std::string about_particle(const scene::Body& body, std::size_t particle);

} // namespace kerf::grinder
