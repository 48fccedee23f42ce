#pragma once

/// Scenes drawn by chance: a solid, scaled and placed, its material, what holds it, and strokes of all tools while it
/// sags, swings or falls.

#include "tests/grinder/meshes.h"
#include "tests/grinder/scene.h"

namespace kerf::grinder {

/// One physics: a name for files and what it adds to the body's section.
struct Kind {
  std::string name; ///< "fem-enhanced-neo-Hookean"
  std::vector<std::string> keys = {};
  int half_width = 0; ///< of lattice shape matching [cells], which bounds its time step; else 0
};

/// Elements of both strains with two laws, and with the other integrators, explicit ones included; points, lattice shape
/// matching, springs.
const std::vector<Kind>& kinds();
/// Throws std::out_of_range when there is none of that name.
const Kind& kind_named(const std::string& name);

/// How large the cases are.
struct Size {
  double least_cells = 300, most_cells = 1500; ///< cubes of the body's volume; with those at its skin up to three times
  int least_steps = 20, most_steps = 40;
};

/// The strokes and all else follow from solid, seed and size; every kind of physics gets the same.
Scene random_scene(const Solid& solid, const Kind& kind, unsigned seed, const Size& size);

} // namespace kerf::grinder
