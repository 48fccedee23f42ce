#include "cut/edge_boxes.h"

#include "base/error.h"
#include "base/loan.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>

namespace kerf::cut {

namespace {

constexpr int brick_bits = 2; // a brick has 2^2 nodes along each axis
constexpr unsigned row_nodes = 1 << brick_bits;
constexpr std::size_t n_children = 8;

/// The bits of i, each followed by two zeros.
std::uint64_t spread_bits(std::uint64_t i) {
  i = (i | i << 32) & 0x001f00000000ffff;
  i = (i | i << 16) & 0x001f0000ff0000ff;
  i = (i | i << 8) & 0x100f00f00f00f00f;
  i = (i | i << 4) & 0x10c30c30c30c30c3;
  return (i | i << 2) & 0x1249249249249249;
}

/// The place of a node's brick along the Morton curve.
std::uint64_t brick_of(const Index3& node) {
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis)
    code |= spread_bits(static_cast<std::uint64_t>(node[axis] >> brick_bits)) << axis;
  return code;
}

/// Material nodes in a row in one brick.
struct Run {
  std::uint64_t brick;
  grid::NodeId first;
  std::uint32_t n;
};

/// By brick, then by node.
std::vector<Run> make_runs(const grid::Grid& grid) {
  std::vector<Run> runs;
  runs.reserve(grid.n_nodes() / 4);
  for (const auto node : ids<grid::NodeId>(grid.n_nodes())) {
    if (!grid.is_material(node))
      continue;
    const std::uint64_t brick = brick_of(grid.index(node));
    if (!runs.empty() && runs.back().brick == brick && runs.back().first.value + runs.back().n == node.value)
      ++runs.back().n;
    else
      runs.push_back({brick, node, 1});
  }
  std::sort(runs.begin(), runs.end(),
            [](const Run& a, const Run& b) { return std::pair(a.brick, a.first) < std::pair(b.brick, b.first); });
  return runs;
}

void enlarge(Box& box, const Box& by) {
  box.lower = box.lower.cwiseMin(by.lower);
  box.upper = box.upper.cwiseMax(by.upper);
}

/// The upper end of the node's edge along an axis, when it is material.
grid::NodeId upper_end(const grid::Grid& grid, const grid::NodeId node, const int axis) {
  const grid::EdgeId e = grid.edge(node, axis);
  const grid::NodeId end = e.valid() ? grid.ends(e)[1] : grid::NodeId();
  return end.valid() && grid.is_material(end) ? end : grid::NodeId();
}

grid::NodeId lowest_material_node(const grid::Grid& grid, const grid::CellId cell) {
  const auto& nodes = grid.nodes(cell);
  return *std::find_if(nodes.begin(), nodes.end(), [&](const grid::NodeId n) { return grid.is_material(n); });
}

} // namespace

EdgeBoxes::EdgeBoxes(const grid::Solid& solid) : h_(solid.grid.h()) {
  const Nodes nodes = list_nodes(solid.grid);
  starts_.resize(nodes.start.size());
  list_rows(solid, nodes);
  list_cells(solid.grid, nodes);
  list_skin(solid, nodes);
  levels_.emplace_back(n_blocks());
  while (levels_.back().size() > 1)
    levels_.emplace_back((levels_.back().size() + n_children - 1) / n_children);
}

EdgeBoxes::Nodes EdgeBoxes::list_nodes(const grid::Grid& grid) {
  Nodes nodes{{}, {}, Table<grid::NodeId, std::uint32_t>(grid.n_nodes())};
  const auto runs = make_runs(grid);
  for (auto run = runs.begin(); run != runs.end();) {
    const auto block = static_cast<std::uint32_t>(nodes.start.size());
    nodes.start.push_back(static_cast<std::uint32_t>(nodes.all.size()));
    for (const std::uint64_t brick = run->brick; run != runs.end() && run->brick == brick; ++run)
      for (std::uint32_t i = 0; i < run->n; ++i) {
        nodes.all.emplace_back(run->first.value + i);
        nodes.block[nodes.all.back()] = block;
      }
  }
  nodes.start.push_back(static_cast<std::uint32_t>(nodes.all.size()));
  return nodes;
}

