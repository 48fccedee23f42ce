#pragma once

/// The parts that cuts leave of a cell: what of its skeleton holds together. Nodes, and where blades have cut the
/// points of the skin too, are joined by segments that are not cut; and where blades cross, by lying on the same side
/// of all (cut/sides.h).

#include "grid/cuts.h"
#include "grid/skeleton.h"

#include <bit>

namespace kerf::grid {

/// What cuts have done to a cell.
struct CellCuts {
  unsigned material = 0;                       ///< vertices (bits)
  unsigned cut = 0;                            ///< lines that are cut, by the skin or by blades (bits)
  Segments blades = 0;                         ///< segments that blades have cut
  const std::vector<Joined>* joined = nullptr; ///< Cuts::joined()

  const Skeleton& skeleton() const { return skeleton_of(material); }
  bool has_skin() const { return material != 0xff; }
  /// Have blades cut where the skin passes through? Then the cuts have vertices of their own, beside the skin's.
  bool is_cut_at_skin() const { return blades != 0 && has_skin(); }
};

CellCuts cuts_of(const Solid& solid, CellId c);
/// The same for a cell whose cut lines are known.
CellCuts cuts_of(const Solid& solid, CellId c, unsigned cut_lines);

/// Parted by segments alone.
inline CellCuts without_joined(CellCuts cell) {
  cell.joined = nullptr;
  return cell;
}
/// The same as if blades had cut these segments too.
CellCuts with(CellCuts cell, Segments ahead);
/// As if blades had not cut these.
CellCuts without(CellCuts cell, Segments cut);
/// What the cell's copies follow: where a cut ends in it, what is ahead of the front too.
CellCuts cuts_of_copies(const Solid& solid, CellId c);

/// The segments of a cell that blades of a label have cut.
Segments cut_by(const Solid& solid, CellId c, CutLabel label);

/// The segment of the skin that a segment of a cell is, from skeleton::first_half on.
SkinSegment skin_segment(const Grid& grid, CellId c, int segment);

/// Material vertices of a cell, as bits.
unsigned material_of(const Grid& grid, CellId c);

struct Part {
  std::uint8_t nodes = 0; ///< bits of material vertices
  /// Bits of its points of the skin, items from skeleton::first_on_line on; none where no blade has cut at the skin, as
  /// it is known then what they hang on.
  std::uint32_t skin = 0;
  Intervals intervals = 0; ///< where cuts cross (Cuts::joined)

  Items items() const { return nodes | Items(skin) << skeleton::first_on_line; }
  static Part of(const Items items) {
    return {static_cast<std::uint8_t>(items), static_cast<std::uint32_t>(items >> skeleton::first_on_line), 0};
  }
  bool operator==(const Part&) const = default;
};

/// By their lowest items: so those with nodes come first.
struct Parts {
  int n = 0;
  std::array<Part, skeleton::n_items> items;

  const Part* begin() const { return items.data(); }
  const Part* end() const { return items.data() + n; }
};

Parts parts_of(const CellCuts& cell);
/// With the points of the skin even where no blade has cut.
Parts whole_parts_of(const CellCuts& cell);

namespace detail {
/// Of the items of a cell those in a face: nodes, points on lines and arcs, by the face; so that bits of the two cells
/// at a face correspond.
constexpr unsigned in_face(const Part& part, const int face) {
  unsigned bits = 0;
  for (int i = 0; i < 4; ++i)
    bits |= (unsigned(part.nodes) >> cube::face_vertices[face][i] & 1) << i |
            (part.skin >> cube::face_lines[face][i] & 1) << (4 + i);
  constexpr int first = skeleton::first_on_arc - skeleton::first_on_line;
  return bits | (part.skin >> (first + 2 * face) & 3) << 8;
}
constexpr bool share_interval(const Part& below, const Part& above, const int axis) {
  const auto of_segment = [](const Part& part, const int segment) {
    return (part.intervals & skeleton::intervals_of(segment)) >> std::countr_zero(skeleton::intervals_of(segment));
  };
  for (int i = 0; i < 8; ++i)
    if ((of_segment(below, skeleton::in_face(2 * axis + 1, i)) & of_segment(above, skeleton::in_face(2 * axis, i))) !=
        0)
      return true;
  return false;
}
} // namespace detail

/// Have two parts of cells that share a face, one below and one above it along an axis, material in common there?
constexpr bool are_glued(const Part& below, const Part& above, const int axis) {
  constexpr std::array<unsigned, 3> lower_face = {cube::face_mask(0), cube::face_mask(2), cube::face_mask(4)};
  if ((below.nodes >> (1 << axis) & above.nodes & lower_face[axis]) != 0)
    return true;
  if (below.skin != 0 && above.skin != 0 &&
      (detail::in_face(below, 2 * axis + 1) & detail::in_face(above, 2 * axis)) != 0)
    return true;
  return below.intervals != 0 && above.intervals != 0 && detail::share_interval(below, above, axis);
}

} // namespace kerf::grid
