#pragma once

/// Writes vertices and triangles of a surface, cell by cell; for surface.cc alone.

#include "grid/cube.h"
#include "grid/shape.h"
#include "grid/touched.h"
#include "surface/surface.h"
#include "surface/table.h"

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
using grid::Solid;

inline constexpr std::uint32_t unset = Id<void>::no_value;
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

/// What a writer does with a vertex that is there already.
enum class Known { kept, renewed };

/// Writes the vertices and triangles of cells. A vertex that several cells share is made by the first of them; its
/// place and weights come from its edge or face alone, so that they are the same bits whichever cell writes them.
class Writer {
 public:
  Writer(const Solid& solid, Surface& surface, SurfaceIndex& index, const Known known)
    : solid_(solid), surface_(surface), index_(index), known_(known) {
    make_room();
  }

  /// All cells with a cut edge.
  void write_all() {
    std::vector<EdgeId> edges;
    edges.reserve(solid_.cuts.all().size());
    for (const grid::EdgeCut& cut : solid_.cuts.all())
      edges.push_back(cut.edge);
    for (const grid::TouchedCell& touched :
         grid::touched_cells(solid_.grid, edges)) // by which lines is its configuration
      write(touched.cell, touched.lines);
  }

  void write(const CellId cell) { write(cell, solid_.cuts.configuration(solid_.grid, cell)); }

 private:
  void write(const CellId cell, const unsigned cut_lines) {
    if (cut_lines == 0)
      return;
    enter(cell, cut_lines);
    if (const grid::CellCuts cell_cuts = grid::cuts_of(solid_, cell, cut_lines);
        cell_cuts.skin != 0 && cell_cuts.blades() != 0) {
      write_sheets(cell_cuts);
      return;
    }
    for (const Quad& quad : table_.row(cut_lines))
      if (copy_at_[quad.end].valid()) // else the empty side of the skin
        write(quad);
  }

  /// Triangles for all cuts, and tables for all copies and faces.
  void make_room() {
    const auto cuts = solid_.cuts.all();
    std::size_t n = surface_.triangles.size();
    for (std::size_t i = index_.first_triangle.size(); i < cuts.size(); ++i) {
      index_.first_triangle.push_back(static_cast<std::uint32_t>(n));
      if (solid_.cuts.is_cut_twice(cuts[i].edge) && solid_.cuts.index(cuts[i].edge) == i)
        n += 2 * triangles_per_end; // one side is that of the rind
      else
        for (const NodeId end : solid_.grid.ends(cuts[i].edge))
          n += solid_.grid.is_material(end) ? triangles_per_end : 0;
      surface_.labels.resize(n, cuts[i].label);
    }
    surface_.triangles.resize(n);
    surface_.copies.resize(n);
    index_.edge_vertices.resize(2 * cuts.size(), unset);
    index_.centres.resize(solid_.complex.n_copies(), unset);
  }

  void enter(const CellId cell, const unsigned cut_lines) {
    cell_ = cell;
    faces_ = solid_.grid.faces(cell);
    lower_ = solid_.grid.index(solid_.grid.nodes(cell)[0]);
    seen_.reset();
    const auto edges = solid_.grid.edges(cell);
    for (unsigned left = cut_lines; left != 0; left &= left - 1)
      cut_[std::countr_zero(left)] = solid_.cuts.index(edges[std::countr_zero(left)]);
    copy_at_.fill(CopyId());
    for (const CopyId c : solid_.complex.copies_of(cell))
      for (int v = 0; v < cube::n_vertices; ++v)
        if (solid_.complex.copies[c].nodes >> v & 1)
          copy_at_[v] = c;
  }

  void write(const Quad& quad) {
    const CopyId copy = copy_at_[quad.end];
    const auto& vertices = quad.vertices;
    const std::uint32_t edge = edge_vertex(copy, vertices[0]), first = face_vertex(copy, vertices[1]),
                        middle = centre(copy, vertices[2]), second = face_vertex(copy, vertices[3]);
    const auto& [lower, upper] = cube::line_vertices[quad.line];
    put(quad, cut_[quad.line], quad.end == upper && copy_at_[lower].valid(), {edge, first, middle, second}, copy);
  }

