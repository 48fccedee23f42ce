#pragma once

/// The unit cube's local numbering of vertices, lines and faces: deal.II's (GeometryInfo<3>), as compile-time tables.
/// Vertex v has lattice offsets (v & 1, v >> 1 & 1, v >> 2 & 1).

#include <array>
#include <cstdint>

namespace kerf::grid::cube {

constexpr int n_vertices = 8, n_lines = 12, n_faces = 6;

/// The two vertices of a line, lower first.
constexpr std::array<std::array<int, 2>, 12> line_vertices = {
  {{0, 2}, {1, 3}, {0, 1}, {2, 3}, {4, 6}, {5, 7}, {4, 5}, {6, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};

constexpr std::array<std::array<int, 4>, 6> face_lines = {
  {{8, 10, 0, 4}, {9, 11, 1, 5}, {2, 6, 8, 9}, {3, 7, 10, 11}, {0, 1, 2, 3}, {4, 5, 6, 7}}};

constexpr std::array<std::array<int, 4>, 6> face_vertices = {
  {{0, 2, 4, 6}, {1, 3, 5, 7}, {0, 4, 1, 5}, {2, 6, 3, 7}, {0, 1, 2, 3}, {4, 5, 6, 7}}};

/// Bits of the lines of a face.
constexpr std::array<unsigned, 6> lines_of_face = [] {
  std::array<unsigned, 6> masks{};
  for (int face = 0; face < 6; ++face)
    for (const int line : face_lines[face])
      masks[face] |= 1u << line;
  return masks;
}();

/// 0, 1, 2 for a line along x, y, z.
constexpr int line_axis(const int line) {
  const int difference = line_vertices[line][1] - line_vertices[line][0];
  return difference == 1 ? 0 : difference == 2 ? 1 : 2;
}

/// 0, 1, 2 for a face whose normal is along x, y, z.
constexpr int face_axis(const int face) { return face / 2; }

/// The line that joins `vertex` to its neighbour along `axis`.
constexpr int line_at(const int vertex, const int axis) {
  const int lower = vertex & ~(1 << axis);
  for (int line = 0; line < n_lines; ++line)
    if (line_vertices[line][0] == lower && line_axis(line) == axis)
      return line;
  return -1;
}

/// The face at `vertex` whose normal is along `axis`.
constexpr int face_at(const int vertex, const int axis) { return 2 * axis + (vertex >> axis & 1); }

/// The place of a line of a face among cube::face_lines.
constexpr int place_in_face(const int face, const int line) {
  int place = 0;
  for (int i = 1; i < 4; ++i)
    if (face_lines[face][i] == line)
      place = i;
  return place;
}

/// Bits of the vertices that can be reached from `vertex` without crossing a line of `cut_lines` (12 bits), staying
/// inside `allowed` (8 bits).
constexpr std::uint8_t reachable(const int vertex, const unsigned cut_lines, const unsigned allowed = 0xff) {
  unsigned reached = 1u << vertex, before = 0;
  while (reached != before) {
    before = reached;
    for (int line = 0; line < n_lines; ++line) {
      const unsigned ends = (1u << line_vertices[line][0]) | (1u << line_vertices[line][1]);
      if (!(cut_lines >> line & 1) && (ends & reached) && (ends & ~allowed) == 0)
        reached |= ends;
    }
  }
  return static_cast<std::uint8_t>(reached);
}

/// Bits of the vertices of a face.
constexpr unsigned face_mask(const int face) {
  unsigned mask = 0;
  for (const int v : face_vertices[face])
    mask |= 1u << v;
  return mask;
}

} // namespace kerf::grid::cube
