#include "grid/touched.h"

#include "base/sort_unique.h"
#include "grid/cube.h"

#include <algorithm>

namespace kerf::grid {

namespace {

/// The line that an edge along `axis` is of the i-th cell around it, in the order of Grid::cells().
constexpr int line_in_cell(const int axis, const int i) {
  const int b = (axis + 1) % 3, c = (axis + 2) % 3;
  return cube::line_at((i & 1) << b | (i >> 1) << c, axis);
}

constexpr std::array<std::array<int, 4>, 3> lines_in_cells = [] {
  std::array<std::array<int, 4>, 3> lines{};
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 4; ++i)
      lines[axis][i] = line_in_cell(axis, i);
  return lines;
}();

/// Calls f(cell, line) for each cell around each edge.
template <class Function>
void for_each_cell(const Grid& grid, const std::span<const EdgeId> edges, const Function& f) {
  for (const EdgeId e : edges) {
    const auto cells = grid.cells(e);
    const auto& lines = lines_in_cells[grid.axis(e)];
    for (int i = 0; i < 4; ++i)
      if (cells[i].valid())
        f(cells[i], lines[i]);
  }
}

/// Marks in a table of all cells: faster than sorting where the edges are many.
std::vector<TouchedCell> marked(const Grid& grid, const std::span<const EdgeId> edges) {
  Table<CellId, std::uint16_t> lines(grid.n_cells(), 0);
  for_each_cell(grid, edges,
                [&](const CellId c, const int line) { lines[c] |= static_cast<std::uint16_t>(1 << line); });
  std::vector<TouchedCell> touched;
  touched.reserve(edges.size() + edges.size() / 4);
  for (const CellId c : ids<CellId>(grid.n_cells()))
    if (lines[c] != 0)
      touched.push_back({c, lines[c]});
  return touched;
}

std::vector<TouchedCell> sorted(const Grid& grid, const std::span<const EdgeId> edges) {
  std::vector<TouchedCell> touched;
  touched.reserve(4 * edges.size());
  for_each_cell(grid, edges, [&](const CellId c, const int line) {
    touched.push_back({c, static_cast<std::uint16_t>(1 << line)});
  });
  std::sort(touched.begin(), touched.end(), [](const auto& a, const auto& b) { return a.cell < b.cell; });
  std::size_t n = 0;
  for (std::size_t i = 0; i < touched.size(); ++i)
    if (n > 0 && touched[n - 1].cell == touched[i].cell)
      touched[n - 1].lines |= touched[i].lines;
    else
      touched[n++] = touched[i];
  touched.resize(n);
  return touched;
}

} // namespace

std::vector<TouchedCell> touched_cells(const Grid& grid, const std::span<const EdgeId> edges) {
  constexpr std::size_t cells_per_edge = 64; // scanning that many marks costs as much as sorting one edge's cells
  return cells_per_edge * edges.size() > grid.n_cells() ? marked(grid, edges) : sorted(grid, edges);
}

std::vector<TouchedCell> touched_cells(const Grid& grid, const Cuts& cuts) {
  std::vector<EdgeId> edges;
  edges.reserve(cuts.all().size());
  for (const EdgeCut& cut : cuts.all())
    edges.push_back(cut.edge);
  return touched_cells(grid, edges);
}

std::vector<CellId> touched_cells(const Grid& grid, const std::span<const EdgeId> edges,
                                  const std::span<const SkinSegment> segments) {
  std::vector<CellId> cells;
  for (const TouchedCell& touched : touched_cells(grid, edges))
    cells.push_back(touched.cell);
  if (segments.empty())
    return cells;
  for (const SkinSegment& segment : segments)
    if (segment.face.valid()) {
      for (const CellId c : grid.cells(segment.face))
        if (c.valid())
          cells.push_back(c);
    } else
      cells.push_back(segment.cell);
  sort_unique(cells);
  return cells;
}

} // namespace kerf::grid
