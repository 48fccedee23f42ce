#pragma once

/// The parts that cuts leave of a cell or of a face: material nodes, and rinds (cuts.h), that hold together. Nodes are
/// joined by uncut edges; and where a blade has cut, the skin of a face that is whole (Seam) joins what lies under the
/// two ends of its arc: there a rind, where the edge is cut twice, else the material node.

#include "grid/cube.h"
#include "grid/cuts.h"
#include "grid/skin_arcs.h"

namespace kerf::grid {

/// What cuts have done to a cell; sets are bits, of vertices or lines.
struct CellCuts {
  unsigned material = 0;       ///< vertices
  unsigned cut = 0, twice = 0; ///< lines that are cut, and those of them that are cut twice
  unsigned skin = 0;           ///< lines between a material and an empty vertex
  std::array<Seam, 6> seams{}; ///< by face

  /// The lines of what blades have cut.
  unsigned blades() const { return (cut & ~skin) | twice; }
  /// Does the skin of the arc hold together?
  bool is_whole(const int face, const SkinArc& arc) const {
    return seams[face] == Seam::unsaid ? (arc.inner & cut) == 0 : seams[face] == Seam::whole;
  }
  /// Have the blades' cuts a vertex of their own in the face, in the cell, beside that of the skin (SkinPoint)?
  bool has_two_points(int face) const;
  bool has_two_points() const { return blades() != 0 && skin != 0; }
  /// Has a blade cut beside the arc, so that the skin is parted there?
  bool is_rim(int face, const SkinArc& arc) const { return (blades() & beside(arc)) != 0 && !is_whole(face, arc); }
  /// The lines of a face that an arc has to do with.
  static unsigned beside(const SkinArc& arc) { return arc.inner | 1u << arc.lines[0] | 1u << arc.lines[1]; }
};

CellCuts cuts_of(const Solid& solid, CellId c);
/// The same for a cell whose cut lines are known.
CellCuts cuts_of(const Solid& solid, CellId c, unsigned cut_lines);

/// Which lines of the skin belong to one fan around its centre: those that its arcs join but where they are rims. Of
/// each line of the skin, the lowest line of its fan.
std::array<std::uint8_t, 12> fans_of(const CellCuts& cell);

struct Part {
  std::uint8_t nodes = 0;  ///< bits of material vertices
  std::uint16_t rinds = 0; ///< bits of lines that are cut twice
};

/// Those with nodes first, by lowest vertex; then those of rinds alone, by lowest line.
struct Parts {
  int n = 0;
  std::array<Part, 16> items{};

  const Part* begin() const { return items.data(); }
  const Part* end() const { return items.data() + n; }
};

Parts parts_of(const CellCuts& cell);
/// Of one face of the cell.
Parts parts_of(const CellCuts& cell, int face);

/// Have two parts of cells that share a face, one below and one above it along an axis, material in common there: a
/// node, or a rind?
constexpr bool are_glued(const Part& below, const Part& above, const int axis) {
  constexpr std::array<unsigned, 3> lower_face = {cube::face_mask(0), cube::face_mask(2), cube::face_mask(4)};
  if ((below.nodes >> (1 << axis) & above.nodes & lower_face[axis]) != 0)
    return true;
  if (below.rinds == 0 || above.rinds == 0)
    return false;
  for (int i = 0; i < 4; ++i)
    if ((below.rinds >> cube::face_lines[2 * axis + 1][i] & above.rinds >> cube::face_lines[2 * axis][i] & 1) != 0)
      return true;
  return false;
}

} // namespace kerf::grid