  /// Enters the triangles of a quadrilateral among those of a cut.
  void put(const Quad& quad, const std::uint32_t cut, const bool is_second,
           const std::array<std::uint32_t, 4>& vertices, const CopyId copy) {
    const auto& [edge, first, middle, second] = vertices;
    const std::size_t t = index_.first_triangle[cut] + (is_second ? triangles_per_end : 0) +
                          2 * static_cast<std::size_t>(place_around_line[quad.line]);
    surface_.triangles[t] = {edge, first, middle};
    surface_.triangles[t + 1] = {edge, middle, second};
    surface_.copies[t] = surface_.copies[t + 1] = copy;
  }

  enum class Sheet { cuts, skin };

  /// A cell of the skin that a blade has cut. Beside the quadrilaterals of its lines there are walls: where a rim
  /// parts the skin of a face, and the skin keeps its own vertex, they close the gap from that to the vertex of the
  /// cuts.
  void write_sheets(const grid::CellCuts& cell) {
    std::array<grid::Parts, 6> parts;
    for (int face = 0; face < cube::n_faces; ++face)
      parts[face] = grid::parts_of(cell, face);
    const auto fans = grid::fans_of(cell);
    for (const Quad& quad : table_.row(cell.cut)) {
      const bool is_material = cell.material >> quad.end & 1, is_twice = cell.twice >> quad.line & 1;
      const bool of_skin = cell.skin >> quad.line & 1;
      if (is_material && (!of_skin || is_twice))
        write_of_cuts(parts, quad, quad.end, copy_at_[quad.end]);
      if (!is_material && is_twice)
        write_of_cuts(parts, quad, first_rind + quad.line, solid_.complex.copy_with_rind(cell_, quad.line));
      if (is_material && of_skin) {
        const int item = is_twice ? first_rind + quad.line : quad.end;
        write_of_skin(cell, parts, quad, fans[quad.line], item,
                      is_twice ? solid_.complex.copy_with_rind(cell_, quad.line) : copy_at_[item]);
      }
    }
  }

  static constexpr int first_rind = cube::n_vertices; ///< items are vertices, then rinds of lines

  /// A quadrilateral of a blade's cut; `item` is what it bounds.
  void write_of_cuts(const std::array<grid::Parts, 6>& parts, const Quad& quad, const int item, const CopyId copy) {
    const std::uint32_t cut = solid_.cuts.index(solid_.grid.edges(cell_)[quad.line]);
    const bool is_upper = quad.end == cube::line_vertices[quad.line][1];
    const std::uint32_t edge = edge_vertex_of(cut, quad, copy), middle = centre(copy);
    const int f = quad.vertices[1].index, g = quad.vertices[3].index;
    put(quad, cut, is_upper,
        {edge, vertex_in_face(f, Sheet::cuts, parts[f], item, copy, quad.line), middle,
         vertex_in_face(g, Sheet::cuts, parts[g], item, copy, quad.line)},
        copy);
  }

  /// A quadrilateral of the skin, and its walls.
  void write_of_skin(const grid::CellCuts& cell, const std::array<grid::Parts, 6>& parts, const Quad& quad,
                     const int fan, const int item, const CopyId copy) {
    const std::uint32_t cut = solid_.cuts.outer_index(solid_.grid.edges(cell_)[quad.line]);
    const std::uint32_t edge = edge_vertex_of(cut, quad, copy), middle = skin_centre(fan, copy);
    std::array<std::uint32_t, 2> in_face;
    for (const int i : {0, 1}) {
      const int face = quad.vertices[1 + 2 * i].index;
      const Sheet sheet = cell.has_two_points(face) ? Sheet::skin : Sheet::cuts;
      in_face[i] = vertex_in_face(face, sheet, parts[face], item, copy, quad.line);
      if (is_rim(cell, face, quad.line)) {
        const std::uint32_t rim = vertex_in_face(face, Sheet::cuts, parts[face], item, copy, quad.line);
        put_wall(face, quad.line, i == 1, {in_face[i], rim, centre(copy), middle}, copy,
                 label_beside(cell, face, quad.line));
      }
    }
    put(quad, cut, false, {edge, in_face[0], middle, in_face[1]}, copy);
  }

  static bool is_rim(const grid::CellCuts& cell, const int face, const int line) {
    return std::ranges::any_of(grid::skin_arcs(face, cell.material), [&](const grid::SkinArc& arc) {
      return (arc.lines[0] == line || arc.lines[1] == line) && cell.is_rim(face, arc);
    });
  }

