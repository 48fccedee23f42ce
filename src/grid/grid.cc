#include "grid/grid.h"

#include "base/error.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace kerf::grid {

namespace {

bool in_range(const Index3& i) {
  return std::all_of(i.begin(), i.end(), [](const int c) { return c >= 0 && c <= max_coordinate; });
}

/// A material node has neighbours on both sides.
void require_in_range(const Index3& material_node) {
  if (std::any_of(material_node.begin(), material_node.end(), [](const int c) { return c < 1 || c >= max_coordinate; }))
    throw DataError(
      Complaint{.rule = "a body may have at most " + std::to_string(max_coordinate - 1) + " grid nodes along an axis",
                .remedy = "Use a larger cube edge"});
}

RowSet rows_of(const std::vector<Index3>& nodes) {
  std::vector<Key> keys;
  keys.reserve(nodes.size());
  for (const Index3& i : nodes) {
    require_in_range(i);
    keys.push_back(pack(i));
  }
  std::sort(keys.begin(), keys.end());
  RowSet rows;
  for (const Key key : keys) {
    const int x = unpack(key)[0];
    rows.push_back(key - x, {x, x});
  }
  return rows;
}

RowSet rows_of(const std::vector<NodeRun>& runs) {
  RowSet rows;
  Key before = 0;
  for (const NodeRun& run : runs) {
    require_in_range({run.first, run.y, run.z});
    require_in_range({run.last, run.y, run.z});
    const Key key = pack(run.first, run.y, run.z);
    if (key < before || run.last < run.first)
      throw std::logic_error("Grid: runs of material nodes come in the order of z, y, x");
    before = key;
    rows.push_back(pack(0, run.y, run.z), {run.first, run.last});
  }
  return rows;
}

Index3 unit(const int axis, const int length) {
  Index3 i{};
  i[axis] = length;
  return i;
}

} // namespace

/// All points that are stored: nodes, and the lowest nodes of edges, faces and cells.
struct Grid::Members {
  RowSet cells, nodes;
  std::array<RowSet, 3> edges, faces; ///< by axis
  std::array<std::uint32_t, 3> first_edge{}, first_face{};

  explicit Members(const RowSet& material)
    : cells(dilate(material, {-1, -1, -1}, {0, 0, 0})), nodes(dilate(cells, {0, 0, 0}, {1, 1, 1})) {
    for (int axis = 0; axis < 3; ++axis) {
      Index3 across = {1, 1, 1};
      across[axis] = 0;
      edges[axis] = dilate(cells, {0, 0, 0}, across);
      faces[axis] = dilate(cells, {0, 0, 0}, unit(axis, 1));
    }
    for (int axis = 1; axis < 3; ++axis) {
      first_edge[axis] = first_edge[axis - 1] + edges[axis - 1].n_points();
      first_face[axis] = first_face[axis - 1] + faces[axis - 1].n_points();
    }
  }

  Neighbour node(const Index3& move) const { return {&nodes, move, 0}; }
  Neighbour cell(const Index3& move) const { return {&cells, move, 0}; }
  Neighbour edge(const int axis, const Index3& move) const { return {&edges[axis], move, first_edge[axis]}; }
  Neighbour face(const int axis, const Index3& move) const { return {&faces[axis], move, first_face[axis]}; }
};

Grid::Grid(const Lattice& lattice, const std::vector<Index3>& material_nodes) : Grid(lattice) {
  make(rows_of(material_nodes));
}

Grid Grid::from_runs(const Lattice& lattice, const std::vector<NodeRun>& material) {
  Grid grid(lattice);
  grid.make(rows_of(material));
  return grid;
}

void Grid::make(const RowSet& material) {
  if (material.n_points() == 0)
    throw DataError(Complaint{.rule = "the body holds no grid node", .remedy = "Use a smaller cube edge"});
  const Members members(material);
  first_edge_ = members.first_edge;
  make_nodes(members, material);
  for (int axis = 0; axis < 3; ++axis) {
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    Index3 across = unit(b, -1);
    across[c] = -1;
    edges_.append(members.edges[axis], {members.node({}), members.node(unit(axis, 1)), members.cell({}),
                                        members.cell(unit(b, -1)), members.cell(unit(c, -1)), members.cell(across)});
    faces_.append(members.faces[axis], {members.cell(unit(axis, -1)), members.cell({})});
  }
  edges_.finish();
  faces_.finish();
  make_cells(members);
}

