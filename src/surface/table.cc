#include "surface/table.h"

#include "base/vec.h"
#include "grid/cube.h"

#include <bit>

namespace kerf::surface {

namespace cube = grid::cube;

namespace {

Quad make_quad(const unsigned cut_lines, const int line, const int end, const std::uint8_t component) {
  const int axis = cube::line_axis(line), b = (axis + 1) % 3, c = (axis + 2) % 3;
  const auto edge = TableVertex{VertexKind::edge, static_cast<std::uint8_t>(line), static_cast<std::uint8_t>(end)};
  const auto centre = TableVertex{VertexKind::centre, 0, component};
  const auto face_vertex = [&](const int normal) {
    const int face = cube::face_at(end, normal);
    return TableVertex{VertexKind::face, static_cast<std::uint8_t>(face),
                       static_cast<std::uint8_t>(face_component(cut_lines, face, end))};
  };
  // Seen along +axis from the edge, the face with normal c lies in direction +-b and the one with normal b in +-c.
  // Reflections of the cell flip the turn, and so does looking from the other end.
  const bool b_first = (std::popcount(static_cast<unsigned>(end)) & 1) == 0;
  return {{edge, face_vertex(b_first ? c : b), centre, face_vertex(b_first ? b : c)},
          static_cast<std::uint8_t>(line),
          static_cast<std::uint8_t>(end)};
}

} // namespace

int face_component(const unsigned cut_lines, const int face, const int vertex) {
  return std::countr_zero(cube::reachable(vertex, cut_lines, cube::face_mask(face)));
}

SplittingTable::SplittingTable() : cell_component_(n_rows) {
  row_start_.reserve(n_rows + 1);
  for (unsigned cut_lines = 0; cut_lines < n_rows; ++cut_lines) {
    row_start_.push_back(static_cast<std::uint32_t>(quads_.size()));
    for (int v = 0; v < cube::n_vertices; ++v)
      cell_component_[cut_lines][v] = static_cast<std::uint8_t>(std::countr_zero(cube::reachable(v, cut_lines)));
    for (int line = 0; line < cube::n_lines; ++line)
      if (cut_lines >> line & 1)
        for (const int end : cube::line_vertices[line])
          quads_.push_back(make_quad(cut_lines, line, end, cell_component_[cut_lines][end]));
  }
  row_start_.push_back(static_cast<std::uint32_t>(quads_.size()));
}

const SplittingTable& splitting_table() {
  static const SplittingTable table;
  return table;
}

} // namespace kerf::surface
