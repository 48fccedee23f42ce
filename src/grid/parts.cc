#include "grid/parts.h"

#include "grid/solid.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace kerf::grid {

namespace {

/// Lines between a material and an empty vertex, by the material vertices.
constexpr std::array<std::uint16_t, 256> skin_lines = [] {
  std::array<std::uint16_t, 256> lines{};
  for (unsigned material = 0; material < 256; ++material)
    for (int line = 0; line < cube::n_lines; ++line)
      if (const auto& [v, w] = cube::line_vertices[line]; ((material >> v ^ material >> w) & 1) != 0)
        lines[material] |= static_cast<std::uint16_t>(1 << line);
  return lines;
}();

Parts parts_of_nodes(const unsigned material, const unsigned cut) {
  Parts result;
  for (unsigned left = material; left != 0; left &= ~unsigned(result.items[result.n++].nodes))
    result.items[result.n] = {cube::reachable(std::countr_zero(left), cut)};
  return result;
}

/// Parts that hold items of one group are one: the first of them.
Parts joined(const Parts& parts, const std::vector<Joined>* const groups) {
  if (!groups)
    return parts;
  std::array<Joined, skeleton::n_items> all;
  std::ranges::transform(parts, all.begin(), [](const Part& part) { return Joined{part.items(), 0}; });
  for (const auto& [items, intervals] : *groups)
    for (int i = 0, first = -1; i < parts.n; ++i)
      if ((all[i].items & items) != 0) {
        if (first < 0) {
          first = i;
          all[i].intervals |= intervals;
        } else {
          all[first].items |= std::exchange(all[i].items, 0);
          all[first].intervals |= std::exchange(all[i].intervals, 0);
        }
      }
  Parts result;
  for (int i = 0; i < parts.n; ++i)
    if (all[i].items != 0) {
      Part& part = result.items[result.n++];
      part = Part::of(all[i].items);
      part.intervals = all[i].intervals;
    }
  return result;
}

SkinSegment skin_segment(const std::array<FaceId, 6>& faces, const CellId c, const int segment) {
  const int of_faces = segment - skeleton::first_half;
  return segment < skeleton::first_spoke ? SkinSegment::half(faces[of_faces / 4], of_faces % 4)
                                         : SkinSegment::spoke(c, segment - skeleton::first_spoke);
}

/// Of a cell with skin: what blades have cut of its lines, and of its skin.
Segments cut_by_blades(const Solid& solid, const CellId c, const unsigned cut_lines, const Skeleton& skeleton) {
  const Cuts& cuts = solid.cuts;
  const auto edges = solid.grid.edges(c);
  Segments blades = cut_lines & ~unsigned(skin_lines[material_of(solid.grid, c)]);
  if (cuts.n_cut_twice() > 0)
    for (int line = 0; line < cube::n_lines; ++line)
      blades |= Segments((skeleton.items >> skeleton::on_line(line) & 1) != 0 && cuts.is_cut_twice(edges[line]))
                << line;
  if (cuts.skin_cuts().empty())
    return blades;
  const auto faces = solid.grid.faces(c);
  for (Segments left = skeleton.segments & ~skeleton::lines; left != 0; left &= left - 1)
    if (const int segment = std::countr_zero(left); cuts.is_cut(skin_segment(faces, c, segment)))
      blades |= Segments(1) << segment;
  return blades;
}

} // namespace

unsigned material_of(const Grid& grid, const CellId c) {
  const auto nodes = grid.nodes(c);
  unsigned material = 0;
  for (int v = 0; v < cube::n_vertices; ++v)
    material |= unsigned(grid.is_material(nodes[v])) << v;
  return material;
}

SkinSegment skin_segment(const Grid& grid, const CellId c, const int segment) {
  return skin_segment(grid.faces(c), c, segment);
}

CellCuts cuts_of(const Solid& solid, const CellId c) {
  return cuts_of(solid, c, solid.cuts.configuration(solid.grid, c));
}

CellCuts with(CellCuts cell, const Segments ahead) {
  cell.cut |= static_cast<unsigned>(ahead & skeleton::lines & ~Segments(skin_lines[cell.material]));
  cell.blades |= ahead;
  return without_joined(cell);
}

CellCuts without(CellCuts cell, const Segments cut) {
  cell.cut &= ~static_cast<unsigned>(cut & skeleton::lines & ~Segments(skin_lines[cell.material]));
  cell.blades &= ~cut;
  return cell;
}

CellCuts cuts_of_copies(const Solid& solid, const CellId c) {
  const Front* const front = solid.cuts.front(c);
  return front ? with(cuts_of(solid, c), front->ahead) : cuts_of(solid, c);
}

Segments cut_by(const Solid& solid, const CellId c, const CutLabel label) {
  const auto edges = solid.grid.edges(c);
  Segments found = 0;
  for (Segments left = cuts_of(solid, c).blades; left != 0; left &= left - 1) {
    const int segment = std::countr_zero(left);
    const CutLabel by = segment < skeleton::first_half ? solid.cuts.find(edges[segment])->label
                                                       : solid.cuts.find(skin_segment(solid.grid, c, segment))->label;
    found |= by == label ? left & -left : 0;
  }
  return found;
}

CellCuts cuts_of(const Solid& solid, const CellId c, const unsigned cut_lines) {
  CellCuts result{material_of(solid.grid, c), cut_lines, cut_lines, solid.cuts.joined(c)};
  if (result.has_skin())
    result.blades = cut_by_blades(solid, c, cut_lines, result.skeleton());
  return result;
}

Parts parts_of(const CellCuts& cell) {
  return cell.is_cut_at_skin() ? whole_parts_of(cell) : joined(parts_of_nodes(cell.material, cell.cut), cell.joined);
}

Parts whole_parts_of(const CellCuts& cell) {
  const Skeleton& skeleton = cell.skeleton();
  Parts result;
  for (Items left = skeleton.items; left != 0; left &= ~result.items[result.n++].items())
    result.items[result.n] = Part::of(skeleton.reachable(left & -left, cell.blades));
  return joined(result, cell.joined);
}

} // namespace kerf::grid