  /// A wall: vertex of the skin and of the rim in a face, rim and skin in the cell. It lies on the skin
  /// where the cuts' vertices lie on a rim, else it belongs to the cut.
  void put_wall(const int face, const int line, const bool turned, const std::array<std::uint32_t, 4>& vertices,
                const CopyId copy, const grid::CutLabel label) {
    const auto& [skin, rim, rim_middle, middle] = vertices;
    const std::uint64_t place = std::uint64_t(cell_.value) * cube::n_faces + static_cast<unsigned>(face);
    const std::uint64_t key = place * cube::n_lines + static_cast<unsigned>(line);
    const std::size_t n = surface_.triangles.size();
    const auto [wall, is_new] = index_.first_of_wall.try_emplace(key, static_cast<std::uint32_t>(n));
    if (is_new) {
      surface_.triangles.resize(n + 2);
      surface_.labels.resize(n + 2);
      surface_.copies.resize(n + 2);
    }
    const std::uint32_t t = wall->second;
    surface_.triangles[t] = turned ? Triangle{skin, middle, rim} : Triangle{skin, rim, middle};
    surface_.triangles[t + 1] = turned ? Triangle{rim, middle, rim_middle} : Triangle{rim, rim_middle, middle};
    surface_.copies[t] = surface_.copies[t + 1] = copy;
    const bool on_skin = solid_.cuts.skin_point(faces_[face])->has_rim;
    surface_.labels[t] = on_skin ? grid::skin_label : label;
    surface_.labels[t + 1] = on_skin && solid_.cuts.skin_point(cell_)->has_rim ? grid::skin_label : label;
  }

  /// Of the blade that has cut beside the skin's line in a face.
  grid::CutLabel label_beside(const grid::CellCuts& cell, const int face, const int line) const {
    for (const grid::SkinArc& arc : grid::skin_arcs(face, cell.material))
      if (arc.lines[0] == line || arc.lines[1] == line) {
        const int cut = std::countr_zero(cell.blades() & grid::CellCuts::beside(arc));
        return solid_.cuts.find(solid_.grid.edges(cell_)[cut])->label;
      }
    return grid::skin_label;
  }

  std::uint32_t edge_vertex_of(const std::uint32_t cut, const Quad& quad, const CopyId copy) {
    std::uint32_t& id = index_.edge_vertices[2 * cut + (quad.end == cube::line_vertices[quad.line][1])];
    if (id == unset || known_ == Known::renewed)
      set_edge_vertex(id, quad.line, cut, copy);
    return id;
  }

  std::uint32_t vertex_in_face(const int face, const Sheet sheet, const grid::Parts& parts, const int item,
                               const CopyId copy, const int line) {
    const auto* const part = std::ranges::find_if(parts, [&](const grid::Part& p) {
      return item < first_rind ? (p.nodes >> item & 1) != 0 : (p.rinds >> (item - first_rind) & 1) != 0;
    });
    const bool has_node = part->nodes != 0;
    const int place = has_node ? place_in_face(face, std::countr_zero(part->nodes))
                               : cube::place_in_face(face, std::countr_zero(part->rinds));
    const std::uint32_t i = has_node && sheet == Sheet::cuts
                              ? block(index_.first_face_vertex.at(faces_[face]), 4) + place
                              : block(index_.first_sheet_vertex.at(faces_[face]), 12) + place +
                                  (sheet == Sheet::cuts ? 0
                                   : has_node           ? 4
                                                        : 8);
    std::uint32_t& id = index_.face_vertices[i];
    if (id == unset || known_ == Known::renewed) {
      const Vec3 p = sheet == Sheet::skin ? grid::face_skin_point(solid_, faces_[face], cube::place_in_face(face, line))
                                          : grid::face_point(solid_, faces_[face]);
      set(id, p, (p - node_position(cube::face_vertices[face][0])) / solid_.grid.h(), copy, cube::face_mask(face));
    }
    return id;
  }

  std::uint32_t skin_centre(const int line, const CopyId copy) {
    const std::uint64_t key = std::uint64_t(cell_.value) * cube::n_lines + static_cast<unsigned>(line);
    std::uint32_t& id = index_.skin_centres.try_emplace(key, unset).first->second;
    if (id == unset || known_ == Known::renewed)
      set_centre(id, grid::cell_skin_point(solid_, cell_, line), copy);
    return id;
  }

