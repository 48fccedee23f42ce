#pragma once

/// The complex of copies by the definitions of grid/complex.h, slowly.

#include "grid/complex.h"
#include "tests/grid/slow_parts.h"

namespace kerf::grid::slow {

/// A copy by its definition: a cell, by its lowest node, and the material of one part.
struct SlowCopy {
  Index3 cell;
  Items items; ///< all of them
  Items said;  ///< those that the copy tells of: without blades at the skin its nodes alone
};

struct SlowComplex {
  std::vector<SlowCopy> copies;
  std::vector<std::array<int, 8>> instance; ///< names of node instances, by copy and vertex
  std::vector<int> piece;
};

inline std::vector<SlowCopy> slow_copies(const support::Body& body) {
  const Material material = material_of(body);
  std::vector<SlowCopy> copies;
  for (const auto c : ids<CellId>(body.grid.n_cells())) {
    const Index3 cell = lattice_cell(body.grid, c);
    const bool with_skin = is_cut_at_skin(material, cell_centre(cell));
    for (const Items& items : parts(material, closure(cell_centre(cell))))
      copies.push_back({cell, items, with_skin ? items : nodes_of(items)});
  }
  return copies;
}

inline bool share(const Items& a, const Items& b) {
  return std::ranges::any_of(a, [&](const Item& item) { return b.contains(item); });
}

/// Copies above each other along an axis that share an item, which can only lie on the face between them.
inline std::vector<std::pair<int, int>> glued_pairs(const std::vector<SlowCopy>& copies) {
  std::map<Index3, std::vector<int>> in_cell;
  for (int i = 0; i < static_cast<int>(copies.size()); ++i)
    in_cell[copies[i].cell].push_back(i);
  std::vector<std::pair<int, int>> pairs;
  for (int a = 0; a < static_cast<int>(copies.size()); ++a)
    for (int axis = 0; axis < 3; ++axis)
      if (const auto above = in_cell.find(moved(copies[a].cell, axis, 1)); above != in_cell.end())
        for (const int b : above->second)
          if (share(copies[a].items, copies[b].items))
            pairs.emplace_back(a, b);
  return pairs;
}

/// The vertex that a node is in a cell; -1 where it is none.
inline int vertex_in(const Index3& cell, const Point& node) {
  for (int v = 0; v < 8; ++v)
    if (node_point(cell, v) == node)
      return v;
  return -1;
}

/// Names spread over glued faces until nothing changes any more.
inline SlowComplex slow_complex(const support::Body& body) {
  SlowComplex slow{slow_copies(body), {}, {}};
  for (int i = 0; i < static_cast<int>(slow.copies.size()); ++i) {
    slow.instance.push_back({});
    for (int v = 0; v < 8; ++v)
      slow.instance[i][v] = 8 * i + v;
    slow.piece.push_back(i);
  }
  const auto pairs = glued_pairs(slow.copies);
  for (bool changed = true; changed;) {
    changed = false;
    const auto agree = [&](int& x, int& y) {
      changed |= x != y;
      x = y = std::min(x, y);
    };
    for (const auto& [a, b] : pairs) {
      agree(slow.piece[a], slow.piece[b]);
      for (int v = 0; v < 8; ++v)
        if (const int w = vertex_in(slow.copies[b].cell, node_point(slow.copies[a].cell, v)); w >= 0)
          agree(slow.instance[a][v], slow.instance[b][w]);
    }
  }
  return slow;
}

/// The material of each piece of a body: of all its items, joined by the segments that are not cut.
inline std::vector<Items> pieces_of(const support::Body& body) {
  Point upper{};
  for (const auto n : ids<NodeId>(body.grid.n_nodes()))
    for (int axis = 0; axis < 3; ++axis)
      upper[axis] = std::max(upper[axis], 2 * body.grid.index(n)[axis]);
  return parts(material_of(body), box({}, upper));
}

} // namespace kerf::grid::slow
