#pragma once

/// Writes vertices and triangles of a surface, cell by cell; for surface.cc alone.

#include "grid/cube.h"
#include "grid/shape.h"
#include "grid/touched.h"
#include "surface/border.h"
#include "surface/closing.h"
#include "surface/places.h"
#include "surface/surface.h"
#include "surface/table.h"

#include <algorithm>
#include <bit>
#include <bitset>

namespace kerf::surface {

namespace cube = grid::cube;
namespace skeleton = grid::skeleton;
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
enum class Known { kept, renewed }; ///< what a writer does with a vertex that is there already

/// Writes the vertices and triangles of cells. What cells share comes from its edge or face alone: the same bits. A
/// vertex that belongs to several items follows the copy of the lowest: of one alone but in cells with fronts
/// (grid/fronts.h). There, and beside them, it closes at the front (closing.h).
class Writer {
 public:
  Writer(const Solid& solid, Surface& surface, SurfaceIndex& index, const Known known)
    : solid_(solid), surface_(surface), index_(index), known_(known) {
    make_room();
  }

  /// All cells with a cut edge.
  void write_all() {
    for (const grid::TouchedCell& touched : touched_cells(solid_.grid, solid_.cuts)) // its lines: the configuration
      write(touched.cell, touched.lines);
  }

  void write(const CellId cell) { write(cell, solid_.cuts.configuration(solid_.grid, cell)); }

 private:
  void write(const CellId cell, const unsigned cut_lines) {
    if (cut_lines == 0)
      return;
    enter(cell, cut_lines);
    const grid::CellCuts cell_cuts = grid::cuts_of(solid_, cell, cut_lines);
    skeleton_ = cell_cuts.has_skin() ? &cell_cuts.skeleton() : nullptr;
    if (cell_cuts.is_cut_at_skin()) {
      write_parts(cell_cuts.blades);
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
        n += 2 * triangles_per_end; // the other side belongs to the skin
      else
        for (const NodeId end : solid_.grid.ends(cuts[i].edge))
          n += solid_.grid.is_material(end) ? triangles_per_end : 0;
      surface_.labels.resize(n, cuts[i].label);
    }
    surface_.triangles.resize(n);
    surface_.copies.resize(n);
    index_.edge_vertices.resize(2 * cuts.size(), unset);
    const auto of_skin = solid_.cuts.skin_cuts();
    for (std::size_t i = index_.first_triangle_of_segment.size(); i < of_skin.size(); ++i) {
      const std::size_t first = surface_.triangles.size(), n_cells = of_skin[i].segment.face.valid() ? 2 : 1;
      index_.first_triangle_of_segment.push_back(static_cast<std::uint32_t>(first));
      surface_.triangles.resize(first + 4 * n_cells); // two sides of the cut, two sides of each cell
      surface_.copies.resize(first + 4 * n_cells);
      surface_.labels.resize(first + 4 * n_cells, of_skin[i].label);
    }
    index_.segment_vertices.resize(2 * of_skin.size(), unset);
    index_.centres.resize(solid_.complex.n_copies(), unset);
  }