void EdgeBoxes::list_rows(const grid::Solid& solid, const Nodes& nodes) {
  rows_.reserve(nodes.all.size() / 2);
  const auto follows = [](const std::uint32_t corner, const std::uint32_t first, const std::uint32_t n) {
    return first == none ? corner == none : corner == first + n;
  };
  const auto continues = [&](const Row& row, const Row& next) {
    return row.x_end == next.first && follows(next.first, row.first, row.n) &&
           follows(next.upper[0], row.upper[0], row.n) && follows(next.upper[1], row.upper[1], row.n);
  };
  for (std::uint32_t block = 0; block < n_blocks(); ++block) {
    starts_[block].row = static_cast<std::uint32_t>(rows_.size());
    for (std::uint32_t i = nodes.start[block]; i < nodes.start[block + 1]; ++i) {
      Row row{.first = solid.complex.real_corner[nodes.all[i]].value,
              .x_end = none,
              .upper = {none, none},
              .block = block,
              .leaves = {}};
      for (int axis = 0; axis < 3; ++axis)
        if (const grid::NodeId upper = upper_end(solid.grid, nodes.all[i], axis); upper.valid()) {
          (axis == 0 ? row.x_end : row.upper[axis - 1]) = solid.complex.real_corner[upper].value;
          if (axis > 0)
            row.leaves[axis - 1] = nodes.block[upper] != block;
        }
      if (i > nodes.start[block] && continues(rows_.back(), row)) {
        ++rows_.back().n;
        rows_.back().x_end = row.x_end;
      } else
        rows_.push_back(row);
    }
  }
  starts_.back().row = static_cast<std::uint32_t>(rows_.size());
  rows_.shrink_to_fit();
  std::vector<std::uint32_t> slabs(n_blocks()); // by block
  for (std::uint32_t block = 0; block < n_blocks(); ++block)
    slabs[block] = static_cast<std::uint32_t>(solid.grid.index(nodes.all[nodes.start[block]])[2] >> brick_bits);
  sort_rows(slabs);
}

void EdgeBoxes::sort_rows(const std::vector<std::uint32_t>& slabs) {
  std::sort(rows_.begin(), rows_.end(), [&](const Row& a, const Row& b) {
    return std::pair(slabs[a.block], a.first) < std::pair(slabs[b.block], b.first);
  });
  rows_of_blocks_.resize(rows_.size());
  std::vector<std::uint32_t> next(n_blocks());
  std::transform(starts_.begin(), starts_.end() - 1, next.begin(), [](const Start& start) { return start.row; });
  for (std::uint32_t i = 0; i < rows_.size(); ++i) {
    rows_of_blocks_[next[rows_[i].block]++] = i;
    if (i == 0 || slabs[rows_[i].block] != slabs[rows_[i - 1].block])
      slabs_.push_back(i);
  }
  slabs_.push_back(static_cast<std::uint32_t>(rows_.size()));
}

void EdgeBoxes::list_cells(const grid::Grid& grid, const Nodes& nodes) {
  const auto block_of = [&](const grid::CellId c) { return nodes.block[lowest_material_node(grid, c)]; };
  for (const auto c : ids<grid::CellId>(grid.n_cells()))
    ++starts_[block_of(c) + 1].cell;
  for (std::size_t k = 1; k < starts_.size(); ++k)
    starts_[k].cell += starts_[k - 1].cell;
  cells_.resize(grid.n_cells());
  std::vector<std::uint32_t> next(n_blocks());
  std::transform(starts_.begin(), starts_.end() - 1, next.begin(), [](const Start& start) { return start.cell; });
  for (const auto c : ids<grid::CellId>(grid.n_cells()))
    cells_[next[block_of(c)]++] = c;
  for (std::uint32_t k = 0; k < n_blocks(); ++k) {
    starts_[k].skin_cell = static_cast<std::uint32_t>(skin_cells_.size());
    for_each_cell(k, [&](const grid::CellId c) {
      if (grid::material_of(grid, c) != 0xff)
        skin_cells_.push_back(c);
    });
  }
  starts_.back().skin_cell = static_cast<std::uint32_t>(skin_cells_.size());
}

