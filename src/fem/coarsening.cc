#include "fem/coarsening.h"

#include "base/loan.h"
#include "base/parallel.h"
#include "base/shared_union_find.h"
#include "grid/cube.h"

#include <array>
#include <atomic>
#include <mutex>
#include <numeric>
#include <utility>

namespace kerf::fem {

namespace {

constexpr std::uint32_t none = CellsOfLevel::unused;

constexpr std::size_t worth = 4096; // copies or corners from which on a second thread pays

/// The copies whose lowest vertex is each corner.
class ByLowestCorner {
 public:
  explicit ByLowestCorner(const CellsView& cells)
    : first_(cells.n_corners, none), next_(cells.n_copies(), AnyValues()) {
    for (auto c = static_cast<std::uint32_t>(cells.n_copies()); c-- > 0;)
      if (cells.is_used(c)) {
        std::uint32_t& first = first_[cells.corners[8 * std::size_t(c)]];
        next_[c] = first;
        first = c;
      }
  }
  std::uint32_t first(const std::uint32_t corner) const { return first_[corner]; }
  std::uint32_t next(const std::uint32_t copy) const { return next_[copy]; }

 private:
  Loan<std::uint32_t> first_, next_;
};

bool are_glued(const CellsView& cells, const std::uint32_t below, const std::uint32_t above, const int axis) {
  for (const int v : grid::cube::face_vertices[2 * axis])
    if (cells.corners[8 * std::size_t(below) + (v | 1 << axis)] != cells.corners[8 * std::size_t(above) + v])
      return false;
  return true;
}

bool is_upper(const CellsView& cells, const std::uint32_t copy, const int axis) {
  return (cells.place[copy][axis] & 1) != 0;
}

/// Which copies are glued onto each, above it along each axis: at a cut's front two may be.
class Glued {
 public:
  explicit Glued(const CellsView& cells) : first_(3 * cells.n_copies(), AnyValues()) {
    const ByLowestCorner at(cells);
    std::mutex mutex;
    parallel_for(
      cells.n_copies(),
      [&](const std::size_t i) {
        const auto c = static_cast<std::uint32_t>(i);
        for (int axis = 0; axis < 3; ++axis) {
          std::uint32_t& first = first_[3 * i + axis];
          first = none;
          if (!cells.is_used(c))
            continue;
          const std::uint32_t corner = cells.corners[8 * i + (std::size_t(1) << axis)];
          for (auto above = at.first(corner); above != none; above = at.next(above))
            if (are_glued(cells, c, above, axis)) {
              if (first == none)
                first = above;
              else {
                first |= has_others;
                const std::lock_guard lock(mutex);
                others_.push_back({c, above, axis});
              }
            }
        }
      },
      worth);
  }

  /// Calls f(above) for each; several threads may.
  template <class Function>
  void for_each_above(const std::uint32_t c, const int axis, const Function& f) const {
    const std::uint32_t first = first_[3 * std::size_t(c) + axis];
    if (first == none)
      return;
    f(first & ~has_others);
    if ((first & has_others) != 0)
      for (const Other& other : others_)
        if (other.below == c && other.axis == axis)
          f(other.above);
  }

