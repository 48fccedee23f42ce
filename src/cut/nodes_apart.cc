#include "cut/nodes_apart.h"

#include "cut/part_face.h"
#include "grid/parts.h"

#include <bit>

namespace kerf::cut {

namespace cube = grid::cube;
using grid::CellCuts;
using grid::Solid;

namespace {

/// Of each node of a cell, those that lie on the other side of one of the planes along which blades have cut in the
/// cell.
using OtherSide = std::array<unsigned, cube::n_vertices>;

OtherSide other_side(const Solid& solid, const grid::CellId c, const CellCuts& cell) {
  const double on_the_plane = 2 * grid::min_edge_parameter * solid.grid.h();
  const auto nodes = solid.grid.nodes(c);
  const auto edges = solid.grid.edges(c);
  OtherSide result{};
  for (int line = 0; line < cube::n_lines; ++line) {
    if ((cell.blades() >> line & 1) == 0)
      continue;
    const Vec3 normal = solid.cuts.find(edges[line])->normal;
    const Vec3 p = grid::edge_point(solid, edges[line]);
    const auto& [lower, upper] = cube::line_vertices[line];
    const bool rises = normal[cube::line_axis(line)] >= 0;
    unsigned above = 1u << (rises ? upper : lower), below = 1u << (rises ? lower : upper); // however near the cut is
    for (int v = 0; v < cube::n_vertices; ++v)
      if (v != lower && v != upper) {
        const double height = normal.dot(solid.grid.position(nodes[v]) - p);
        above |= unsigned(height > on_the_plane) << v;
        below |= unsigned(height < -on_the_plane) << v;
      }
    for (int v = 0; v < cube::n_vertices; ++v)
      result[v] |= (above >> v & 1) != 0 ? below : (below >> v & 1) != 0 ? above : 0;
  }
  return result;
}

constexpr OtherSide any_side{0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff};

/// Does a part hold nodes on two sides of a cut that no edges of the cell join?
bool joins_nodes(const CellCuts& cell, const OtherSide& other_side) {
  for (const grid::Part& part : parts_of(cell))
    for (unsigned left = part.nodes; left != 0; left &= left - 1) {
      const int v = std::countr_zero(left);
      if ((part.nodes & other_side[v] & ~unsigned(cube::reachable(v, cell.cut | cell.skin))) != 0)
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
std::vector<int> joining_faces(CellCuts cell, const OtherSide& other_side) {
  std::vector<int> faces;
  std::vector<grid::Seam> before;
  for (const Join kind : {Join::where_a_cut_may_go_on, Join::between_rinds, Join::other})
    for (int face = 0; face < cube::n_faces; ++face)
      for (const grid::SkinArc& arc : grid::skin_arcs(face, cell.material)) {
        if ((cell.blades() & CellCuts::beside(arc)) == 0 || !cell.is_whole(face, arc) || kind_of(cell, arc) != kind ||
            !joins_nodes(cell, other_side))
          continue;
        faces.push_back(face);
        before.push_back(cell.seams[face]);
        cell.seams[face] = grid::Seam::parted;
      }
  for (std::size_t i = faces.size(); i-- > 0;) {
    cell.seams[faces[i]] = before[i];
    if (joins_nodes(cell, other_side))
      cell.seams[faces[i]] = grid::Seam::parted;
    else
      faces.erase(faces.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return faces;
}

/// The faces of a cell whose skin is to be parted.
std::vector<int> joining_faces(const Solid& solid, const grid::CellId c, const CellCuts& cell) {
  if (cell.skin == 0 || cell.blades() == 0 || !joins_nodes(cell, any_side))
    return {};
  return joining_faces(cell, other_side(solid, c, cell));
}

} // namespace

bool must_be_parted(const Solid& solid, const grid::CellId c) {
  return !joining_faces(solid, c, grid::cuts_of(solid, c)).empty();
}

std::vector<grid::EdgeId> keep_nodes_apart(Solid& solid, const grid::CellId c) {
  std::vector<grid::EdgeId> parted;
  for (const int face : joining_faces(solid, c, grid::cuts_of(solid, c)))
    part_face(solid, c, face, parted);
  return parted;
}

} // namespace kerf::cut
