#include "grid/grid.h"

#include "base/error.h"
#include "grid/cube.h"

#include <algorithm>
#include <iterator>

namespace kerf::grid {

namespace {

using Key = std::uint64_t;
using Keys = std::vector<Key>;

constexpr int bits = 20;
constexpr int max_coordinate = (1 << bits) - 1;
constexpr std::array<Key, 3> shift = {Key(1), Key(1) << bits, Key(1) << (2 * bits)};

Key pack(const Index3& i) { return shift[0] * i[0] + shift[1] * i[1] + shift[2] * i[2]; }

Index3 unpack(const Key key) {
  return {static_cast<int>(key & max_coordinate), static_cast<int>(key >> bits & max_coordinate),
          static_cast<int>(key >> (2 * bits))};
}

bool in_range(const Index3& i) {
  return std::all_of(i.begin(), i.end(), [](const int c) { return c >= 0 && c < max_coordinate; });
}

/// The keys and the same keys moved by `step`, sorted, each once.
Keys with_shifted(const Keys& keys, const std::int64_t step) {
  Keys moved(keys.size()), merged;
  std::transform(keys.begin(), keys.end(), moved.begin(), [&](const Key k) { return k + static_cast<Key>(step); });
  merged.reserve(keys.size() + keys.size() / 4);
  std::set_union(keys.begin(), keys.end(), moved.begin(), moved.end(), std::back_inserter(merged));
  return merged;
}

Keys spread(Keys keys, const std::array<bool, 3>& along, const int sign) {
  for (int axis = 0; axis < 3; ++axis)
    if (along[axis])
      keys = with_shifted(keys, sign * static_cast<std::int64_t>(shift[axis]));
  return keys;
}

Keys material_keys(const std::vector<Index3>& nodes) {
  Keys keys;
  keys.reserve(nodes.size());
  for (const Index3& i : nodes) {
    if (!in_range(i) || std::any_of(i.begin(), i.end(), [](const int c) { return c < 1; }))
      throw DataError(
        Complaint{.rule = "a body may have at most " + std::to_string(max_coordinate - 1) + " grid nodes along an axis",
                  .remedy = "Use a larger cube edge"});
    keys.push_back(pack(i));
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

/// Positions in `all` of `keys` moved by `step`; both sorted, every moved key present.
template <class Assign>
void locate(const Keys& keys, const Key step, const Keys& all, const Assign& assign) {
  std::size_t position = 0;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    while (all[position] < keys[i] + step)
      ++position;
    assign(i, position);
  }
}

Key vertex_shift(const int vertex) {
  Key sum = 0;
  for (int axis = 0; axis < 3; ++axis)
    if (vertex >> axis & 1)
      sum += shift[axis];
  return sum;
}

std::optional<std::size_t> position_of(const Keys& keys, const Index3& i) {
  if (!in_range(i))
    return std::nullopt;
  const auto found = std::lower_bound(keys.begin(), keys.end(), pack(i));
  if (found == keys.end() || *found != pack(i))
    return std::nullopt;
  return found - keys.begin();
}

template <class Key, class T>
std::size_t bytes(const Table<Key, T>& table) {
  return table.items().capacity() * sizeof(T);
}

} // namespace

Grid::Grid(const Lattice& lattice, std::vector<Index3> material_nodes) : lattice_(lattice) {
  const Keys material = material_keys(material_nodes);
  if (material.empty())
    throw DataError(Complaint{.rule = "the body holds no grid node", .remedy = "Use a smaller cube edge"});
  const Keys cells = spread(material, {true, true, true}, -1);
  node_keys_ = spread(cells, {true, true, true}, 1);
  node_keys_.shrink_to_fit();
  material_.resize(node_keys_.size(), 0);
  locate(material, 0, node_keys_, [&](std::size_t, const std::size_t n) { material_[NodeId(n)] = 1; });
  make_cells(cells);
  make_edges(cells);
  make_faces(cells);
}

void Grid::make_cells(const Keys& cells) {
  cell_nodes_.resize(cells.size());
  for (int v = 0; v < 8; ++v)
    locate(cells, vertex_shift(v), node_keys_,
           [&](const std::size_t c, const std::size_t n) { cell_nodes_[CellId(c)][v] = NodeId(n); });
  lowest_of_cell_ = RankedSet(n_nodes());
  for (const auto& nodes : cell_nodes_)
    lowest_of_cell_.push_back(nodes[0].value);
}

void Grid::make_edges(const Keys& cells) {
  std::array<Keys, 3> keys;
  std::size_t n_edges = 0;
  for (int axis = 0; axis < 3; ++axis) {
    keys[axis] = spread(cells, {axis != 0, axis != 1, axis != 2}, 1);
    first_edge_[axis] = static_cast<std::uint32_t>(n_edges);
    n_edges += keys[axis].size();
  }
  edge_ends_.resize(n_edges);
  cell_edges_.resize(cells.size());
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t first = first_edge_[axis];
    lower_of_edge_[axis] = RankedSet(n_nodes());
    locate(keys[axis], 0, node_keys_, [&](const std::size_t e, const std::size_t n) {
      edge_ends_[EdgeId(first + e)][0] = NodeId(n);
      lower_of_edge_[axis].push_back(n);
    });
    locate(keys[axis], shift[axis], node_keys_,
           [&](const std::size_t e, const std::size_t n) { edge_ends_[EdgeId(first + e)][1] = NodeId(n); });
    for (int line = 0; line < 12; ++line)
      if (cube::line_axis(line) == axis)
        locate(cells, vertex_shift(cube::line_vertices[line][0]), keys[axis],
               [&](const std::size_t c, const std::size_t e) { cell_edges_[CellId(c)][line] = EdgeId(first + e); });
  }
}

void Grid::make_faces(const Keys& cells) {
  std::array<Keys, 3> keys;
  for (int axis = 0; axis < 3; ++axis)
    keys[axis] = spread(cells, {axis == 0, axis == 1, axis == 2}, 1);
  face_cells_.resize(keys[0].size() + keys[1].size() + keys[2].size());
  cell_faces_.resize(cells.size());
  std::size_t first = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (int upper = 0; upper < 2; ++upper)
      locate(cells, upper * shift[axis], keys[axis], [&](const std::size_t c, const std::size_t f) {
        cell_faces_[CellId(c)][2 * axis + upper] = FaceId(first + f);
        face_cells_[FaceId(first + f)][1 - upper] = CellId(c);
      });
    first += keys[axis].size();
  }
}

