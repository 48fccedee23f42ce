#pragma once

/// Pieces of a body against what the stroke, pulled back to rest, cuts free.

#include "grid/complex.h"
#include "surface/surface.h"
#include "tests/support/fine_material.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace kerf::cut {

/// Of pieces [cubes], and what the fine material says of them.
struct PiecesAndFine {
  std::vector<double> grid, fine; ///< ascending
  int n_crumbs = 0;               ///< of the grid, below a cube, above what the fine material can tell
  int n_tiny = 0;                 ///< below that
  int n_not_free = 0;             ///< crumbs that the stroke did not cut free
};

/// A crumb is free if most of it lies in fine pieces that lie mostly in it.
inline PiecesAndFine pieces_and_fine(const grid::Solid& solid, const support::FineMaterial& fine) {
  const auto of_point = fine.pieces();
  const grid::Pieces of_copy = grid::pieces(solid.complex);
  std::map<std::uint32_t, std::size_t> n_of_fine;
  const double bulk = 10 / fine.volume();
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> n_common; // by piece of the grid, fine piece
  for (std::size_t i = 0; i < fine.size(); ++i) {
    ++n_of_fine[of_point[i]];
    ++n_common[{of_copy.piece[fine.copy(i)], of_point[i]}];
  }
  std::vector<std::size_t> n_points(of_copy.n_pieces, 0), n_free = n_points;
  for (const auto& [pair, n] : n_common) {
    n_points[pair.first] += n;
    if (static_cast<double>(n_of_fine[pair.second]) < bulk)
      n_free[pair.first] += n;
  }
  PiecesAndFine result;
  const double cube = std::pow(solid.grid.h(), 3);
  const auto volumes = surface::piece_volumes(surface::build_surface(solid), solid.complex);
  for (std::size_t k = 0; k < volumes.size(); ++k) {
    result.grid.push_back(volumes[k] / cube);
    if (volumes[k] > cube)
      continue;
    const bool is_tiny = n_points[k] < 2;
    (is_tiny ? result.n_tiny : result.n_crumbs) += 1;
    result.n_not_free += !is_tiny && 2 * n_free[k] <= n_points[k];
  }
  for (const auto& [name, n] : n_of_fine)
    result.fine.push_back(static_cast<double>(n) * fine.volume());
  std::sort(result.grid.begin(), result.grid.end());
  std::sort(result.fine.begin(), result.fine.end());
  return result;
}

/// Of ascending volumes.
inline std::ptrdiff_t n_above(const std::vector<double>& volumes, const double least) {
  return volumes.end() - std::upper_bound(volumes.begin(), volumes.end(), least);
}

} // namespace kerf::cut