void EdgeBoxes::list_skin(const grid::Solid& solid, const Nodes& nodes) {
  const auto material_end = [&](const grid::EdgeId e) {
    const auto& [lower, upper] = solid.grid.ends(e);
    return solid.grid.is_material(lower) ? lower : upper;
  };
  const auto edges = solid.grid.skin_edges();
  for (const grid::EdgeId e : edges)
    ++starts_[nodes.block[material_end(e)] + 1].skin;
  for (std::size_t k = 1; k < starts_.size(); ++k)
    starts_[k].skin += starts_[k - 1].skin;
  skin_.resize(edges.size());
  std::vector<std::uint32_t> next(n_blocks());
  std::transform(starts_.begin(), starts_.end() - 1, next.begin(), [](const Start& start) { return start.skin; });
  for (const grid::EdgeId e : edges)
    skin_[next[nodes.block[material_end(e)]]++] = {e, solid.complex.real_corner[material_end(e)]};
}

void EdgeBoxes::fit(const Points& x_before, const Points& x) {
  require_finite(x);
  moves_ = x_before != x;
  if (moves_) {
    take_in(x_before);
    now_.swap(before_);
  }
  take_in(x);
  join();
}

void EdgeBoxes::move_on(const Points& x_before, const Points& x) {
  const bool moved = moves_;
  moves_ = x_before != x;
  if (moves_) {
    require_finite(x);
    now_.swap(before_);
    take_in(x);
  }
  if (moves_ || moved)
    join();
}

/// Fits now_.
void EdgeBoxes::take_in(const Points& x) {
  constexpr std::size_t worth = 64; // blocks
  constexpr double inf = std::numeric_limits<double>::infinity();
  now_.assign(n_blocks(), Block{{Vec3::Constant(inf), Vec3::Constant(-inf)}, 0});
  parallel_for(
    slabs_.size() - 1,
    [&](const std::size_t slab) {
      for (std::uint32_t i = slabs_[slab]; i < slabs_[slab + 1]; ++i)
        if (const Row& row = rows_[i]; row.n == row_nodes)
          take_in(row, std::integral_constant<unsigned, row_nodes>(), x);
        else
          take_in(row, unsigned(row.n), x);
    },
    n_blocks() < worth ? slabs_.size() : 2);
  for (Block& block : now_)
    block.longest = std::sqrt(block.longest);
}

/// All levels, of now_ and, where corners move, of before_.
void EdgeBoxes::join() {
  levels_[0] = now_;
  if (moves_)
    for (std::size_t i = 0; i < n_blocks(); ++i)
      enlarge(levels_[0][i].box, before_[i].box);
  for (std::size_t level = 1; level < levels_.size(); ++level)
    for (std::size_t i = 0; i < levels_[level].size(); ++i) {
      const auto& below = levels_[level - 1];
      Block block = below[n_children * i];
      for (std::size_t k = n_children * i + 1; k < std::min(below.size(), n_children * (i + 1)); ++k) {
        enlarge(block.box, below[k].box);
        block.longest = std::max(block.longest, below[k].longest);
      }
      levels_[level][i] = block;
    }
}