Index3 Grid::index(const NodeId n) const { return unpack(node_keys_[n.value]); }

std::array<CellId, 4> Grid::cells(const EdgeId e) const {
  const int b = (axis(e) + 1) % 3, c = (axis(e) + 2) % 3;
  std::array<CellId, 4> result;
  result[0] = cell(edge_ends_[e][0]);
  if (result[0].valid()) { // across faces; all four cells are there when an end of the edge is material
    result[1] = neighbour(result[0], 2 * b);
    result[2] = neighbour(result[0], 2 * c);
    if (result[1].valid() && result[2].valid()) {
      result[3] = neighbour(result[1], 2 * c);
      return result;
    }
  }
  for (int i = 0; i < 4; ++i) {
    Index3 lower = index(edge_ends_[e][0]);
    lower[b] -= i & 1;
    lower[c] -= i >> 1;
    result[i] = find_cell(lower).value_or(CellId());
  }
  return result;
}

EdgeId Grid::edge(const NodeId lower, const int axis) const {
  const auto place = lower_of_edge_[axis].place(lower.value);
  return place ? EdgeId(first_edge_[axis] + *place) : EdgeId();
}

CellId Grid::cell(const NodeId lowest) const {
  const auto place = lowest_of_cell_.place(lowest.value);
  return place ? CellId(*place) : CellId();
}

std::optional<NodeId> Grid::find_node(const Index3& i) const {
  const auto position = position_of(node_keys_, i);
  return position ? std::optional(NodeId(*position)) : std::nullopt;
}

std::optional<EdgeId> Grid::find_edge(const Index3& lower, const int axis) const {
  const auto node = find_node(lower);
  const EdgeId e = node ? edge(*node, axis) : EdgeId();
  return e.valid() ? std::optional(e) : std::nullopt;
}

std::optional<CellId> Grid::find_cell(const Index3& lower) const {
  const auto node = find_node(lower);
  const CellId c = node ? cell(*node) : CellId();
  return c.valid() ? std::optional(c) : std::nullopt;
}

std::size_t Grid::n_bytes() const {
  std::size_t sum = node_keys_.capacity() * sizeof(node_keys_[0]) + lowest_of_cell_.n_bytes();
  for (const RankedSet& set : lower_of_edge_)
    sum += set.n_bytes();
  return sum + bytes(material_) + bytes(edge_ends_) + bytes(face_cells_) + bytes(cell_nodes_) + bytes(cell_edges_) +
         bytes(cell_faces_);
}

} // namespace kerf::grid
