#pragma once

/// The same problems in CalculiX (Dhondt 2004), an independent program: input decks for a block of hexahedra, a run in a
/// temporary folder, displacements read back from the .dat file.

#include "base/vec.h"

#include <functional>
#include <string>

namespace kerf::verification::calculix {

/// Trilinear with full integration; with incompatible modes; quadratic with reduced integration.
enum class Element { C3D8, C3D8I, C3D20R };

/// n[0] x n[1] x n[2] elements; what is held is held at zero.
struct Deck {
  Element element = Element::C3D8;
  Index3 n = {1, 1, 1};
  /// Lattice coordinates, 0 .. n, to positions [m].
  std::function<Vec3(const Vec3&)> place;
  double youngs_modulus = 1, poissons_ratio = 0, density = 1000;
  enum class Held { lower_x, upper_x } held = Held::lower_x; ///< one end of the block, in all directions
  enum class Walls { none, across_z } walls = Walls::none;   ///< z: no node moves across
  Vec3 gravity = Vec3::Zero();                               ///< [m/s^2]
  Vec3 end_force = Vec3::Zero();                             ///< on the upper end along x, uniform over its lattice [N]
  /// Nodes on the layer z = slit_layer are there twice where x < slit_length (lattice coordinates).
  int slit_layer = 0, slit_length = 0;
  double slit_pressure = 0; ///< on both faces of the slit [Pa]
};

bool is_installed();

/// A node by its lattice coordinates; on the slit, the one of the cells above.
struct Probe {
  Index3 node;
  enum class Side { below, above } side = Side::below;
};

/// Displacements of the nodes [m]. Throws std::runtime_error, with the end of its output, when CalculiX fails.
Points run(const Deck& deck, const std::vector<Probe>& probes);

/// The tip of verification::heavy_cantilever on cubes [m].
double heavy_cantilever(int n_over_height, Element element, double poissons_ratio = 0.3);

} // namespace kerf::verification::calculix