/// Takes a row of n nodes into its block; `longest` is squared meanwhile. Most rows have as many nodes as a brick: a
/// constant, and all in registers.
template <class N>
void EdgeBoxes::take_in(const Row& row, const N n, const Points& x) {
  Block& block = now_[row.block];
  Vec3 lower = block.box.lower, upper = block.box.upper;
  const auto enlarge = [&](const std::uint32_t corner, const auto n_places) __attribute__((always_inline)) {
    const Vec3* const places = x.data() + corner;
    for (unsigned k = 0; k < n_places; ++k) {
      lower = lower.cwiseMin(places[k]);
      upper = upper.cwiseMax(places[k]);
    }
  };
  enlarge(row.first, n);
  if (row.x_end != none)
    enlarge(row.x_end, 1u);
  for (int i = 0; i < 2; ++i)
    if (row.leaves[i])
      enlarge(row.upper[i], n);
  block.box = {lower, upper};

  double squared = block.longest;
  const auto lengthen = [&](const Vec3* const p, const Vec3* const q, const auto n_edges)
    __attribute__((always_inline)) {
    for (unsigned k = 0; k < n_edges; ++k)
      squared = std::max(squared, (q[k] - p[k]).squaredNorm());
  };
  const Vec3* const first = x.data() + row.first;
  lengthen(first, first + 1, n - 1);
  if (row.x_end != none)
    lengthen(first + n - 1, x.data() + row.x_end, 1u);
  if (row.upper[0] != none)
    lengthen(first, x.data() + row.upper[0], n);
  if (row.upper[1] != none)
    lengthen(first, x.data() + row.upper[1], n);
  block.longest = squared;
}

std::vector<std::uint32_t> EdgeBoxes::blocks(const std::function<bool(const Block&)>& may_meet) const {
  std::vector<std::uint32_t> found;
  visit(levels_.size() - 1, 0, may_meet, found);
  return found;
}

void EdgeBoxes::visit(const std::size_t level, const std::size_t i, const std::function<bool(const Block&)>& may_meet,
                      std::vector<std::uint32_t>& found) const {
  if (!may_meet(levels_[level][i]))
    return;
  if (level == 0) {
    found.push_back(static_cast<std::uint32_t>(i));
    return;
  }
  for (std::size_t k = n_children * i; k < std::min(levels_[level - 1].size(), n_children * (i + 1)); ++k)
    visit(level - 1, k, may_meet, found);
}

std::size_t EdgeBoxes::n_bytes() const {
  std::size_t n =
    starts_.capacity() * sizeof(Start) + (now_.capacity() + before_.capacity()) * sizeof(Block) +
    rows_.capacity() * sizeof(Row) + (slabs_.capacity() + rows_of_blocks_.capacity()) * sizeof(std::uint32_t) +
    (cells_.capacity() + skin_cells_.capacity()) * sizeof(grid::CellId) + skin_.capacity() * sizeof(SkinEdge);
  for (const auto& level : levels_)
    n += level.capacity() * sizeof(Block);
  return n;
}

void require_finite(const Points& x) {
  constexpr std::size_t chunk = 4096, worth = 2;
  Loan<std::uint8_t> is_finite((x.size() + chunk - 1) / chunk);
  parallel_for(
    is_finite.size(),
    [&](const std::size_t k) {
      Vec3 even = Vec3::Zero(), odd = even; // stay zero as long as the numbers are finite
      std::size_t i = k * chunk;
      const std::size_t end = std::min(x.size(), (k + 1) * chunk);
      for (; i + 1 < end; i += 2) {
        even += 0.0 * x[i];
        odd += 0.0 * x[i + 1];
      }
      if (i < end)
        even += 0.0 * x[i];
      is_finite[k] = even == Vec3::Zero() && odd == Vec3::Zero();
    },
    worth);
  const auto found = std::find(is_finite.begin(), is_finite.end(), 0);
  if (found == is_finite.end())
    return;
  auto i = static_cast<std::size_t>(found - is_finite.begin()) * chunk;
  while (x[i].allFinite())
    ++i;
  throw NumericalError("the position of corner " + std::to_string(i) + " is not finite, so it cannot be cut");
}

} // namespace kerf::cut
