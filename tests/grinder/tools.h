#pragma once

/// Strokes of every tool of a scene through a body that sags or falls.

#include "tests/grinder/draw.h"
#include "tests/grinder/scene.h"

namespace kerf::grinder {

/// What is cut, and when.
struct Target {
  Points skin;                ///< some points of its skin at rest [m]
  Vec3 centre = Vec3::Zero(); ///< of its bounding box [m]
  double radius = 0;          ///< half of that box's diagonal [m]
  double cell = 0;            ///< edge of a cube [m]
  double dt = 0;              ///< [s]
  int n_steps = 0;
  Vec3 fall = Vec3::Zero(); ///< acceleration that the tools follow: gravity of a free body, else zero [m/s^2]
  std::string mesh, unit;   ///< as a scene writes them
};

/// What a stroke adds to a scene.
struct Stroke {
  std::string tool;                  ///< "scissors"
  std::vector<std::string> sections; ///< of the scene, one a blade or surface
};

/// A stroke of a random tool.
Stroke random_stroke(const Target& target, Chance& chance, int number);

/// Planes along the axes, all at once, that leave blocks of `n_cells` cubes an edge.
Stroke dice(const Target& target, double n_cells, double time);

} // namespace kerf::grinder
