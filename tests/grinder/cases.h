#pragma once

/// Scenes drawn by chance: a solid, scaled and placed, its material, what holds it, and strokes of all tools while it
/// sags, swings or falls.

#include "tests/grinder/meshes.h"
#include "tests/grinder/tools.h"

namespace kerf::grinder {

/// One physics: a name for files and what it adds to the body's section.
struct Kind {
  std::string name; ///< "fem-enhanced-neo-Hookean"
  std::vector<std::string> keys;
};

/// Elements of both strains with two laws, points, lattice shape matching, springs.
const std::vector<Kind>& kinds();
/// Throws std::out_of_range when there is none of that name.
const Kind& kind_named(const std::string& name);

/// How large the cases are.
struct Size {
  double least_cells = 300, most_cells = 1500; ///< in a body, about
  int least_steps = 20, most_steps = 40;
};

/// A scene in parts, so that it can be made smaller.
struct Scene {
  double dt = 0; ///< [s]
  int n_steps = 0;
  double cell = 0;                        ///< edge of the cubes [m]
  Vec3 gravity = Vec3::Zero();            ///< [m/s^2]
  std::vector<std::string> body = {};     ///< lines of its section, but for the cubes
  std::vector<std::string> sections = {}; ///< of its tools
  std::string story = {};                 ///< in a few words
  double extent = 0;                      ///< diagonal of the body's bounding box [m]
  double wave_speed = 0;                  ///< sqrt(E / density) [m/s]
};

/// As `kerf run` reads it.
std::string text(const Scene& scene);

/// The strokes and all else follow from solid, seed and size; every kind of physics gets the same.
Scene random_scene(const Solid& solid, const Kind& kind, unsigned seed, const Size& size);

} // namespace kerf::grinder