void Grid::make_nodes(const Members& members, const RowSet& material) {
  const RowSet& nodes = members.nodes;
  nodes_.append(nodes, {members.cell({}), members.edge(0, {}), members.edge(1, {}), members.edge(2, {})});
  nodes_.finish();
  run_keys_.reserve(nodes_.n_runs());
  for (std::size_t r = 0; r < nodes.n_rows(); ++r)
    for (std::size_t i = nodes.first_run(r); i < nodes.first_run(r + 1); ++i)
      for (std::size_t k = run_keys_.size(); k < nodes_.n_runs(); k = run_keys_.size()) {
        const std::uint32_t along = nodes_.begin(static_cast<std::uint32_t>(k)) - nodes.number(i);
        if (nodes.run(i).first + static_cast<int>(along) > nodes.run(i).last)
          break;
        run_keys_.push_back(nodes.row(r) + nodes.run(i).first + along);
      }
  material_.resize(n_nodes(), 0);
  RunTable<1> node_of; // of each material node
  node_of.append(material, {members.node({})});
  for (std::uint32_t run = 0; run < node_of.n_runs(); ++run)
    std::fill_n(material_.begin() + node_of.at(node_of.begin(run), 0, run), node_of.end(run) - node_of.begin(run), 1);
}

void Grid::make_cells(const Members& members) {
  std::array<Neighbour, n_kinds> kinds;
  kinds[face_x] = members.face(0, {});
  for (int i = 0; i < 4; ++i) {
    const Index3 move = {0, i & 1, i >> 1};
    kinds[node + i] = members.node(move);
    kinds[edge_x + i] = members.edge(0, move);
  }
  for (int i = 0; i < 2; ++i) {
    kinds[edge_y + i] = members.edge(1, {0, 0, i});
    kinds[edge_z + i] = members.edge(2, {0, i, 0});
    kinds[face_y + i] = members.face(1, {0, i, 0});
    kinds[face_z + i] = members.face(2, {0, 0, i});
  }
  cells_.append(members.cells, kinds);
  cells_.finish();
}

std::optional<NodeId> Grid::find_node(const Index3& i) const {
  if (!in_range(i))
    return std::nullopt;
  const Key key = pack(i);
  const auto after = std::upper_bound(run_keys_.begin(), run_keys_.end(), key);
  if (after == run_keys_.begin())
    return std::nullopt;
  const auto run = static_cast<std::uint32_t>(after - run_keys_.begin() - 1);
  const Key along = key - run_keys_[run]; // in another row it is longer than any run that ends in range
  return along < nodes_.end(run) - nodes_.begin(run) ? std::optional(NodeId(nodes_.begin(run) + along)) : std::nullopt;
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

std::vector<EdgeId> Grid::skin_edges() const {
  std::vector<EdgeId> found;
  found.reserve(edges_.n_runs());
  for (std::uint32_t run = 0; run < edges_.n_runs(); ++run) {
    const std::uint32_t first = edges_.begin(run), n = edges_.end(run) - first;
    const std::uint8_t* const lower = &material_.items()[edges_.at(first, 0, run)];
    const std::uint8_t* const upper = &material_.items()[edges_.at(first, 1, run)];
    constexpr std::uint32_t word = sizeof(std::uint64_t);
    for (std::uint32_t i = 0; i < n;) {
      if (i + word <= n && std::memcmp(lower + i, upper + i, word) == 0) { // mostly
        i += word;
        continue;
      }
      for (const std::uint32_t end = std::min(n, i + word); i < end; ++i)
        if (lower[i] != upper[i])
          found.push_back(EdgeId(first + i));
    }
  }
  return found;
}

std::size_t Grid::n_bytes() const {
  return nodes_.n_bytes() + edges_.n_bytes() + faces_.n_bytes() + cells_.n_bytes() +
         run_keys_.capacity() * sizeof(Key) + material_.items().capacity();
}

} // namespace kerf::grid
