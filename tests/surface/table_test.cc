/// The 4096 rows against a derivation of their own, from where things lie in the cell: the surface inside a cell is
/// made of the squares between octants of neighbouring nodes.
///
/// A vertex is named by its place in {0, 1, 2}^3 (nodes at even places) and by the set of nodes that it follows: the
/// end of its edge, or the component in its face or in the cell.

#include "surface/table.h"

#include "grid/cube.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <numeric>
#include <set>

namespace kerf::surface::table_test {
namespace {

namespace cube = grid::cube;
using Place = std::array<int, 3>;

struct Name {
  Place place;
  unsigned nodes; ///< bits of the nodes it follows
  auto operator<=>(const Name&) const = default;
};
/// Starts at the edge vertex, counter-clockwise seen from outside.
using Square = std::array<Name, 4>;
using Row = std::vector<Square>; ///< sorted
using DirectedEdge = std::pair<Name, Name>;

Place place_of_node(const int v) { return {2 * (v & 1), 2 * (v >> 1 & 1), 2 * (v >> 2 & 1)}; }

/// Which line has its middle at a place.
int line_with_middle(const Place& place) {
  for (int line = 0; line < 12; ++line) {
    const Place a = place_of_node(cube::line_vertices[line][0]), b = place_of_node(cube::line_vertices[line][1]);
    if (a[0] + b[0] == 2 * place[0] && a[1] + b[1] == 2 * place[1] && a[2] + b[2] == 2 * place[2])
      return line;
  }
  return -1;
}

/// Nodes whose places agree with `place` wherever it is even: the nodes of its edge, face or cell.
unsigned nodes_around(const Place& place) {
  unsigned bits = 0;
  for (int v = 0; v < 8; ++v) {
    const Place node = place_of_node(v);
    bool around = true;
    for (int axis = 0; axis < 3; ++axis)
      around &= place[axis] == 1 || place[axis] == node[axis];
    bits |= unsigned(around) << v;
  }
  return bits;
}

/// The nodes of `allowed` that uncut lines connect to v.
unsigned component(const unsigned cut_lines, const unsigned allowed, const int v) {
  std::array<int, 8> label;
  std::iota(label.begin(), label.end(), 0);
  for (int round = 0; round < 8; ++round)
    for (int line = 0; line < 12; ++line) {
      const auto& [a, b] = cube::line_vertices[line];
      if (!(cut_lines >> line & 1) && (allowed >> a & 1) && (allowed >> b & 1))
        label[a] = label[b] = std::min(label[a], label[b]);
    }
  unsigned bits = 0;
  for (int w = 0; w < 8; ++w)
    bits |= unsigned(label[w] == label[v]) << w;
  return bits;
}

/// The vertex at `place` as the node s sees it.
Name name(const unsigned cut_lines, const Place& place, const int s) {
  const unsigned around = nodes_around(place);
  return {place, std::popcount(around) == 2 ? 1u << s : component(cut_lines, around, s)};
}

Place cross(const Place& a, const Place& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Place minus(const Place& a, const Place& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
int dot(const Place& a, const Place& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Square expected_square(const unsigned cut_lines, const int line, const int s, const int other) {
  const Place from = place_of_node(s), to = place_of_node(other);
  Place edge;
  std::vector<Place> faces;
  for (int axis = 0; axis < 3; ++axis)
    edge[axis] = (from[axis] + to[axis]) / 2;
  for (int axis = 0; axis < 3; ++axis)
    if (axis != cube::line_axis(line)) {
      faces.push_back(edge);
      faces.back()[axis] = 1;
    }
  const Place centre = {1, 1, 1};
  if (dot(cross(minus(faces[0], edge), minus(centre, edge)), minus(to, from)) < 0)
    std::swap(faces[0], faces[1]);
  return {name(cut_lines, edge, s), name(cut_lines, faces[0], s), name(cut_lines, centre, s),
          name(cut_lines, faces[1], s)};
}

Row expected_row(const unsigned cut_lines) {
  Row row;
  for (int line = 0; line < 12; ++line)
    if (cut_lines >> line & 1) {
      const auto& [a, b] = cube::line_vertices[line];
      row.push_back(expected_square(cut_lines, line, a, b));
      row.push_back(expected_square(cut_lines, line, b, a));
    }
  std::sort(row.begin(), row.end());
  return row;
}

Name read(const unsigned cut_lines, const TableVertex& v) {
  Place place = {1, 1, 1};
  if (v.kind == VertexKind::edge) {
    const Place a = place_of_node(cube::line_vertices[v.index][0]), b = place_of_node(cube::line_vertices[v.index][1]);
    place = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
  } else if (v.kind == VertexKind::face)
    place[v.index / 2] = 2 * (v.index & 1);
  const Name found = name(cut_lines, place, v.side);
  EXPECT_EQ(v.side, std::countr_zero(found.nodes)) << "a component is named by its smallest vertex";
  return found;
}

/// A row as the table has it.
Row read_row(const unsigned cut_lines) {
  Row row;
  for (const Quad& quad : splitting_table().row(cut_lines)) {
    Square square;
    for (int i = 0; i < 4; ++i)
      square[i] = read(cut_lines, quad.vertices[i]);
    EXPECT_EQ(line_with_middle(square[0].place), quad.line);
    EXPECT_EQ(square[0].nodes, 1u << quad.end);
    row.push_back(square);
  }
  std::sort(row.begin(), row.end());
  return row;
}

std::vector<DirectedEdge> directed_edges(const Row& row) {
  std::vector<DirectedEdge> edges;
  for (const Square& square : row)
    for (int i = 0; i < 4; ++i)
      edges.emplace_back(square[i], square[(i + 1) % 4]);
  return edges;
}

const std::vector<Row>& rows() {
  static const std::vector<Row> all = [] {
    std::vector<Row> read;
    for (unsigned cut_lines = 0; cut_lines < 4096; ++cut_lines)
      read.push_back(read_row(cut_lines));
    return read;
  }();
  return all;
}

TEST(Table, IsWhatFirstPrinciplesGive) {
  ASSERT_EQ(splitting_table().row_start().size(), 4097u);
  EXPECT_EQ(splitting_table().quads().size(), 4096u * 12) << "half of 12 lines are cut on average, two quads each";
  for (unsigned cut_lines = 0; cut_lines < 4096; ++cut_lines)
    ASSERT_EQ(rows()[cut_lines], expected_row(cut_lines)) << "row " << cut_lines;
}

TEST(Table, KnowsTheComponents) {
  std::array<int, 8> n_rows_with{};
  for (unsigned cut_lines = 0; cut_lines < 4096; ++cut_lines) {
    std::set<unsigned> components;
    for (int v = 0; v < 8; ++v) {
      const unsigned nodes = component(cut_lines, 0xff, v);
      components.insert(nodes);
      EXPECT_EQ(splitting_table().cell_component(cut_lines, v), std::countr_zero(nodes));
      for (int axis = 0; axis < 3; ++axis) {
        const int face = cube::face_at(v, axis);
        EXPECT_EQ(face_component(cut_lines, face, v), std::countr_zero(component(cut_lines, cube::face_mask(face), v)));
      }
    }
    ++n_rows_with[components.size() - 1];
  }
  EXPECT_EQ(n_rows_with, (std::array<int, 8>{1083, 1231, 940, 537, 226, 66, 12, 1}));
}

TEST(Table, IsClosedInsideTheCell) {
  const auto at_centre = [](const Name& n) { return n.place == Place{1, 1, 1}; };
  for (unsigned cut_lines = 0; cut_lines < 4096; ++cut_lines) {
    std::map<DirectedEdge, int> met;
    for (const DirectedEdge& e : directed_edges(rows()[cut_lines]))
      if (at_centre(e.first) || at_centre(e.second))
        ++met[e];
    for (const auto& [e, n] : met) {
      ASSERT_EQ(n, 1) << "row " << cut_lines;
      ASSERT_TRUE(met.contains({e.second, e.first})) << "row " << cut_lines;
    }
  }
}

/// What a row leaves on a face, seen in the plane of the face: places and nodes without the normal direction.
std::vector<DirectedEdge> left_on_face(const Row& row, const int face) {
  const int axis = face / 2, level = 2 * (face & 1);
  const auto flat = [&](Name n) {
    n.place[axis] = 0;
    unsigned nodes = 0;
    for (int v = 0; v < 8; ++v)
      nodes |= (n.nodes >> v & 1) << (v & ~(1 << axis));
    return Name{n.place, nodes};
  };
  std::vector<DirectedEdge> edges;
  for (const auto& [a, b] : directed_edges(row))
    if (a.place[axis] == level && b.place[axis] == level)
      edges.emplace_back(flat(a), flat(b));
  std::sort(edges.begin(), edges.end());
  return edges;
}

/// The cut lines of a face by their middles in its plane: the same for both cells of the face.
std::set<Place> cuts_of_face(const unsigned cut_lines, const int face) {
  std::set<Place> cuts;
  for (const int line : cube::face_lines[face])
    if (cut_lines >> line & 1) {
      const Place a = place_of_node(cube::line_vertices[line][0]), b = place_of_node(cube::line_vertices[line][1]);
      Place middle = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
      middle[face / 2] = 0;
      cuts.insert(middle);
    }
  return cuts;
}

TEST(Table, ClosesAcrossEveryFaceWhateverTheRestOfBothCells) {
  for (int axis = 0; axis < 3; ++axis) {
    std::map<std::set<Place>, std::vector<DirectedEdge>> below, above; // by the face's own cuts
    for (unsigned cut_lines = 0; cut_lines < 4096; ++cut_lines)
      for (const int upper : {1, 0}) {
        const int face = 2 * axis + upper;
        const auto left = left_on_face(rows()[cut_lines], face);
        auto& known = upper ? below : above;
        const auto& first = known.emplace(cuts_of_face(cut_lines, face), left).first->second;
        ASSERT_EQ(left, first) << "row " << cut_lines << ": a face depends on more than its own lines";
      }
    ASSERT_EQ(below.size(), 16u);
    for (auto [cuts, edges] : below) {
      ASSERT_EQ(edges.size(), 2 * cuts.size()) << "one a line and end";
      ASSERT_EQ(std::adjacent_find(edges.begin(), edges.end()), edges.end()) << "an edge twice";
      for (DirectedEdge& e : edges)
        std::swap(e.first, e.second);
      std::sort(edges.begin(), edges.end());
      EXPECT_EQ(edges, above.at(cuts));
    }
  }
}

/// A signed permutation of the axes.
struct Symmetry {
  std::array<int, 3> axis;
  std::array<bool, 3> flipped;

  Place operator()(const Place& p) const {
    Place q;
    for (int i = 0; i < 3; ++i)
      q[i] = flipped[i] ? 2 - p[axis[i]] : p[axis[i]];
    return q;
  }
  int node(const int v) const {
    const Place q = (*this)(place_of_node(v));
    return q[0] / 2 + q[1] + 2 * q[2];
  }
  bool mirrors() const {
    int n = flipped[0] + flipped[1] + flipped[2];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < i; ++j)
        n += axis[j] > axis[i];
    return (n & 1) != 0;
  }
};

std::vector<Symmetry> symmetries() {
  std::vector<Symmetry> all;
  std::array<int, 3> axis = {0, 1, 2};
  do
    for (int flips = 0; flips < 8; ++flips)
      all.push_back({axis, {(flips & 1) != 0, (flips & 2) != 0, (flips & 4) != 0}});
  while (std::next_permutation(axis.begin(), axis.end()));
  return all;
}

/// A symmetry as tables: of node bits, of lines, of places.
class Action {
 public:
  explicit Action(const Symmetry& g) : g_(g) {
    for (unsigned bits = 0; bits < 256; ++bits)
      for (int v = 0; v < 8; ++v)
        nodes_[bits] |= (bits >> v & 1) << g.node(v);
    for (int line = 0; line < 12; ++line) {
      const Place a = place_of_node(cube::line_vertices[line][0]), b = place_of_node(cube::line_vertices[line][1]);
      line_[line] = line_with_middle(g({(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2}));
    }
  }

  unsigned configuration(const unsigned cut_lines) const {
    unsigned image = 0;
    for (int line = 0; line < 12; ++line)
      image |= (cut_lines >> line & 1) << line_[line];
    return image;
  }

  Row row(const Row& row) const {
    Row image;
    for (const Square& s : row) {
      Square t;
      for (int i = 0; i < 4; ++i)
        t[i] = {g_(s[i].place), nodes_[s[i].nodes]};
      if (g_.mirrors())
        std::swap(t[1], t[3]);
      image.push_back(t);
    }
    std::sort(image.begin(), image.end());
    return image;
  }

  bool mirrors() const { return g_.mirrors(); }

 private:
  Symmetry g_;
  std::array<unsigned, 256> nodes_{};
  std::array<int, 12> line_{};
};

TEST(Table, FollowsTheSymmetriesOfTheCube) {
  const auto all = symmetries();
  ASSERT_EQ(all.size(), 48u);
  for (const Symmetry& g : all) {
    const Action action(g);
    for (unsigned cut_lines = 0; cut_lines < 4096; ++cut_lines)
      ASSERT_EQ(action.row(rows()[cut_lines]), rows()[action.configuration(cut_lines)]) << "row " << cut_lines;
  }
}

TEST(Table, Has144ClassesAnd218UnderRotationsAlone) {
  std::vector<unsigned> lowest(4096), lowest_by_rotation(4096);
  std::iota(lowest.begin(), lowest.end(), 0u);
  lowest_by_rotation = lowest;
  for (const Symmetry& g : symmetries()) {
    const Action action(g);
    for (unsigned cut_lines = 0; cut_lines < 4096; ++cut_lines) {
      const unsigned image = action.configuration(cut_lines);
      lowest[cut_lines] = std::min(lowest[cut_lines], image);
      if (!action.mirrors())
        lowest_by_rotation[cut_lines] = std::min(lowest_by_rotation[cut_lines], image);
    }
  }
  EXPECT_EQ(std::set<unsigned>(lowest.begin(), lowest.end()).size(), 144u);
  EXPECT_EQ(std::set<unsigned>(lowest_by_rotation.begin(), lowest_by_rotation.end()).size(), 218u);
}

} // namespace
} // namespace kerf::surface::table_test
