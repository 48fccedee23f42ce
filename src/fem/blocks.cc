#include "fem/blocks.h"

#include <algorithm>
#include <array>

namespace kerf::fem {

namespace {

constexpr std::array<int, 3> block = {16, 8, 4};
constexpr std::size_t chunk_size = std::size_t(block[0] * block[1] * block[2]);

int divided(const int i, const int by) { return (i - (i % by + by) % by) / by; } // rounded down

/// A cell with its place, last axis first; in the end with that of its block and row.
struct Placed {
  std::array<int, 6> at; ///< block along z, y, x, then z, y, x
  grid::CellId cell;
};

bool has_skin(const grid::Grid& grid, const grid::CellId cell) {
  return !std::ranges::all_of(grid.nodes(cell), [&](const grid::NodeId node) { return grid.is_material(node); });
}

/// Takes apart a row of cells side by side along x. A part belongs to the block in which its middle lies.
void put_blocks(const grid::Grid& grid, const std::vector<Placed>::iterator begin,
                const std::vector<Placed>::iterator end) {
  const auto is_inside = [&](const Placed& cell) { return !has_skin(grid, cell.cell); };
  auto first = std::find_if(begin, end, is_inside);
  auto last = end;
  while (last != first && !is_inside(*(last - 1)))
    --last;
  if (first == end) {
    first = begin;
    last = end;
  }
  const int x = first->at[5], n = static_cast<int>((last - first + block[0] - 1) / block[0]);
  for (auto cell = begin; cell != end; ++cell) {
    const int part = std::clamp(divided(cell->at[5] - x, block[0]), 0, n - 1);
    cell->at[0] = divided(cell->at[3], block[2]);
    cell->at[1] = divided(cell->at[4], block[1]);
    cell->at[2] = divided(x + part * block[0] + block[0] / 2, block[0]);
  }
}

} // namespace

CellsInChunks in_chunks(const grid::Grid& grid) {
  std::vector<Placed> placed;
  placed.reserve(grid.n_cells());
  for (const auto cell : ids<grid::CellId>(grid.n_cells())) {
    const Index3 at = grid.index(grid.nodes(cell)[0]);
    placed.push_back({{0, 0, 0, at[2], at[1], at[0]}, cell});
  }
  std::ranges::sort(placed, {}, &Placed::at);
  for (auto begin = placed.begin(); begin != placed.end();) {
    auto end = begin + 1;
    while (end != placed.end() && end->at[3] == begin->at[3] && end->at[4] == begin->at[4] &&
           end->at[5] == (end - 1)->at[5] + 1)
      ++end;
    put_blocks(grid, begin, end);
    begin = end;
  }
  std::ranges::sort(placed, {}, &Placed::at);

  CellsInChunks result;
  result.cells.reserve(placed.size());
  result.chunk_of.resize(placed.size());
  std::size_t first = 0;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const auto& at = placed[i].at;
    const bool begins_row = i > 0 && !std::equal(at.begin(), at.begin() + 5, placed[i - 1].at.begin());
    if (begins_row && i - first >= chunk_size) {
      result.ends.push_back(static_cast<std::uint32_t>(i));
      first = i;
    }
    result.cells.push_back(placed[i].cell);
    result.chunk_of[placed[i].cell.value] = static_cast<std::uint32_t>(result.ends.size());
  }
  if (!placed.empty())
    result.ends.push_back(static_cast<std::uint32_t>(placed.size()));
  return result;
}

} // namespace kerf::fem
