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

} // namespace

Grid::Grid(const Lattice& lattice, std::vector<Index3> material_nodes) : lattice_(lattice) {
  const Keys material = material_keys(material_nodes);
  if (material.empty())
    throw DataError(Complaint{.rule = "the body holds no grid node", .remedy = "Use a smaller cube edge"});
  cell_keys_ = spread(material, {true, true, true}, -1);
  node_keys_ = spread(cell_keys_, {true, true, true}, 1);

  material_.resize(node_keys_.size(), 0);
  locate(material, 0, node_keys_, [&](std::size_t, const std::size_t n) { material_[NodeId(n)] = 1; });

  cell_nodes_.resize(cell_keys_.size());
  for (int v = 0; v < 8; ++v)
    locate(cell_keys_, vertex_shift(v), node_keys_,
           [&](const std::size_t c, const std::size_t n) { cell_nodes_[CellId(c)][v] = NodeId(n); });

  cell_edges_.resize(cell_keys_.size());
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t first = edge_ends_.size();
    const Keys& keys = edge_keys_[axis] = spread(cell_keys_, {axis != 0, axis != 1, axis != 2}, 1);
    edge_ends_.resize(first + keys.size());
    for (int end = 0; end < 2; ++end)
      locate(keys, end * shift[axis], node_keys_,
             [&](const std::size_t e, const std::size_t n) { edge_ends_[EdgeId(first + e)][end] = NodeId(n); });
    for (int line = 0; line < 12; ++line)
      if (cube::line_axis(line) == axis)
        locate(cell_keys_, vertex_shift(cube::line_vertices[line][0]), keys,
               [&](const std::size_t c, const std::size_t e) { cell_edges_[CellId(c)][line] = EdgeId(first + e); });
  }

  cell_faces_.resize(cell_keys_.size());
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t first = face_cells_.size();
    const Keys keys = spread(cell_keys_, {axis == 0, axis == 1, axis == 2}, 1);
    face_cells_.resize(first + keys.size());
    for (int upper = 0; upper < 2; ++upper)
      locate(cell_keys_, upper * shift[axis], keys, [&](const std::size_t c, const std::size_t f) {
        cell_faces_[CellId(c)][2 * axis + upper] = FaceId(first + f);
        face_cells_[FaceId(first + f)][1 - upper] = CellId(c);
      });
  }
}

Index3 Grid::index(const NodeId n) const { return unpack(node_keys_[n.value]); }

int Grid::axis(const EdgeId e) const {
  const std::size_t n_x = edge_keys_[0].size(), n_y = edge_keys_[1].size();
  return e.value < n_x ? 0 : e.value < n_x + n_y ? 1 : 2;
}

std::array<CellId, 4> Grid::cells(const EdgeId e) const {
  const int b = (axis(e) + 1) % 3, c = (axis(e) + 2) % 3;
  std::array<CellId, 4> result;
  for (int i = 0; i < 4; ++i) {
    Index3 lower = index(edge_ends_[e][0]);
    lower[b] -= i & 1;
    lower[c] -= i >> 1;
    if (const auto cell = find_cell(lower))
      result[i] = *cell;
  }
  return result;
}

std::optional<NodeId> Grid::find_node(const Index3& i) const {
  const auto position = position_of(node_keys_, i);
  return position ? std::optional(NodeId(*position)) : std::nullopt;
}

std::optional<EdgeId> Grid::find_edge(const Index3& lower, const int axis) const {
  const auto position = position_of(edge_keys_[axis], lower);
  if (!position)
    return std::nullopt;
  std::size_t first = 0;
  for (int a = 0; a < axis; ++a)
    first += edge_keys_[a].size();
  return EdgeId(first + *position);
}

std::optional<CellId> Grid::find_cell(const Index3& lower) const {
  const auto position = position_of(cell_keys_, lower);
  return position ? std::optional(CellId(*position)) : std::nullopt;
}

} // namespace kerf::grid