 private:
  static constexpr std::uint32_t has_others = 0x80000000;
  struct Other {
    std::uint32_t below, above;
    int axis;
  };
  Loan<std::uint32_t> first_; // three a copy
  std::vector<Other> others_;
};

void find_copies(const CellsView& fine, const Glued& glued, Coarsening& result) {
  SharedUnionFind joined(fine.n_copies());
  parallel_for(
    fine.n_copies(),
    [&](const std::size_t i) {
      const auto c = static_cast<std::uint32_t>(i);
      for (int axis = 0; axis < 3; ++axis)
        if (!is_upper(fine, c, axis))
          glued.for_each_above(c, axis, [&](const std::uint32_t above) { joined.unite(c, above); });
    },
    worth);
  const std::uint32_t n =
    joined.number(result.parent, none, [&](const std::uint32_t c) { return fine.is_used(c); });
  result.octant.resize(fine.n_copies());
  result.coarse.place.resize(n);
  result.children = {result.parent, n};
  parallel_for(
    fine.n_copies(),
    [&](const std::size_t c) {
      const Index3& place = fine.place[c];
      const int octant = (place[0] & 1) | (place[1] & 1) << 1 | (place[2] & 1) << 2;
      result.octant[c] = static_cast<std::uint8_t>(fine.is_used(c) ? octant : 0);
    },
    worth);
  parallel_for(
    n,
    [&](const std::size_t coarse) {
      const Index3& place = fine.place[result.children.of(coarse)[0]];
      result.coarse.place[coarse] = {place[0] >> 1, place[1] >> 1, place[2] >> 1};
    },
    worth);
}

/// Over whole faces, where fine copies are glued that lie in two coarse cubes.
void find_corners(const CellsView& fine, const Glued& glued, Coarsening& result) {
  SharedUnionFind joined(8 * result.coarse.n_copies());
  parallel_for(
    result.coarse.n_copies(),
    [&](const std::size_t i) {
      const auto low = static_cast<std::uint32_t>(i);
      for (int axis = 0; axis < 3; ++axis) {
        std::uint32_t last = none;
        for (const std::uint32_t child : result.children.of(low))
          if (is_upper(fine, child, axis))
            glued.for_each_above(child, axis, [&](const std::uint32_t above) {
              const std::uint32_t high = result.parent[above];
              if (std::exchange(last, high) != high)
                for (const int v : grid::cube::face_vertices[2 * axis])
                  joined.unite(8 * low + static_cast<std::uint32_t>(v | 1 << axis),
                               8 * high + static_cast<std::uint32_t>(v));
            });
      }
    },
    worth / 8);
  result.coarse.n_corners = joined.number(result.coarse.corners);
}

/// The coarse vertices that a vertex of a fine cube lies between, and how near each is.
struct RowOfWeights {
  std::uint32_t n = 0;
  std::array<std::uint32_t, 8> vertex = {};
  std::array<float, 8> weight = {};
};
/// By octant, and vertex of the fine cube.
using TableOfWeights = std::array<std::array<RowOfWeights, 8>, 8>;
TableOfWeights table_of_weights() {
  TableOfWeights table;
  for (unsigned octant = 0; octant < 8; ++octant)
    for (unsigned fine = 0; fine < 8; ++fine)
      for (unsigned v = 0; v < 8; ++v) {
        float weight = 1;
        for (unsigned axis = 0; axis < 3; ++axis) {
          const unsigned halves = (octant >> axis & 1) + (fine >> axis & 1); // from the lower vertex
          weight *= 0.5f * static_cast<float>((v >> axis & 1) != 0 ? halves : 2 - halves);
        }
        RowOfWeights& row = table[octant][fine];
        if (weight > 0) {
          row.vertex[row.n] = v;
          row.weight[row.n++] = weight;
        }
      }
  return table;
}

/// Of each corner the lowest of the 8 copy + vertex that have it.
Loan<std::uint32_t> users(const CellsView& cells) {
  Loan<std::uint32_t> user(cells.n_corners, none);
  parallel_for(
    cells.n_copies(),
    [&](const std::size_t c) {
      for (std::size_t i = 8 * c; i < 8 * c + 8 && cells.is_used(c); ++i) {
        const std::atomic_ref lowest(user[cells.corners[i]]);
        std::uint32_t before = lowest.load(std::memory_order_relaxed);
        while (i < before && !lowest.compare_exchange_weak(before, static_cast<std::uint32_t>(i),
                                                           std::memory_order_relaxed)) {
        }
      }
    },
    worth);
  return user;
}

/// Every copy with a corner says the same of it.
void find_weights(const CellsView& fine, Coarsening& result) {
  static const TableOfWeights table = table_of_weights();
  const Loan<std::uint32_t> user = users(fine);
  const auto row_of = [&](const std::uint32_t i) -> const RowOfWeights& { return table[result.octant[i / 8]][i % 8]; };
  Weights& weights = result.prolongation;
  weights.begin.resize(fine.n_corners + 1);
  for (std::size_t corner = 0; corner < fine.n_corners; ++corner)
    weights.begin[corner + 1] = weights.begin[corner] + (user[corner] == none ? 0 : row_of(user[corner]).n);
  weights.column.resize(weights.begin.back());
  weights.weight.resize(weights.begin.back());
  parallel_for(
    fine.n_corners,
    [&](const std::size_t corner) {
      const std::uint32_t i = user[corner];
      if (i == none)
        return;
      const RowOfWeights& row = row_of(i);
      const std::uint32_t* const corners = result.coarse.corners.data() + 8 * std::size_t(result.parent[i / 8]);
      for (std::uint32_t k = 0; k < row.n; ++k) {
        weights.column[weights.begin[corner] + k] = corners[row.vertex[k]];
        weights.weight[weights.begin[corner] + k] = row.weight[k];
      }
    },
    worth);
}

} // namespace

Children::Children(const std::span<const std::uint32_t> parent, const std::size_t n_coarse) : begin(n_coarse + 1, 0) {
  for (const std::uint32_t p : parent)
    if (p != none)
      ++begin[p + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  all.resize(begin[n_coarse]);
  std::vector<std::uint32_t> end(begin.begin(), begin.end() - 1);
  for (std::uint32_t c = 0; c < parent.size(); ++c)
    if (parent[c] != none)
      all[end[parent[c]]++] = c;
}

/// Rows go in one part a thread: what a part puts into a column comes after what those before it do.
Weights transposed(const Weights& weights, const std::size_t n_columns) {
  const std::size_t n_rows = weights.begin.size() - 1,
                    n_parts = n_rows < worth ? 1 : static_cast<std::size_t>(n_threads());
  const auto part = [&](const std::size_t p) { return p * n_rows / n_parts; };
  Loan<std::uint32_t> place(n_parts * n_columns, 0); // of each part in each column
  parallel_for(n_parts, [&](const std::size_t p) {
    for (std::uint32_t k = weights.begin[part(p)]; k < weights.begin[part(p + 1)]; ++k)
      ++place[p * n_columns + weights.column[k]];
  });
  Weights result;
  result.begin.resize(n_columns + 1);
  for (std::size_t column = 0; column < n_columns; ++column) {
    std::uint32_t end = result.begin[column];
    for (std::size_t p = 0; p < n_parts; ++p)
      end += std::exchange(place[p * n_columns + column], end);
    result.begin[column + 1] = end;
  }
  result.column.resize(weights.column.size());
  result.weight.resize(weights.column.size());
  parallel_for(n_parts, [&](const std::size_t p) {
    for (std::size_t row = part(p); row < part(p + 1); ++row)
      for (std::uint32_t k = weights.begin[row]; k < weights.begin[row + 1]; ++k) {
        const std::uint32_t i = place[p * n_columns + weights.column[k]]++;
        result.column[i] = static_cast<std::uint32_t>(row);
        result.weight[i] = weights.weight[k];
      }
  });
  return result;
}

Coarsening coarsened(const CellsView& fine) {
  Coarsening result;
  const Glued glued(fine);
  find_copies(fine, glued, result);
  find_corners(fine, glued, result);
  find_weights(fine, result);
  result.restriction = transposed(result.prolongation, result.coarse.n_corners);
  return result;
}

} // namespace kerf::fem
