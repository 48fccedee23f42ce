#include "grid/parts.h"

#include "grid/solid.h"

#include <algorithm>

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

/// Without rinds, and no skin that joins anything.
Parts parts_of_nodes(const unsigned material, const unsigned cut) {
  Parts result;
  for (unsigned left = material; left != 0; left &= ~unsigned(result.items[result.n++].nodes))
    result.items[result.n].nodes = cube::reachable(std::countr_zero(left), cut);
  return result;
}

/// Joins items: vertices 0 .. 7, and rinds of lines 0 .. 11 behind them.
class Joints {
 public:
  static constexpr int first_rind = 8, n_items = 20;

  explicit Joints(const CellCuts& cell) : cell_(cell) {
    for (int i = 0; i < n_items; ++i)
      name_[i] = static_cast<std::uint8_t>(i);
  }

  void join_nodes(const unsigned lines) {
    for (int line = 0; line < cube::n_lines; ++line)
      if (const auto& [v, w] = cube::line_vertices[line];
          (lines & ~cell_.cut) >> line & 1 && cell_.material >> v & cell_.material >> w & 1)
        join(v, w);
  }

  void join_under_skin(const int face) {
    for (const SkinArc& arc : skin_arcs(face, cell_.material))
      if (cell_.is_whole(face, arc))
        join(under(arc, 0), under(arc, 1));
  }

  Parts parts(const unsigned vertices, const unsigned lines) const {
    Parts result;
    std::array<std::int8_t, n_items> part_of;
    part_of.fill(-1);
    const auto part = [&](const int item) -> Part& {
      std::int8_t& i = part_of[name_[item]];
      if (i < 0)
        i = static_cast<std::int8_t>(result.n++);
      return result.items[i];
    };
    for (int v = 0; v < cube::n_vertices; ++v)
      if (cell_.material & vertices & 1u << v)
        part(v).nodes |= static_cast<std::uint8_t>(1u << v);
    for (int line = 0; line < cube::n_lines; ++line)
      if (cell_.twice & lines & 1u << line)
        part(first_rind + line).rinds |= static_cast<std::uint16_t>(1u << line);
    return result;
  }

 private:
  /// What lies under the skin at an end of its arc.
  int under(const SkinArc& arc, const int end) const {
    return cell_.twice >> arc.lines[end] & 1 ? first_rind + arc.lines[end] : arc.vertices[end];
  }

  void join(const int a, const int b) {
    const std::uint8_t p = name_[a], q = name_[b];
    if (p != q)
      std::replace(name_.begin(), name_.end(), std::max(p, q), std::min(p, q));
  }

  const CellCuts& cell_;
  std::array<std::uint8_t, n_items> name_; // the smallest item that this one is joined to
};

} // namespace

bool CellCuts::has_two_points(const int face) const {
  return blades() != 0 && std::ranges::any_of(skin_arcs(face, material),
                                              [&](const SkinArc& arc) { return (blades() & beside(arc)) != 0; });
}

CellCuts cuts_of(const Solid& solid, const CellId c) {
  return cuts_of(solid, c, solid.cuts.configuration(solid.grid, c));
}

CellCuts cuts_of(const Solid& solid, const CellId c, const unsigned cut_lines) {
  CellCuts result;
  result.cut = cut_lines;
  const auto nodes = solid.grid.nodes(c);
  for (int v = 0; v < cube::n_vertices; ++v)
    result.material |= unsigned(solid.grid.is_material(nodes[v])) << v;
  result.skin = skin_lines[result.material];
  if (result.skin == 0)
    return result;
  if (solid.cuts.n_cut_twice() > 0) {
    const auto edges = solid.grid.edges(c);
    for (int line = 0; line < cube::n_lines; ++line)
      result.twice |= unsigned((result.skin >> line & 1) != 0 && solid.cuts.is_cut_twice(edges[line])) << line;
  }
  if (result.blades() != 0) {
    const auto faces = solid.grid.faces(c);
    for (int face = 0; face < cube::n_faces; ++face)
      result.seams[face] = solid.cuts.seam(faces[face]);
  }
  return result;
}

std::array<std::uint8_t, 12> fans_of(const CellCuts& cell) {
  std::array<std::uint8_t, 12> fans;
  for (std::uint8_t line = 0; line < cube::n_lines; ++line)
    fans[line] = line;
  for (int face = 0; face < cube::n_faces; ++face)
    for (const SkinArc& arc : skin_arcs(face, cell.material))
      if (const std::uint8_t p = fans[arc.lines[0]], q = fans[arc.lines[1]]; p != q && !cell.is_rim(face, arc))
        std::replace(fans.begin(), fans.end(), std::max(p, q), std::min(p, q));
  return fans;
}

Parts parts_of(const CellCuts& cell) {
  if (cell.skin == 0 || cell.blades() == 0)
    return parts_of_nodes(cell.material, cell.cut);
  Joints joints(cell);
  joints.join_nodes(0xfff);
  for (int face = 0; face < cube::n_faces; ++face)
    joints.join_under_skin(face);
  return joints.parts(0xff, 0xfff);
}

Parts parts_of(const CellCuts& cell, const int face) {
  Joints joints(cell);
  joints.join_nodes(cube::lines_of_face[face]);
  joints.join_under_skin(face);
  return joints.parts(cube::face_mask(face), cube::lines_of_face[face]);
}

} // namespace kerf::grid
