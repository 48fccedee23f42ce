#pragma once

/// Grinds bodies to dust: random small strokes of a blade, each through an edge that still holds, until every node is a
/// piece of its own; what must hold is watched all the way.

#include "tests/scene/worlds.h"

#include <random>

namespace kerf::scene {

/// What a body has been through, up to dust.
struct Ground {
  int n_strokes = 0;
  std::size_t n_nodes = 0, n_pieces = 0; ///< pieces with a node
  std::size_t n_splinters = 0;           ///< pieces of the skin without one
  double most_energy = 0;                ///< largest of all steps and cuts, over the first [1]
  double most_work_of_cut = 0;           ///< largest growth of the energy by a single stroke, over the first [1]
  double most_momentum = 0;              ///< largest change of the momentum, over mass times mean speed at first [1]
  double most_mass = 0;                  ///< largest change of the mass, over it [1]
  double most_drift = 0;                 ///< of a piece of dust off its straight way, over its way [1]
  bool is_finite = true;
};

/// A cube of 0.2 m, free, with random velocities, ground by at most `most_strokes` strokes and then left alone a while.
Ground grind(const std::string& backend, unsigned seed, int most_strokes);

} // namespace kerf::scene