  std::uint32_t centre(const CopyId copy) {
    std::uint32_t& id = index_.centres[copy];
    if (id == unset || known_ == Known::renewed)
      set_centre(id, grid::cell_point(solid_, cell_), copy);
    return id;
  }

  void set_centre(std::uint32_t& id, const Vec3& p, const CopyId copy) {
    set(id, p, (p - node_position(0)) / solid_.grid.h(), copy, 0xff);
  }

  /// The first of n places for the vertices of a face; made where there are none yet.
  std::uint32_t block(std::uint32_t& first, const std::size_t n) {
    if (first == unset) {
      first = static_cast<std::uint32_t>(index_.face_vertices.size());
      index_.face_vertices.resize(index_.face_vertices.size() + n, unset);
    }
    return first;
  }

  /// Of a vertex of the cell.
  Vec3 node_position(const int vertex) const {
    return solid_.grid.lattice().position(
      {lower_[0] + (vertex & 1), lower_[1] + (vertex >> 1 & 1), lower_[2] + (vertex >> 2 & 1)});
  }

  std::uint32_t edge_vertex(const CopyId copy, const TableVertex& v) {
    const auto& [lower, upper] = cube::line_vertices[v.index];
    const bool is_upper = v.side == upper;
    std::uint32_t& id = index_.edge_vertices[2 * cut_[v.index] + is_upper];
    if (is_wanted(id, 2 * v.index + is_upper))
      set_edge_vertex(id, v.index, cut_[v.index], copy);
    return id;
  }

  void set_edge_vertex(std::uint32_t& id, const int line, const std::uint32_t cut, const CopyId copy) {
    const auto& [lower, upper] = cube::line_vertices[line];
    const int axis = cube::line_axis(line);
    const double t = solid_.cuts.all()[cut].t;
    Vec3 p = node_position(lower), xi = Vec3::Zero();
    p[axis] += solid_.grid.h() * t;
    xi[axis] = t;
    set(id, p, xi, copy, (1u << lower) | (1u << upper));
  }

  std::uint32_t face_vertex(const CopyId copy, const TableVertex& v) {
    const int place = 24 + 8 * v.index + v.side;
    if (seen_[place])
      return in_cell_[place];
    const std::uint32_t first = block(index_.first_face_vertex.at(faces_[v.index]), 4);
    std::uint32_t& id = index_.face_vertices[first + place_in_face(v.index, v.side)];
    if (is_wanted(id, place)) {
      const Vec3 p = grid::face_point(solid_, faces_[v.index]);
      set(id, p, (p - node_position(cube::face_vertices[v.index][0])) / solid_.grid.h(), copy,
          cube::face_mask(v.index));
    }
    return in_cell_[place] = id;
  }

  std::uint32_t centre(const CopyId copy, const TableVertex& v) {
    std::uint32_t& id = index_.centres[copy];
    if (is_wanted(id, 72 + v.side)) {
      const Vec3 p = grid::cell_point(solid_, cell_);
      set(id, p, (p - node_position(0)) / solid_.grid.h(), copy, 0xff);
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
    Interpolation& w = surface_.weights;
    if (id == unset) {
      id = static_cast<std::uint32_t>(surface_.rest.size());
      surface_.rest.push_back(p);
      w.start.push_back(w.start.back() + static_cast<std::uint32_t>(std::bitset<8>(support).count()));
      w.corners.resize(w.start.back());
      w.values.resize(w.start.back());
    } else
      surface_.rest[id] = p;
    const auto factors = shape_factors(xi, support);
    const auto& corners = solid_.complex.copies[copy].corners;
    std::uint32_t entry = w.start[id];
    for (unsigned left = support; left != 0; left &= left - 1, ++entry) {
      const int v = std::countr_zero(left);
      w.corners[entry] = corners[v].value;
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

  const Solid& solid_;
  const SplittingTable& table_ = splitting_table();
  Surface& surface_;
  SurfaceIndex& index_;
  Known known_;

  CellId cell_;
  std::array<FaceId, 6> faces_;
  Index3 lower_{};
  std::array<std::uint32_t, 12> cut_; // by line: place in Cuts::all()
  std::array<CopyId, 8> copy_at_;
  std::bitset<80> seen_;                  // 24 edge vertices, 48 face vertices, 8 centres
  std::array<std::uint32_t, 80> in_cell_; // ids of seen ones, face vertices only
};

} // namespace kerf::surface
