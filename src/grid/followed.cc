#include "grid/followed.h"

#include <algorithm>
#include <bit>
#include <map>

namespace kerf::grid {

namespace {

/// The node below the lowest of the copy's points of the skin.
NodeId cut_off_from(const Grid& grid, const Copy& copy) {
  const Skeleton& skeleton = skeleton_of(material_of(grid, copy.cell));
  return grid.nodes(copy.cell)[skeleton.vertex[std::countr_zero(copy.items())]];
}

NodeId lowest_node(const Grid& grid, const Copy& copy) { return grid.nodes(copy.cell)[std::countr_zero(copy.nodes)]; }

/// Hands nodes on from corners to copies, and from those to their other corners.
void spread(const CellComplex& complex, std::vector<Followed>& copies, std::map<CornerId, NodeId>& node_at) {
  for (bool has_grown = true; has_grown;) {
    std::vector<Followed> found; // entered after the round, so that the order of copies has no say
    for (const Followed& followed : copies)
      if (!followed.node.valid()) {
        NodeId node; // the lowest one, whatever the names of copies and corners; invalid is higher than all
        for (const CornerId corner : complex.copies[followed.copy].corners)
          node = std::min(node, node_at[corner]);
        if (node.valid())
          found.push_back({followed.copy, node});
      }
    for (const auto& [copy, node] : found) {
      std::ranges::lower_bound(copies, copy, {}, &Followed::copy)->node = node;
      for (const CornerId corner : complex.copies[copy].corners) // where there was a node, all have theirs
        node_at[corner] = std::min(node_at[corner], node);
    }
    has_grown = !found.empty();
  }
}

} // namespace

std::vector<Followed> followed_nodes(const Solid& solid) {
  std::vector<Followed> result;
  for (const auto c : ids<CopyId>(solid.complex.n_copies()))
    if (const Copy& copy = solid.complex.copies[c]; copy.nodes == 0 && !copy.is_lapsed())
      result.push_back({c, NodeId()});
  if (result.empty())
    return result;

  std::map<CornerId, NodeId> node_at; // of the corners of copies that follow something
  for (const Followed& followed : result)
    for (const CornerId corner : solid.complex.copies[followed.copy].corners)
      node_at[corner];
  for (const Copy& copy : solid.complex.copies)
    if (copy.nodes != 0)
      for (const CornerId corner : copy.corners)
        if (const auto at = node_at.find(corner); at != node_at.end())
          at->second = std::min(at->second, lowest_node(solid.grid, copy));

  spread(solid.complex, result, node_at);
  // Pieces of skin alone: one node for all of a piece.
  for (;;) {
    NodeId lowest;
    CopyId from;
    for (const auto& [c, node] : result)
      if (const NodeId other = cut_off_from(solid.grid, solid.complex.copies[c]); !node.valid() && other < lowest) {
        lowest = other;
        from = c;
      }
    if (!from.valid())
      return result;
    for (const CornerId corner : solid.complex.copies[from].corners)
      node_at[corner] = lowest;
    spread(solid.complex, result, node_at);
  }
}

} // namespace kerf::grid
