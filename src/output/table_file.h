#pragma once

/// The Splitting Cubes table as a file of its own, for others to read: plain arrays that say in their attributes what
/// they are.
///
///     /                attributes: title, version, source, numbering, surface
///     /cell_component  4096 x 8      smallest vertex of the cell's component of each vertex
///     /face_component  4096 x 6 x 4  smallest vertex of the face's component of each of its vertices
///     /row_start       4097          quads of row c: row_start[c] .. row_start[c + 1]
///     /quads           n x 4 x 3     per corner its kind, index and side; those of corner 0 are the cut line
///                                    and the vertex of the cell whose material the quad bounds
///     /line_vertices, /face_vertices, /face_lines   the numbering itself, deal.II's
/// Each dataset has the attributes description and columns.
/// Source: thesis §2.4.2, §2.5.

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace kerf::output {

struct SplittingTable {
  using Vertex = std::array<std::uint8_t, 3>; ///< kind: 0 edge, 1 face, 2 centre; index: line, face or 0; side

  std::vector<std::array<std::uint8_t, 8>> cell_component;                ///< per row, per vertex of the cell
  std::vector<std::array<std::array<std::uint8_t, 4>, 6>> face_component; ///< per row, per face, per vertex of it
  std::vector<std::uint32_t> row_start;
  std::vector<std::array<Vertex, 4>> quads;
  std::array<std::array<int, 2>, 12> line_vertices;
  std::array<std::array<int, 4>, 6> face_vertices, face_lines;
};

/// Writes the file, or replaces it. Throws DataError when it cannot be written, or arrays do not fit each other.
void write_table_file(const std::filesystem::path& path, const SplittingTable& table, const std::string& version);

} // namespace kerf::output
