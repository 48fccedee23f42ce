#include "tests/fuzz/items.h"

#include "tests/grid/slow_complex.h"

#include <algorithm>

namespace kerf::fuzz {

namespace slow = grid::slow;
using grid::CellId;
using grid::EdgeId;
using grid::FaceId;
using grid::NodeId;

namespace {

Index3 half(const slow::Point& p) { return {p[0] / 2, p[1] / 2, p[2] / 2}; }

NodeId node_at(const grid::Grid& grid, const slow::Point& p) { return grid.find_node(half(p)).value(); }

EdgeId edge_at(const grid::Grid& grid, const slow::Point& p) {
  return grid.find_edge(half(p), slow::axis_of(p)).value();
}

FaceArc with_ids(const grid::Grid& grid, const slow::Arc& arc) {
  FaceArc result{{edge_at(grid, arc.edges[0]), edge_at(grid, arc.edges[1])},
                 {node_at(grid, arc.nodes[0]), node_at(grid, arc.nodes[1])},
                 {}};
  for (const slow::Point& p : arc.inner)
    result.inner.push_back(edge_at(grid, p));
  return result;
}

} // namespace

FaceArcs face_arcs(const grid::Grid& grid) {
  slow::Material material;
  material.is_material = [&](const slow::Point& p) {
    const auto node = grid.find_node(half(p));
    return node && grid.is_material(*node);
  };
  FaceArcs result(grid.n_faces());
  for (const auto c : ids<CellId>(grid.n_cells()))
    for (int face = 0; face < grid::cube::n_faces; ++face) {
      auto& of_face = result[grid.faces(c)[face]];
      if (!of_face.empty()) // of the cell before
        continue;
      for (const auto& arc : slow::arcs(material, slow::face_centre(slow::lattice_cell(grid, c), face)))
        of_face.push_back(with_ids(grid, arc));
    }
  return result;
}

void Items::add_links(const EdgeId edge, ItemLinks& links) const {
  const auto& [lower, upper] = solid_.grid.ends(edge);
  if (solid_.grid.is_material(lower) && solid_.grid.is_material(upper) && !solid_.cuts.is_cut(edge))
    links.push_back({node(lower), node(upper)});
}

void Items::add_links(const FaceId face, ItemLinks& links) const {
  for (const FaceArc& arc : arcs_[face])
    if (is_whole(face, arc))
      links.push_back({under(arc, 0), under(arc, 1)});
}

bool Items::is_whole(const FaceId face, const FaceArc& arc) const {
  const grid::Seam seam = solid_.cuts.seam(face);
  if (seam != grid::Seam::unsaid)
    return seam == grid::Seam::whole;
  return std::ranges::none_of(arc.inner, [&](const EdgeId e) { return solid_.cuts.is_cut(e); });
}

} // namespace kerf::fuzz
