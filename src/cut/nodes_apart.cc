#include "cut/nodes_apart.h"

#include "grid/parts.h"
#include "grid/touched.h"

#include <bit>

namespace kerf::cut {

namespace cube = grid::cube;
using grid::CellCuts;

namespace {

/// Does a part hold nodes that no edges of the cell join?
bool joins_nodes(const CellCuts& cell) {
  for (const grid::Part& part : parts_of(cell)) {
    if (part.nodes == 0)
      continue;
    const unsigned reached = cube::reachable(std::countr_zero(part.nodes), cell.cut | cell.skin);
    if ((part.nodes & ~reached) != 0)
      return true;
  }
  return false;
}

enum class Join { where_a_cut_may_go_on, between_rinds, other };

Join kind_of(const CellCuts& cell, const grid::SkinArc& arc) {
  const int n_twice = int(cell.twice >> arc.lines[0] & 1) + int(cell.twice >> arc.lines[1] & 1);
  if (n_twice == 1 && (cell.cut & arc.inner) == 0)
    return Join::where_a_cut_may_go_on;
  return n_twice == 2 ? Join::between_rinds : Join::other;
}

/// The faces whose skin is to be parted so that it joins no nodes: no more than needed.
std::vector<int> joining_faces(CellCuts cell) {
  std::vector<int> faces;
  std::vector<grid::Seam> before;
  for (const Join kind : {Join::where_a_cut_may_go_on, Join::between_rinds, Join::other})
    for (int face = 0; face < cube::n_faces; ++face)
      for (const grid::SkinArc& arc : grid::skin_arcs(face, cell.material)) {
        if ((cell.blades() & CellCuts::beside(arc)) == 0 || !cell.is_whole(face, arc) || kind_of(cell, arc) != kind ||
            !joins_nodes(cell))
          continue;
        faces.push_back(face);
        before.push_back(cell.seams[face]);
        cell.seams[face] = grid::Seam::parted;
      }
  for (std::size_t i = faces.size(); i-- > 0;) {
    cell.seams[faces[i]] = before[i];
    if (joins_nodes(cell))
      cell.seams[faces[i]] = grid::Seam::parted;
    else
      faces.erase(faces.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return faces;
}

} // namespace

std::vector<grid::EdgeId> keep_nodes_apart(const grid::Grid& grid, grid::Cuts& cuts,
                                           const std::span<const grid::EdgeId> edges) {
  std::vector<grid::EdgeId> parted;
  for (const grid::TouchedCell& touched : grid::touched_cells(grid, edges)) {
    const CellCuts cell = grid::cuts_of(grid, cuts, touched.cell);
    if (cell.skin == 0 || cell.blades() == 0)
      continue;
    for (const int face : joining_faces(cell)) {
      cuts.set_seam(grid.faces(touched.cell)[face], grid::Seam::parted);
      const auto of_cell = grid.edges(touched.cell);
      for (const int line : cube::face_lines[face])
        if (cell.blades() >> line & 1)
          parted.push_back(of_cell[line]);
    }
  }
  return parted;
}

} // namespace kerf::cut
