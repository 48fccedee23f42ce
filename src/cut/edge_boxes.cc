#include "cut/edge_boxes.h"

#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace kerf::cut {

namespace {

constexpr int brick_bits = 2; // a brick has 2^2 nodes along each axis
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

EdgeBoxes::EdgeBoxes(const grid::Grid& grid, const grid::CellComplex& complex) {
  const Places places = list_nodes(grid, complex);
  list_uppers(grid, complex, places);
  list_cells(grid, places);
  levels_.emplace_back(n_blocks());
  while (levels_.back().size() > 1)
    levels_.emplace_back((levels_.back().size() + n_children - 1) / n_children);
}

/// The blocks' own corners; starts_ by node, as if there were no others.
EdgeBoxes::Places EdgeBoxes::list_nodes(const grid::Grid& grid, const grid::CellComplex& complex) {
  Places places{Table<grid::NodeId, std::uint32_t>(grid.n_nodes()), Table<grid::NodeId, std::uint8_t>(grid.n_nodes())};
  std::uint32_t n = 0;
  const auto runs = make_runs(grid);
  for (auto run = runs.begin(); run != runs.end();) {
    const auto block = static_cast<std::uint32_t>(starts_.size());
    starts_.push_back({0, n, 0});
    for (const std::uint64_t brick = run->brick; run != runs.end() && run->brick == brick; ++run)
      for (std::uint32_t i = 0; i < run->n; ++i, ++n) {
        const grid::NodeId node(run->first.value + i);
        places.block[node] = block;
        places.corner[node] = static_cast<std::uint8_t>(n - starts_.back().node);
        corners_.push_back(complex.real_corner[node]);
      }
  }
  starts_.push_back({0, n, 0});
  return places;
}

void EdgeBoxes::list_uppers(const grid::Grid& grid, const grid::CellComplex& complex, const Places& places) {
  const std::vector<grid::CornerId> own = std::move(corners_);
  corners_.clear();
  corners_.reserve(2 * own.size());
  uppers_.reserve(own.size());
  for (std::uint32_t block = 0; block < n_blocks(); ++block) {
    const std::size_t first = starts_[block].corner = static_cast<std::uint32_t>(corners_.size());
    const std::uint32_t begin = starts_[block].node, end = starts_[block + 1].node;
    corners_.insert(corners_.end(), own.begin() + begin, own.begin() + end);
    for (std::uint32_t i = begin; i < end; ++i) {
      auto& uppers = uppers_.emplace_back();
      for (int axis = 0; axis < 3; ++axis) {
        const grid::NodeId upper = upper_end(grid, complex.node[own[i]], axis);
        const bool is_own = upper.valid() && places.block[upper] == block;
        uppers[axis] = !upper.valid() ? no_upper
                       : is_own       ? places.corner[upper]
                                      : static_cast<std::uint8_t>(corners_.size() - first);
        if (upper.valid() && !is_own)
          corners_.push_back(complex.real_corner[upper]);
      }
    }
  }
  starts_.back().corner = static_cast<std::uint32_t>(corners_.size());
  corners_.shrink_to_fit();
}

void EdgeBoxes::list_cells(const grid::Grid& grid, const Places& places) {
  const auto block_of = [&](const grid::CellId c) { return places.block[lowest_material_node(grid, c)]; };
  for (const auto c : ids<grid::CellId>(grid.n_cells()))
    ++starts_[block_of(c) + 1].cell;
  for (std::size_t k = 1; k < starts_.size(); ++k)
    starts_[k].cell += starts_[k - 1].cell;
  cells_.resize(grid.n_cells());
  std::vector<std::uint32_t> next(n_blocks());
  std::transform(starts_.begin(), starts_.end() - 1, next.begin(), [](const Start& start) { return start.cell; });
  for (const auto c : ids<grid::CellId>(grid.n_cells()))
    cells_[next[block_of(c)]++] = c;
}

void EdgeBoxes::fit(const Points& x_before, const Points& x) {
  constexpr std::size_t worth = 64;
  require_finite(x);
  moves_ = x_before != x;
  parallel_for(
    n_blocks(), [&](const std::size_t k) { levels_[0][k] = fitted(static_cast<std::uint32_t>(k), x_before, x); },
    worth);
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

EdgeBoxes::Block EdgeBoxes::fitted(const std::uint32_t block, const Points& x_before, const Points& x) const {
  const std::uint32_t first = starts_[block].corner, end = starts_[block + 1].corner;
  Vec3 lower = x[corners_[first].value], upper = lower;
  const auto enlarge_by = [&](const Points& places) {
    for (std::uint32_t i = first; i < end; ++i) {
      const Vec3& p = places[corners_[i].value];
      lower = lower.cwiseMin(p);
      upper = upper.cwiseMax(p);
    }
  };
  enlarge_by(x);
  if (moves_)
    enlarge_by(x_before);
  double squared = 0;
  for_each_edge(block, [&](const grid::CornerId p, const grid::CornerId q, int) {
    squared = std::max(squared, (x[q.value] - x[p.value]).squaredNorm());
  });
  return {{lower, upper}, std::sqrt(squared)};
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
  std::size_t n = starts_.capacity() * sizeof(Start) + corners_.capacity() * sizeof(grid::CornerId) +
                  uppers_.capacity() * sizeof(uppers_[0]) + cells_.capacity() * sizeof(grid::CellId);
  for (const auto& level : levels_)
    n += level.capacity() * sizeof(Block);
  return n;
}

void require_finite(const Points& x) {
  constexpr std::size_t chunk = 4096, worth = 2;
  std::vector<std::uint8_t> is_finite((x.size() + chunk - 1) / chunk);
  parallel_for(
    is_finite.size(),
    [&](const std::size_t k) {
      Vec3 zero = Vec3::Zero(); // stays zero as long as the numbers are finite
      for (std::size_t i = k * chunk; i < std::min(x.size(), (k + 1) * chunk); ++i)
        zero += 0.0 * x[i];
      is_finite[k] = zero == Vec3::Zero();
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
