#pragma once

/// Pieces of a body against what the stroke, pulled back to rest, cuts free.

#include "grid/complex.h"
#include "surface/surface.h"
#include "tests/support/fine_material.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace kerf::cut {

/// Of pieces [cubes], and what the fine material says of them.
struct PiecesAndFine {
  std::vector<double> grid, fine; ///< ascending
  int n_crumbs = 0;               ///< of the grid, below a cube, above what the fine material can tell
  int n_tiny = 0;                 ///< below that
  int n_not_free = 0;             ///< crumbs that the stroke did not cut free
};

/// A crumb is free if most of it lies in fine pieces that lie mostly in it. Between pieces of more than a cube a tenth of
/// the links that the grid has parted may hold: where points go over to other copies, blades miss some, which lie strewn
/// over the whole cut.
inline PiecesAndFine pieces_and_fine(const grid::Solid& solid, const support::FineMaterial& fine) {
  constexpr double strewn = 0.1, least = 1e-3; // cubes below which nothing is called a crumb
  const grid::Pieces of_copy = grid::pieces(solid.complex);
  const double cube = std::pow(solid.grid.h(), 3);
  const auto volumes = surface::piece_volumes(surface::build_surface(solid), solid.complex);
  const auto are_apart = [&](const std::uint32_t i, const std::uint32_t j) {
    const std::uint32_t p = of_copy.piece[fine.copy(i)], q = of_copy.piece[fine.copy(j)];
    return p != q && volumes[p] > cube && volumes[q] > cube;
  };
  const bool has_strewn_links = fine.part_held(are_apart) < strewn;
  const auto of_point = fine.pieces(
    [&](const std::uint32_t i, const std::uint32_t j) { return has_strewn_links && are_apart(i, j); });
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
  for (std::size_t k = 0; k < volumes.size(); ++k) {
    result.grid.push_back(volumes[k] / cube);
    if (volumes[k] > cube)
      continue;
    const bool is_tiny = n_points[k] < 2 || volumes[k] < least * cube;
    (is_tiny ? result.n_tiny : result.n_crumbs) += 1;
    result.n_not_free += !is_tiny && 2 * n_free[k] <= n_points[k];
  }
  for (const auto& [name, n] : n_of_fine)
    result.fine.push_back(static_cast<double>(n) * fine.volume());
  std::sort(result.grid.begin(), result.grid.end());
  std::sort(result.fine.begin(), result.fine.end());
  return result;
}

/// `judged` says of a body what fine points, so many along a cube's edge, find. A crumb that is not free by them is
/// judged by twice as many: it may have but a few of them.
template <class Judged>
std::optional<PiecesAndFine> judged_finely(const int n, const Judged& judged) {
  std::optional<PiecesAndFine> pieces = judged(n);
  return pieces && pieces->n_not_free > 0 ? judged(2 * n) : pieces;
}

/// Of ascending volumes, those above one.
inline std::ptrdiff_t n_above(const std::vector<double>& volumes, const double least) {
  return volumes.end() - std::upper_bound(volumes.begin(), volumes.end(), least);
}

/// Of many bodies.
struct TallyOfPieces {
  int n_bodies = 0, n_parted = 0, n_crumbs = 0, n_tiny = 0, n_not_free = 0, n_other = 0;

  /// Says where a body has crumbs, or other pieces than the fine material.
  void add(const PiecesAndFine& pieces, const std::string& name, const unsigned seed) {
    ++n_bodies;
    n_parted += n_above(pieces.grid, 1) > 1;
    n_crumbs += pieces.n_crumbs;
    n_tiny += pieces.n_tiny;
    n_not_free += pieces.n_not_free;
    const bool is_other =
      n_above(pieces.grid, 10) > n_above(pieces.fine, 8) || n_above(pieces.fine, 10) > n_above(pieces.grid, 8);
    n_other += is_other;
    if (pieces.n_crumbs + pieces.n_tiny == 0 && !is_other)
      return;
    std::cout << name << ", seed " << seed << ": " << pieces.n_crumbs << " crumbs, " << pieces.n_not_free
              << " of them not cut free, " << pieces.n_tiny << " too small to tell; pieces [cubes]";
    for (const auto* volumes : {&pieces.grid, &pieces.fine})
      for (std::size_t i = 0; i < std::min<std::size_t>(6, volumes->size()); ++i)
        std::cout << (i == 0 ? " | " : " ") << volumes->rbegin()[i];
    std::cout << std::endl;
  }
  void expect_sound() const {
    std::cout << n_bodies << " bodies, " << n_parted << " parted; " << n_crumbs << " crumbs, " << n_not_free
              << " not cut free; " << n_tiny << " too small to tell; other pieces in " << n_other << '\n';
    EXPECT_GT(n_parted, n_bodies / 2);
    EXPECT_EQ(n_not_free, 0);
    EXPECT_LE(n_other, n_bodies / 50); // a slab far thinner than a cube may stay on one side
  }
};

} // namespace kerf::cut
