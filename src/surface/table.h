#pragma once

/// The Splitting Cubes table (thesis §2.4.2, §2.5): for each of the 4096 sets of cut lines of a cell, the
/// quadrilaterals of the surface inside it. Built from first principles: for each cut line and each of its two ends
/// s, one quadrilateral (edge vertex, face vertex, centre, face vertex), counter-clockwise seen from outside of the
/// material of s.
///
/// Which vertices are one: an edge vertex belongs to (line, end); a face vertex to (face, component within the face's
/// own four lines); a centre to (component of the cell). A component is named by its smallest vertex. The face's own
/// lines decide, as the thesis says in words; reachability through the cell, as its figure may be read, differs
/// between the two cells of a face at a cut's front and would tear the surface there.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace kerf::surface {

enum class VertexKind : std::uint8_t { edge = 0, face = 1, centre = 2 };

struct TableVertex {
  VertexKind kind;
  std::uint8_t index; ///< line, face, or 0
  std::uint8_t side;  ///< the end of the line for an edge vertex, else the component: its smallest vertex in the cell
};

struct Quad {
  std::array<TableVertex, 4> vertices; ///< edge vertex, face vertex, centre, face vertex
  std::uint8_t line;                   ///< the cut line
  std::uint8_t end;                    ///< the vertex of the cell whose material this bounds
};

class SplittingTable {
 public:
  static constexpr unsigned n_rows = 4096;

  SplittingTable();

  std::span<const Quad> row(unsigned cut_lines) const {
    return std::span(quads_).subspan(row_start_[cut_lines], row_start_[cut_lines + 1] - row_start_[cut_lines]);
  }
  std::uint8_t cell_component(unsigned cut_lines, int vertex) const { return cell_component_[cut_lines][vertex]; }

  std::span<const std::uint32_t> row_start() const { return row_start_; }
  std::span<const Quad> quads() const { return quads_; }

 private:
  std::vector<std::uint32_t> row_start_;
  std::vector<Quad> quads_;
  std::vector<std::array<std::uint8_t, 8>> cell_component_;
};

/// The one table; built at first use, never changed.
const SplittingTable& splitting_table();

/// The component of `vertex` within a face: the smallest vertex reached along uncut lines of that face.
int face_component(unsigned cut_lines, int face, int vertex);

} // namespace kerf::surface
