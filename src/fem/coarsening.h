#pragma once

/// The same body on a grid of cubes twice as large. A coarse copy is a connected component of the fine copies in 2 x 2
/// x 2 cubes, joined over the faces at which they are glued; two coarse copies are glued over a whole face where fine
/// ones are, across it. So what a cut has parted stays parted on every level, as in the virtual node algorithm itself.
///
/// Everything here is said by the fine copies and their corners alone; numbers go by first occurrence.

#include "base/vec.h"

#include <cstdint>
#include <span>
#include <vector>

namespace kerf::fem {

/// Copies with their places in a lattice, and corners; those of no use have the corner `unused`.
struct CellsOfLevel {
  static constexpr std::uint32_t unused = 0xffffffff;
  std::vector<Index3> place;          ///< of the copy's lowest vertex, in edges of this level's cubes
  std::vector<std::uint32_t> corners; ///< 8 a copy, in deal.II's vertex order
  std::size_t n_corners = 0;

  std::size_t n_copies() const { return place.size(); }
  bool is_used(const std::size_t copy) const { return corners[8 * copy] != unused; }
};

/// Such copies, kept elsewhere.
struct CellsView {
  std::span<const Index3> place;
  std::span<const std::uint32_t> corners;
  std::size_t n_corners;

  CellsView(const std::span<const Index3> place_of, const std::span<const std::uint32_t> corners_of,
            const std::size_t n)
    : place(place_of), corners(corners_of), n_corners(n) {}
  CellsView(const CellsOfLevel& cells)
    : CellsView(cells.place, cells.corners, cells.n_corners) {} // NOLINT: a view of them

  std::size_t n_copies() const { return place.size(); }
  bool is_used(const std::size_t copy) const { return corners[8 * copy] != CellsOfLevel::unused; }
};

/// A sparse matrix of weights, row by row.
struct Weights {
  std::vector<std::uint32_t> begin = {0}; ///< of each row, and the end
  std::vector<std::uint32_t> column;
  std::vector<float> weight;
};
Weights transposed(const Weights& weights, std::size_t n_columns);

/// Fine copies by their parents, ascending.
struct Children {
  std::vector<std::uint32_t> begin = {0}, all = {};

  Children() = default;
  Children(std::span<const std::uint32_t> parent, std::size_t n_coarse);
  std::span<const std::uint32_t> of(const std::size_t coarse) const {
    return std::span(all).subspan(begin[coarse], begin[coarse + 1] - begin[coarse]);
  }
};

struct Coarsening {
  CellsOfLevel coarse;
  std::vector<std::uint32_t> parent; ///< the coarse copy of each fine one; `unused` of those that are not used
  Children children;                 ///< of each coarse copy
  std::vector<std::uint8_t> octant;  ///< in which part of it: bits of the axes
  Weights prolongation, restriction; ///< trilinear: a row for each fine corner; its transpose
};
Coarsening coarsened(const CellsView& fine);

} // namespace kerf::fem
