#pragma once

/// Where the triangles around a line, and the vertices in a face, stand in a surface's tables; for writer.h alone.

#include "grid/skeleton.h"

#include <bit>

namespace kerf::surface {

namespace cube = grid::cube;

inline constexpr std::size_t triangles_per_end = 8; // two in each of the four cells around an edge

/// Which of the four cells around a cell's line the cell is: the lattice offsets of the line across its axis.
inline constexpr std::array<int, 12> place_around_line = [] {
  std::array<int, 12> place{};
  for (int line = 0; line < cube::n_lines; ++line) {
    const int axis = cube::line_axis(line), lower = cube::line_vertices[line][0];
    place[line] = (lower >> (axis + 1) % 3 & 1) | (lower >> (axis + 2) % 3 & 1) << 1;
  }
  return place;
}();

/// The place of a vertex among those of its face.
constexpr int place_in_face(const int face, const int vertex) {
  int place = 0;
  for (int i = 1; i < 4; ++i)
    if (cube::face_vertices[face][i] == vertex)
      place = i;
  return place;
}

/// Of a part of a face, the same for both cells there: by the face's nodes, then lines, then arcs.
inline std::size_t place_in_face(const int face, const grid::Items part) {
  for (std::size_t i = 0; i < 4; ++i)
    if (part >> cube::face_vertices[face][i] & 1)
      return i;
  for (std::size_t i = 0; i < 4; ++i)
    if (part >> grid::skeleton::on_line(cube::face_lines[face][i]) & 1)
      return 4 + i;
  return part >> grid::skeleton::on_arc(face, 0) & 1 ? 8 : 9;
}

} // namespace kerf::surface
