#pragma once

/// What holds a body's material together, from the words of grid/skeleton.h and grid/parts.h and with nothing of their
/// code: items, and the segments that join them where they are not cut.
///
/// Neither depends on what blades cut: they are found once for a grid, by the walks of tests/grid/slow_parts.h.

#include "grid/solid.h"

#include <array>
#include <vector>

namespace kerf::fuzz {

/// Names of items, for a whole grid.
using Item = std::uint32_t;
using ItemLinks = std::vector<std::array<Item, 2>>;

struct ItemSegment {
  std::array<Item, 2> ends;
  grid::EdgeId edge;         ///< that it lies on, else invalid
  grid::SkinSegment of_skin; ///< where it lies on no edge
};

struct Items {
  static constexpr Item none = Id<void>::no_value;

  std::size_t n_names = 0;
  Table<grid::CellId, std::array<Item, grid::skeleton::n_items>> name; ///< of a cell's items; none for one it has not
  std::vector<ItemSegment> all;                                        ///< segments
  Table<grid::CellId, std::vector<std::uint32_t>> of_cell;             ///< its segments, among all
};

Items items_of(const grid::Grid& grid);

/// By a blade.
bool is_cut(const grid::Solid& solid, const ItemSegment& segment);
/// In a cell whose copies a front parts (grid/fronts.h): does it lie ahead of the cut?
bool is_ahead(const grid::Solid& solid, grid::CellId cell, const ItemSegment& segment);
/// Do copies of the cell tell of points of the skin?
bool is_cut_at_skin(const grid::Solid& solid, const Items& items, grid::CellId cell);
/// Of all segments of a body that are not cut.
ItemLinks links(const grid::Solid& solid, const Items& items);
/// What holds a cell's copies together: segments neither cut nor ahead of a front.
ItemLinks links(const grid::Solid& solid, const Items& items, grid::CellId cell);
/// Of what hangs together across the cell's upper face along an axis: parts to which the same interval of a segment
/// there belongs. An item of the cell, and one of the cell above.
ItemLinks links_above(const grid::Solid& solid, const Items& items, grid::CellId cell, int axis);

} // namespace kerf::fuzz
