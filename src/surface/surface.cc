#include "surface/surface.h"

#include "base/parallel.h"
#include "grid/cube.h"
#include "grid/shape.h"
#include "grid/touched.h"
#include "surface/table.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <bitset>

namespace kerf::surface {

namespace cube = grid::cube;
using grid::CellComplex;
using grid::CellId;
using grid::CopyId;
using grid::Cuts;
using grid::EdgeId;
using grid::FaceId;
using grid::Grid;
using grid::NodeId;

namespace {

constexpr std::uint32_t unset = Id<void>::no_value;
constexpr std::size_t triangles_per_end = 8; // two in each of the four cells around an edge

/// Which of the four cells around a cell's line the cell is: the lattice offsets of the line across its axis.
constexpr std::array<int, 12> place_around_line = [] {
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

/// What a writer does with a vertex that is there already.
enum class Known { kept, renewed };

/// Writes the vertices and triangles of cells. A vertex that several cells share is made by the first of them; its
/// place and weights come from its edge or face alone, so that they are the same bits whichever cell writes them.
class Writer {
 public:
  Writer(const Grid& grid, const Cuts& cuts, const CellComplex& complex, Surface& surface, SurfaceIndex& index,
         const Known known)
    : grid_(grid), cuts_(cuts), complex_(complex), surface_(surface), index_(index), known_(known) {
    make_room();
  }

  /// All cells with a cut edge.
  void write_all() {
    std::vector<EdgeId> edges;
    edges.reserve(cuts_.all().size());
    for (const grid::EdgeCut& cut : cuts_.all())
      edges.push_back(cut.edge);
    for (const grid::TouchedCell& touched : grid::touched_cells(grid_, edges)) // by which lines is its configuration
      write(touched.cell, touched.lines);
  }

  void write(const CellId cell) { write(cell, cuts_.configuration(grid_, cell)); }

 private:
  void write(const CellId cell, const unsigned cut_lines) {
    if (cut_lines == 0)
      return;
    enter(cell, cut_lines);
    for (const Quad& quad : table_.row(cut_lines))
      if (copy_at_[quad.end].valid()) // else the empty side of the skin
        write(quad);
  }

  /// Triangles for all cuts, and tables for all copies and faces.
  void make_room() {
    const auto cuts = cuts_.all();
    std::size_t n = surface_.triangles.size();
    for (std::size_t i = index_.first_triangle.size(); i < cuts.size(); ++i) {
      index_.first_triangle.push_back(static_cast<std::uint32_t>(n));
      for (const NodeId end : grid_.ends(cuts[i].edge))
        n += grid_.is_material(end) ? triangles_per_end : 0;
      surface_.labels.resize(n, cuts[i].label);
    }
    surface_.triangles.resize(n);
    surface_.copies.resize(n);
    index_.edge_vertices.resize(2 * cuts.size(), unset);
    index_.centres.resize(complex_.n_copies(), unset);
  }

  void enter(const CellId cell, const unsigned cut_lines) {
    cell_ = cell;
    faces_ = grid_.faces(cell);
    lower_ = grid_.index(grid_.nodes(cell)[0]);
    seen_.reset();
    const auto edges = grid_.edges(cell);
    for (unsigned left = cut_lines; left != 0; left &= left - 1)
      cut_[std::countr_zero(left)] = cuts_.index(edges[std::countr_zero(left)]);
    copy_at_.fill(CopyId());
    for (const CopyId c : complex_.copies_of(cell))
      for (int v = 0; v < cube::n_vertices; ++v)
        if (complex_.copies[c].nodes >> v & 1)
          copy_at_[v] = c;
  }

  void write(const Quad& quad) {
    const CopyId copy = copy_at_[quad.end];
    const auto& vertices = quad.vertices;
    const std::uint32_t edge = edge_vertex(copy, vertices[0]), first = face_vertex(copy, vertices[1]),
                        middle = centre(copy, vertices[2]), second = face_vertex(copy, vertices[3]);
    const auto& [lower, upper] = cube::line_vertices[quad.line];
    const bool is_second = quad.end == upper && copy_at_[lower].valid();
    const std::size_t t = index_.first_triangle[cut_[quad.line]] + (is_second ? triangles_per_end : 0) +
                          2 * static_cast<std::size_t>(place_around_line[quad.line]);
    surface_.triangles[t] = {edge, first, middle};
    surface_.triangles[t + 1] = {edge, middle, second};
    surface_.copies[t] = surface_.copies[t + 1] = copy;
  }

  /// Of a vertex of the cell.
  Vec3 node_position(const int vertex) const {
    return grid_.lattice().position(
      {lower_[0] + (vertex & 1), lower_[1] + (vertex >> 1 & 1), lower_[2] + (vertex >> 2 & 1)});
  }

  std::uint32_t edge_vertex(const CopyId copy, const TableVertex& v) {
    const auto& [lower, upper] = cube::line_vertices[v.index];
    const bool is_upper = v.side == upper;
    std::uint32_t& id = index_.edge_vertices[2 * cut_[v.index] + is_upper];
    if (is_wanted(id, 2 * v.index + is_upper)) {
      const int axis = cube::line_axis(v.index);
      const double t = cuts_.all()[cut_[v.index]].t;
      Vec3 p = node_position(lower), xi = Vec3::Zero();
      p[axis] += grid_.h() * t;
      xi[axis] = t;
      set(id, p, xi, copy, (1u << lower) | (1u << upper));
    }
    return id;
  }

  std::uint32_t face_vertex(const CopyId copy, const TableVertex& v) {
    const int place = 24 + 8 * v.index + v.side;
    if (seen_[place])
      return in_cell_[place];
    std::uint32_t& first = index_.first_face_vertex.at(faces_[v.index]);
    if (first == unset) {
      first = static_cast<std::uint32_t>(index_.face_vertices.size());
      index_.face_vertices.resize(index_.face_vertices.size() + 4, unset);
    }
    std::uint32_t& id = index_.face_vertices[first + place_in_face(v.index, v.side)];
    if (is_wanted(id, place)) {
      const Vec3 p = grid::face_point(grid_, cuts_, faces_[v.index]);
      set(id, p, (p - node_position(cube::face_vertices[v.index][0])) / grid_.h(), copy, cube::face_mask(v.index));
    }
    return in_cell_[place] = id;
  }

  std::uint32_t centre(const CopyId copy, const TableVertex& v) {
    std::uint32_t& id = index_.centres[copy];
    if (is_wanted(id, 72 + v.side)) {
      const Vec3 p = grid::cell_point(grid_, cuts_, cell_);
      set(id, p, (p - node_position(0)) / grid_.h(), copy, 0xff);
    }
    return id;
  }

  /// True for a vertex that is to be made, or to be renewed for the first time in this cell.
  bool is_wanted(const std::uint32_t id, const int vertex_of_cell) {
    const bool was_seen = seen_[vertex_of_cell];
    seen_[vertex_of_cell] = true;
    return id == unset || (known_ == Known::renewed && !was_seen);
  }

  /// Writes a vertex at rest position p whose weights go to the corners in `support` (bits) of the copy.
  void set(std::uint32_t& id, const Vec3& p, const Vec3& xi, const CopyId copy, const unsigned support) {
    Weights& w = surface_.weights;
    if (id == unset) {
      id = static_cast<std::uint32_t>(surface_.rest.size());
      surface_.rest.push_back(p);
      w.row_start.push_back(w.row_start.back() + static_cast<std::uint32_t>(std::bitset<8>(support).count()));
      w.corners.resize(w.row_start.back());
      w.values.resize(w.row_start.back());
    } else
      surface_.rest[id] = p;
    const auto factors = shape_factors(xi, support);
    const auto& corners = complex_.copies[copy].corners;
    std::uint32_t entry = w.row_start[id];
    for (unsigned left = support; left != 0; left &= left - 1, ++entry) {
      const int v = std::countr_zero(left);
      w.corners[entry] = corners[v];
      w.values[entry] = factors[0][v & 1] * factors[1][v >> 1 & 1] * factors[2][v >> 2 & 1];
    }
  }

  /// The factors of the shape functions along each axis, of vertices at 0 and at 1 there (grid/shape.h).
  static std::array<std::array<double, 2>, 3> shape_factors(const Vec3& xi, const unsigned support) {
    std::array<std::array<double, 2>, 3> factors;
    for (int d = 0; d < 3; ++d) {
      const bool reaches = (support & grid::upper_vertices[d]) != 0 && (support & ~grid::upper_vertices[d]) != 0;
      factors[d] = reaches ? std::array{1 - xi[d], xi[d]} : std::array{1.0, 1.0};
    }
    return factors;
  }

  const Grid& grid_;
  const Cuts& cuts_;
  const CellComplex& complex_;
  const SplittingTable& table_ = splitting_table();
  Surface& surface_;
  SurfaceIndex& index_;
  Known known_;

  CellId cell_;
  std::array<FaceId, 6> faces_;
  Index3 lower_{};
  std::array<std::uint32_t, 12> cut_; // by line: place in cuts_.all()
  std::array<CopyId, 8> copy_at_;
  std::bitset<80> seen_;                  // 24 edge vertices, 48 face vertices, 8 centres
  std::array<std::uint32_t, 80> in_cell_; // ids of seen ones, face vertices only
};

/// Room for the vertices of closed surfaces with so many triangles: half as many, by Euler; of four, one is on an edge,
/// two are in faces and one in a cell.
void reserve_vertices(Surface& surface) {
  constexpr double entries_per_vertex = (2 + 2 * 4 + 8) / 4.0, spare = 1.05;
  const auto n = static_cast<std::size_t>(spare * 0.5 * static_cast<double>(surface.triangles.size()));
  surface.rest.reserve(n);
  surface.weights.row_start.reserve(n + 1);
  surface.weights.corners.reserve(static_cast<std::size_t>(entries_per_vertex * static_cast<double>(n)));
  surface.weights.values.reserve(static_cast<std::size_t>(entries_per_vertex * static_cast<double>(n)));
}

/// The cells whose part of the surface an update writes.
std::vector<CellId> cells_to_write(const Grid& grid, const CellComplex& complex,
                                   const std::span<const EdgeId> new_edges, const grid::ComplexChange& change) {
  std::vector<CellId> cells;
  for (const grid::TouchedCell& touched : grid::touched_cells(grid, new_edges))
    cells.push_back(touched.cell);
  for (const CopyId c : change.copies)
    cells.push_back(complex.copies[c].cell);
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

template <class T>
std::size_t bytes(const std::vector<T>& items) {
  return items.capacity() * sizeof(T);
}

} // namespace

std::size_t Surface::n_bytes() const {
  return bytes(rest) + bytes(triangles) + bytes(labels) + bytes(copies) + bytes(weights.row_start) +
         bytes(weights.corners) + bytes(weights.values);
}

std::size_t SurfaceIndex::n_bytes() const {
  return first_face_vertex.n_bytes() + bytes(face_vertices) + bytes(edge_vertices) + bytes(first_triangle) +
         bytes(centres.items());
}

Surface build_surface(const Grid& grid, const Cuts& cuts, const CellComplex& complex) {
  SurfaceIndex index;
  return build_surface(grid, cuts, complex, index);
}

Surface build_surface(const Grid& grid, const Cuts& cuts, const CellComplex& complex, SurfaceIndex& index) {
  Surface surface;
  index = {};
  index.first_face_vertex = grid::SparseIndex<FaceId>(grid.n_faces());
  index.centres.reserve(complex.copies.items().capacity());
  Writer writer(grid, cuts, complex, surface, index, Known::kept);
  reserve_vertices(surface);
  writer.write_all();
  return surface;
}

void update_surface(const Grid& grid, const Cuts& cuts, const CellComplex& complex,
                    const std::span<const EdgeId> new_edges, const grid::ComplexChange& change, Surface& surface,
                    SurfaceIndex& index) {
  Writer writer(grid, cuts, complex, surface, index, Known::renewed);
  for (const CellId cell : cells_to_write(grid, complex, new_edges, change))
    writer.write(cell);
}

void follow(const Surface& surface, const Points& corners, Points& positions) {
  const Weights& w = surface.weights;
  positions.resize(w.n_rows());
  parallel_for(positions.size(), [&](const std::size_t i) {
    Vec3 p = Vec3::Zero();
    for (std::uint32_t k = w.row_start[i]; k < w.row_start[i + 1]; ++k)
      p += w.values[k] * corners[w.corners[k].value];
    positions[i] = p;
  });
}

double enclosed_volume(const Points& positions, const std::vector<Triangle>& triangles) {
  if (triangles.empty())
    return 0;
  const Vec3 reference = positions[triangles[0][0]]; // near the body: less cancellation
  double six_volumes = 0;
  for (const auto& [a, b, c] : triangles)
    six_volumes += (positions[a] - reference).dot((positions[b] - reference).cross(positions[c] - reference));
  return six_volumes / 6;
}

std::vector<double> piece_volumes(const Surface& surface, const CellComplex& complex) {
  const grid::Pieces pieces = grid::pieces(complex);
  std::vector<double> volumes(pieces.n_pieces, 0.0);
  if (surface.triangles.empty())
    return volumes;
  const Vec3 reference = surface.rest[surface.triangles[0][0]];
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const auto& [a, b, c] = surface.triangles[i];
    const Vec3 &p = surface.rest[a], &q = surface.rest[b], &r = surface.rest[c];
    volumes[pieces.piece[surface.copies[i]]] += (p - reference).dot((q - reference).cross(r - reference)) / 6;
  }
  return volumes;
}

} // namespace kerf::surface
