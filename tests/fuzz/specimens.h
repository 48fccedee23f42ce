#pragma once

/// The bodies that are cut.

#include "tests/fuzz/subject.h"

namespace kerf::fuzz {

struct Specimens {
  std::vector<Specimen> small;      ///< a few hundred cells
  std::vector<Specimen> large;      ///< so many edges that two threads share them
  std::vector<std::string> skipped; ///< meshes that were refused, and why
};

/// Boxes whose faces lie on lattice planes, midway and anywhere, a plate, a rod, spheres, the liver, and the other
/// meshes of the example scenes.
Specimens own_specimens();

/// Adds every mesh of a folder that is the skin of a solid, and names those that are not; folders without meshes add
/// nothing.
void add_meshes(const std::string& folder, Specimens& specimens);

/// A sphere of radius 1, fine triangles.
Specimen fine_sphere(double h);

} // namespace kerf::fuzz