  void enter(const CellId cell, const unsigned cut_lines) {
    cell_ = cell;
    faces_ = solid_.grid.faces(cell);
    lower_ = solid_.grid.index(solid_.grid.nodes(cell)[0]);
    cut_lines_ = cut_lines;
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
    const std::uint32_t edge = edge_vertex(copy, vertices[0]), first = face_vertex(vertices[1]),
                        middle = skeleton_ ? skin_centre(skeleton_->loop[quad.line], copy) : centre(vertices[2]),
                        second = face_vertex(vertices[3]);
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

  /// A cell in which blades have cut at the skin, as a polyhedron (grid/skeleton.h): of each cut segment and each of
  /// its ends, in each of the segment's two sides a triangle (cut, vertex in the side, centre); and the triangles of
  /// the skin, in pieces where their sides are cut.
  void write_parts(const grid::Segments blades) {
    blades_ = blades;
    for (const CopyId c : solid_.complex.copies_of(cell_))
      for (grid::Items left = solid_.complex.copies[c].items(); left != 0; left &= left - 1)
        copy_of_[std::countr_zero(left)] = c;
    for (grid::Segments left = blades; left != 0; left &= left - 1)
      write_cut(std::countr_zero(left));
    for (grid::Sides left = skeleton_->sides >> skeleton::first_triangle; left != 0; left &= left - 1)
      write_skin(std::countr_zero(left));
  }

  void write_cut(const int segment) {
    const auto& [ends, sides] = skeleton_->segment[segment];
    for (const int end : {0, 1}) {
      const CopyId copy = copy_of_[ends[end]];
      const std::uint32_t cut = cut_vertex(segment, end, copy), middle = centre(ends[end], segment);
      for (const int way : {0, 1}) {
        const std::uint32_t in_side = side_vertex(sides[way], ends[end]);
        put(triangle_of_cut(segment, end, way),
            way == end ? Triangle{cut, middle, in_side} : Triangle{cut, in_side, middle}, copy);
      }
    }
  }

  void put(const std::size_t t, const Triangle& triangle, const CopyId copy) {
    surface_.triangles[t] = triangle;
    surface_.copies[t] = copy;
  }

  bool is_at_upper_end(const int line, const int end) const {
    const int node = skeleton_->segment[line].ends[0] < cube::n_vertices ? skeleton_->segment[line].ends[0] : 0;
    return (node == cube::line_vertices[line][1]) == (end == 0);
  }

  std::size_t triangle_of_cut(const int segment, const int end, const int way) const {
    if (segment < skeleton::first_half) {
      const std::size_t first = index_.first_triangle[solid_.cuts.index(solid_.grid.edges(cell_)[segment])];
      return first + (is_at_upper_end(segment, end) ? triangles_per_end : 0) +
             place_at_line(segment, skeleton_->segment[segment].sides[way] / 2);
    }
    const grid::SkinSegment at = grid::skin_segment(solid_.grid, cell_, segment);
    const std::size_t first = index_.first_triangle_of_segment[solid_.cuts.index(at)];
    const bool is_upper_cell = at.face.valid() && solid_.grid.cells(at.face)[1] == cell_;
    return first + 4 * std::size_t(is_upper_cell) + 2 * static_cast<std::size_t>(end) + static_cast<std::size_t>(way);
  }

  /// Of two triangles in each of the four cells around a line, by the faces of the line.
  std::size_t place_at_line(const int line, const int face) const {
    const bool is_first = cube::face_axis(face) == (cube::line_axis(line) + 1) % 3;
    return 2 * static_cast<std::size_t>(place_around_line[line]) + (is_first ? 0 : 1);
  }

  /// What the cuts of its sides leave of a triangle of the skin.
  void write_skin(const int triangle) {
    const int side = skeleton::first_triangle + triangle;
    const auto& [n, items, segments] = skeleton_->side[side];
    const bool is_cut =
      ((std::uint64_t(1) << segments[0] | std::uint64_t(1) << segments[1] | std::uint64_t(1) << segments[2]) &
       blades_) != 0;
    if (!is_cut) {
      const CopyId copy = copy_of_[items[0]];
      put(triangle_of_skin(triangle, 0), {item_vertex(items[0]), item_vertex(items[1]), item_vertex(items[2])}, copy);
      return;
    }
    for (int i = 0; i < n; ++i) {
      const int a = items[i], b = items[(i + 1) % n], segment = segments[i];
      const CopyId of_a = copy_of_[a], of_b = copy_of_[b];
      if ((blades_ >> segment & 1) == 0) {
        put(triangle_of_skin(triangle, i), {item_vertex(a), item_vertex(b), side_vertex(side, a)}, of_a);
        continue;
      }
      const int end = skeleton_->segment[segment].ends[0] == a ? 0 : 1;
      put(triangle_of_skin(triangle, i), {item_vertex(a), cut_vertex(segment, end, of_a), side_vertex(side, a)}, of_a);
      put(triangle_of_skin(triangle, n + i), {cut_vertex(segment, 1 - end, of_b), item_vertex(b), side_vertex(side, b)},
          of_b);
    }
  }

  /// The first piece has the place of the whole.
  std::size_t triangle_of_skin(const int triangle, const int piece) {
    const int face = triangle / 4, line = cube::face_lines[face][triangle % 4];
    if (piece == 0)
      return index_.first_triangle[solid_.cuts.outer_index(solid_.grid.edges(cell_)[line])] + place_at_line(line, face);
    const std::uint64_t key =
      (std::uint64_t(cell_.value) * 24 + static_cast<unsigned>(triangle)) * 6 + static_cast<unsigned>(piece);
    const std::size_t n = surface_.triangles.size();
    const auto [found, is_new] = index_.pieces_of_skin.try_emplace(key, static_cast<std::uint32_t>(n));
    if (is_new) {
      surface_.triangles.resize(n + 1);
      surface_.copies.resize(n + 1);
      surface_.labels.resize(n + 1, grid::skin_label);
    }
    return found->second;
  }

  std::uint32_t cut_vertex(const int segment, const int end, const CopyId copy) {
    if (segment < skeleton::first_half) {
      const std::uint32_t cut = solid_.cuts.index(solid_.grid.edges(cell_)[segment]);
      return edge_vertex_of(cut, segment, is_at_upper_end(segment, end), copy);
    }
    const std::uint32_t cut = solid_.cuts.index(grid::skin_segment(solid_.grid, cell_, segment));
    std::uint32_t& id = index_.segment_vertices[2 * std::size_t(cut) + static_cast<std::size_t>(end)];
    if (id == unset || known_ == Known::renewed) {
      const Vec3 p = grid::segment_point(solid_, cell_, *skeleton_, segment);
      if (segment < skeleton::first_spoke)
        set_in_face(id, (segment - skeleton::first_half) / 4, p, copy);
      else
        set_centre(id, p, copy);
    }
    return id;
  }

  std::uint32_t item_vertex(const int item) {
    const CopyId copy = copy_of_[lowest_beside(item)];
    if (item < skeleton::first_on_arc) {
      const int line = item - skeleton::first_on_line;
      const bool is_upper = skeleton_->vertex[item] == cube::line_vertices[line][1];
      return edge_vertex_of(solid_.cuts.outer_index(solid_.grid.edges(cell_)[line]), line, is_upper, copy);
    }
    if (item >= skeleton::first_middle)
      return skin_centre(item - skeleton::first_middle, copy);
    const int face = (item - skeleton::first_on_arc) / 2;
    const std::uint32_t first = block(index_.first_face_vertex.at(faces_[face]), 4);
    std::uint32_t& id = index_.face_vertices[first + place_in_face(face, lowest_node(item - skeleton::first_on_arc))];
    if (id == unset || known_ == Known::renewed)
      set_in_face(id, face, grid::face_point(solid_, faces_[face]), copy);
    return id;
  }

  /// Of the items that hang together with a point of the skin on its line or in the polygon at its arc.
  int lowest_beside(const int item) const {
    if (item >= skeleton::first_middle)
      return item;
    if (item >= skeleton::first_on_arc)
      return std::countr_zero(skeleton_->reachable_within(item - skeleton::first_on_arc, item, blades_));
    return (blades_ >> (item - skeleton::first_on_line) & 1) ? item : skeleton_->vertex[item];
  }

  /// Of the nodes of a polygon beside an arc.
  int lowest_node(const int polygon) const {
    const auto& [n, items, segments] = skeleton_->side[polygon];
    return *std::min_element(items.begin(), items.begin() + n);
  }

  /// The vertex of the cuts in a side, of the part that holds the item there.
  std::uint32_t side_vertex(const int side, const int item) {
    const grid::Items part = skeleton_->reachable_within(side, item, blades_);
    const CopyId copy = copy_of_[std::countr_zero(part)];
    if (side >= skeleton::first_triangle) {
      const int triangle = side - skeleton::first_triangle;
      const std::uint64_t key =
        (std::uint64_t(cell_.value) * 24 + static_cast<unsigned>(triangle)) * 3 + place_of(side, part);
      std::uint32_t& id = index_.in_skin.try_emplace(key, unset).first->second;
      if (id == unset || known_ == Known::renewed)
        set_centre(id, vertex_in_skin({solid_, cell_, *skeleton_, blades_}, triangle), copy);
      return id;
    }
    const int face = side / 2;
    const bool is_full = (skeleton_->items >> skeleton::on_arc(face, 0) & 1) == 0;
    const std::size_t i = is_full ? block(index_.first_face_vertex.at(faces_[face]), 4) +
                                      static_cast<std::size_t>(place_in_face(face, std::countr_zero(part)))
                                  : block(index_.first_inner_vertex.at(faces_[face]), 10) + place_in_face(face, part);
    std::uint32_t& id = index_.face_vertices[i];
    if (id == unset || known_ == Known::renewed) {
      const CutAtSkin at{solid_, cell_, *skeleton_, blades_};
      set_in_face(id, face, is_full ? vertex_in_face(solid_, cell_, face, at.closes_in(side)) : vertex_in_polygon(at, side),
                  copy);
    }
    return id;
  }

  /// Of the first item of a side that is in a part.
  unsigned place_of(const int side, const grid::Items part) const {
    unsigned i = 0;
    while ((part >> skeleton_->side[side].items[i] & 1) == 0)
      ++i;
    return i;
  }

  std::uint32_t edge_vertex_of(const std::uint32_t cut, const int line, const bool is_upper, const CopyId copy) {
    std::uint32_t& id = index_.edge_vertices[2 * std::size_t(cut) + (is_upper ? 1 : 0)];
    if (id == unset || known_ == Known::renewed)
      set_edge_vertex(id, line, cut, copy);
    return id;
  }

  std::uint32_t skin_centre(const int loop, CopyId copy) {
    if (solid_.cuts.front(cell_) != nullptr)
      copy = solid_.complex.copy_with(cell_, skeleton::middle(loop));
    std::uint32_t& first = index_.first_skin_centre.at(cell_);
    if (first == unset) {
      first = static_cast<std::uint32_t>(index_.skin_centres.size());
      index_.skin_centres.resize(first + skeleton::max_loops, unset);
    }
    std::uint32_t& id = index_.skin_centres[first + static_cast<std::size_t>(loop)];
    if (id == unset || known_ == Known::renewed)
      set_centre(id, grid::cell_point(solid_, cell_), copy);
    return id;
  }

  /// Of the part of a copy with this lowest item: a copy may be of several (Cuts::joined).
  std::uint32_t& centre_of(const CopyId copy, const int lowest) {
    if (std::countr_zero(solid_.complex.copies[copy].items()) == lowest)
      return index_.centres[copy];
    const std::uint64_t key = std::uint64_t(cell_.value) * skeleton::n_items + static_cast<unsigned>(lowest);
    return index_.centres_of_joined.try_emplace(key, unset).first->second;
  }

  /// Of the cuts at the skin, of a segment's border: the first border of a cell has the place of the only one.
  std::uint32_t centre(const int item, const int segment) {
    const int lowest = std::countr_zero(skeleton_->reachable(grid::Items(1) << item, blades_));
    const CopyId copy = copy_of_[lowest];
    const grid::Segments border = border_of(*skeleton_, blades_, segment);
    const int first = std::countr_zero(border);
    std::uint32_t& id = first == std::countr_zero(blades_) ? centre_of(copy, lowest) : centre_of(lowest, first);
    if (id == unset || known_ == Known::renewed)
      set_centre(id, border == blades_ ? vertex_below_skin({solid_, cell_, *skeleton_, blades_})
                                      : vertex_of_border(solid_, cell_, border),
                 copy);
    return id;
  }

  std::uint32_t& centre_of(const int lowest, const int first_segment) {
    const std::uint64_t part = std::uint64_t(cell_.value) * skeleton::n_items + static_cast<unsigned>(lowest),
                        key = part * skeleton::n_segments + static_cast<unsigned>(first_segment);
    return index_.centres_of_borders.try_emplace(key, unset).first->second;
  }

  void set_in_face(std::uint32_t& id, const int face, const Vec3& p, const CopyId copy) {
    set(id, p, (p - node_position(cube::face_vertices[face][0])) / solid_.grid.h(), copy, cube::face_mask(face));
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

  std::uint32_t face_vertex(const TableVertex& v) {
    const int place = 24 + 8 * v.index + v.side;
    if (seen_[place])
      return in_cell_[place];
    const std::uint32_t first = block(index_.first_face_vertex.at(faces_[v.index]), 4);
    std::uint32_t& id = index_.face_vertices[first + place_in_face(v.index, v.side)];
    if (is_wanted(id, place)) {
      const bool closes = std::popcount(cut_lines_ & cube::lines_of_face[v.index]) == 1;
      set_in_face(id, v.index, vertex_in_face(solid_, cell_, v.index, closes), copy_at_[v.side]);
    }
    return in_cell_[place] = id;
  }

  std::uint32_t centre(const TableVertex& v) {
    const CopyId copy = copy_at_[v.side];
    std::uint32_t& id = centre_of(copy, v.side);
    if (is_wanted(id, 72 + v.side)) {
      const bool closes = cube::reachable(0, cut_lines_) == 0xff;
      set_centre(id, vertex_in_cell(solid_, cell_, closes), copy);
    }
    return id;
  }

  /// Is a vertex to be made, or to be renewed for the first time in this cell?
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
      w.columns.resize(w.start.back());
      w.values.resize(w.start.back());
    } else
      surface_.rest[id] = p;
    const auto factors = shape_factors(xi, support);
    const auto& corners = solid_.complex.copies[copy].corners;
    std::uint32_t entry = w.start[id];
    for (unsigned left = support; left != 0; left &= left - 1, ++entry) {
      const int v = std::countr_zero(left);
      w.columns[entry] = corners[v].value;
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
  unsigned cut_lines_ = 0;
  std::array<std::uint32_t, 12> cut_; // by line: place in Cuts::all()
  std::array<CopyId, 8> copy_at_;
  const grid::Skeleton* skeleton_ = nullptr; // where the skin passes through
  grid::Segments blades_ = 0;
  std::array<CopyId, skeleton::n_items> copy_of_; // of its items
  std::bitset<80> seen_;                          // 24 edge vertices, 48 face vertices, 8 centres
  std::array<std::uint32_t, 80> in_cell_;         // ids of seen ones, face vertices only
};

} // namespace kerf::surface
