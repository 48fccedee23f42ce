#pragma once

/// The same body on a grid of cubes twice as large. A coarse copy is a connected component of the fine copies in 2 x 2
/// x 2 cubes, joined over the faces at which they are glued; two coarse copies are glued over a whole face where fine
/// ones are, across it. So what a cut has parted stays parted on every level, as in the virtual node algorithm itself.
///
/// Everything here is said by the fine copies and their corners alone; numbers go by first occurrence.

#include "base/vec.h"
#include "fem/incidence.h"
#include "grid/corner_numbers.h"

#include <array>
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

/// A vertex of a fine cube among the vertices of the coarse one, trilinear.
struct VertexWeights {
  std::uint32_t n = 0;
  std::array<std::uint32_t, 8> vertex = {}; ///< ascending
  std::array<float, 8> weight = {};
};

/// Fine copies by their parents, ascending.
struct Children {
  std::vector<std::uint32_t> begin = {0}, all = {};

  Children() = default;
  Children(std::span<const std::uint32_t> parent, std::size_t n_coarse);
  std::span<const std::uint32_t> of(const std::size_t coarse) const {
    return std::span(all).subspan(begin[coarse], begin[coarse + 1] - begin[coarse]);
  }
};

/// Every copy with a fine corner says the same of where it lies among the coarse ones; its lowest copy is asked.
class Coarsening {
 public:
  CellsOfLevel coarse;
  std::vector<std::uint32_t> parent; ///< the coarse copy of each fine one; `unused` of those that are not used
  Children children;                 ///< of each coarse copy
  std::vector<std::uint8_t> octant;  ///< in which part of it: bits of the axes

  /// Calls f(fine corner, weights of the coarse copy's vertices) for those that are asked of a coarse copy. Each corner
  /// that is used is asked of one.
  template <class Function>
  void for_each_corner(const std::size_t coarse_copy, const Function& f) const {
    for (std::uint32_t i = begin_[coarse_copy]; i < begin_[coarse_copy + 1]; ++i)
      f(corner_[i], weights()[place_[i]]);
  }
  /// Calls f(coarse corner, weight) for those that a fine corner lies among: none where no copy uses it.
  template <class Function>
  void for_each_weight(const std::uint32_t fine_corner, const Function& f) const {
    const std::uint32_t user = user_[fine_corner];
    if (user == CellsOfLevel::unused)
      return;
    const std::uint32_t* const corners = coarse.corners.data() + 8 * std::size_t(parent[user / 8]);
    const VertexWeights& row = weights()[place_of(user)];
    for (std::uint32_t k = 0; k < row.n; ++k)
      f(corners[row.vertex[k]], row.weight[k]);
  }

 private:
  friend Coarsening coarsened(const CellsView& fine);
  friend class AfterCut;
  using Table = std::array<VertexWeights, 64>; // by place: 8 octant + vertex of the fine cube
  static const Table& weights();
  std::uint8_t place_of(const std::uint32_t user) const {
    return static_cast<std::uint8_t>(8 * octant[user / 8] + user % 8);
  }
  void ask(const CellsView& fine);

  std::vector<std::uint32_t> user_;          // of each fine corner: the lowest 8 copy + vertex that has it
  std::vector<std::uint32_t> begin_, corner_; // by coarse copy: the fine corners that are asked of it
  std::vector<std::uint8_t> place_;          // of each of these
};
Coarsening coarsened(const CellsView& fine);

/// What cuts have done to fine copies, which have kept their numbers, as their corners have.
struct CutCells {
  std::vector<std::uint32_t> copies;  ///< that are new, or have other corners, or are used no more; ascending
  std::vector<std::uint32_t> corners; ///< that have other users than before, in any order
  const Incidence& incidence;         ///< now, of the body's corners
  const grid::CornerNumbers& numbers; ///< of these corners, as the copies have them

  std::span<const std::uint32_t> users(const std::uint32_t corner) const {
    return incidence.users(numbers.corner(corner));
  }
};
/// The same as anew, bit by bit, from what there was before cuts. What is not near the cuts is copied.
Coarsening coarsened(const CellsView& fine, const Coarsening& before, const CutCells& cut);

} // namespace kerf::fem
