#pragma once

/// How the skin passes through a face of a cube: each row of neighbouring material vertices, but not all four, has an
/// arc of the skin around it, from the cut edge at its one end to that at its other end.

#include "grid/cube.h"

#include <bit>

namespace kerf::grid {

struct SkinArc {
  std::array<std::uint8_t, 2> lines{};    ///< the two edges of the skin, as lines of the cell
  std::array<std::uint8_t, 2> vertices{}; ///< their material ends; one and the same where the row has just one
  std::uint16_t inner = 0;                ///< bits of the lines between the material vertices of the row
};

struct SkinArcs {
  std::uint8_t n = 0;
  std::array<SkinArc, 2> arcs{};

  constexpr const SkinArc* begin() const { return arcs.data(); }
  constexpr const SkinArc* end() const { return arcs.data() + n; }
};

namespace detail {

constexpr int line_between(const int v, const int w) {
  for (int line = 0; line < cube::n_lines; ++line)
    if ((cube::line_vertices[line][0] == v && cube::line_vertices[line][1] == w) ||
        (cube::line_vertices[line][0] == w && cube::line_vertices[line][1] == v))
      return line;
  return -1;
}

/// `pattern`: bit i for the i-th vertex of cube::face_vertices.
constexpr SkinArcs make_skin_arcs(const int face, const unsigned pattern) {
  constexpr std::array<int, 4> around = {0, 1, 3, 2}; // the face's vertices in the order of its sides
  const auto vertex = [&](const int i) { return cube::face_vertices[face][around[i & 3]]; };
  const auto is_material = [&](const int i) { return (pattern >> around[i & 3] & 1) != 0; };
  const auto line = [&](const int i) { return static_cast<std::uint8_t>(line_between(vertex(i), vertex(i + 1))); };
  SkinArcs result;
  for (int first = 0; first < 4; ++first) {
    if (!is_material(first) || is_material(first + 3))
      continue;
    SkinArc arc;
    int last = first;
    for (; is_material(last + 1) && last < first + 3; ++last)
      arc.inner |= static_cast<std::uint16_t>(1 << line(last));
    arc.lines = {line(first + 3), line(last)};
    arc.vertices = {static_cast<std::uint8_t>(vertex(first)), static_cast<std::uint8_t>(vertex(last))};
    result.arcs[result.n++] = arc;
  }
  return result;
}

} // namespace detail

/// By face, then by which of its vertices are material (bit i: the i-th of cube::face_vertices).
inline constexpr std::array<std::array<SkinArcs, 16>, 6> skin_arcs_of_face = [] {
  std::array<std::array<SkinArcs, 16>, 6> all{};
  for (int face = 0; face < cube::n_faces; ++face)
    for (unsigned pattern = 0; pattern < 16; ++pattern)
      all[face][pattern] = detail::make_skin_arcs(face, pattern);
  return all;
}();

/// Of a cell whose material vertices are given (8 bits).
constexpr const SkinArcs& skin_arcs(const int face, const unsigned material) {
  unsigned pattern = 0;
  for (int i = 0; i < 4; ++i)
    pattern |= (material >> cube::face_vertices[face][i] & 1) << i;
  return skin_arcs_of_face[face][pattern];
}

} // namespace kerf::grid
