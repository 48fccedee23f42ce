#include "fem/coarsening.h"

#include "base/union_find.h"
#include "grid/cube.h"

#include <array>
#include <numeric>
#include <utility>

namespace kerf::fem {

namespace {

constexpr std::uint32_t none = CellsOfLevel::unused;

/// The copies whose lowest vertex is each corner.
class ByLowestCorner {
 public:
  explicit ByLowestCorner(const CellsView& cells) : first_(cells.n_corners, none), next_(cells.n_copies(), none) {
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
  std::vector<std::uint32_t> first_, next_;
};

bool are_glued(const CellsView& cells, const std::uint32_t below, const std::uint32_t above, const int axis) {
  for (const int v : grid::cube::face_vertices[2 * axis])
    if (cells.corners[8 * std::size_t(below) + (v | 1 << axis)] != cells.corners[8 * std::size_t(above) + v])
      return false;
  return true;
}

/// Calls f(below, above, axis) for all pairs of copies that are glued.
template <class Function>
void for_each_glued(const CellsView& cells, const Function& f) {
  const ByLowestCorner at(cells);
  for (std::uint32_t c = 0; c < cells.n_copies(); ++c)
    for (int axis = 0; axis < 3 && cells.is_used(c); ++axis)
      for (auto above = at.first(cells.corners[8 * std::size_t(c) + (std::size_t(1) << axis)]); above != none;
           above = at.next(above))
        if (are_glued(cells, c, above, axis))
          f(c, above, axis);
}

bool is_upper(const CellsView& cells, const std::uint32_t copy, const int axis) {
  return (cells.place[copy][axis] & 1) != 0;
}

/// Numbers for roots, by first occurrence.
class Numbers {
 public:
  explicit Numbers(const std::size_t n) : number_(n, none) {}
  std::uint32_t of(const std::uint32_t root) {
    if (number_[root] == none)
      number_[root] = n_++;
    return number_[root];
  }
  std::uint32_t n() const { return n_; }

 private:
  std::vector<std::uint32_t> number_;
  std::uint32_t n_ = 0;
};

/// Two fine copies that are glued, and lie in two coarse cubes.
struct Across {
  std::uint32_t below, above;
  int axis;
};

std::vector<Across> find_copies(const CellsView& fine, Coarsening& result) {
  UnionFind joined(fine.n_copies());
  std::vector<Across> across;
  across.reserve(2 * fine.n_copies());
  for_each_glued(fine, [&](const std::uint32_t below, const std::uint32_t above, const int axis) {
    if (is_upper(fine, below, axis))
      across.push_back({below, above, axis});
    else
      joined.unite(below, above);
  });
  Numbers numbers(fine.n_copies());
  result.parent.assign(fine.n_copies(), none);
  result.octant.assign(fine.n_copies(), 0);
  for (std::uint32_t c = 0; c < fine.n_copies(); ++c) {
    if (!fine.is_used(c))
      continue;
    result.parent[c] = numbers.of(joined.root(c));
    const Index3& place = fine.place[c];
    if (result.parent[c] == result.coarse.place.size())
      result.coarse.place.push_back({place[0] >> 1, place[1] >> 1, place[2] >> 1});
    for (int axis = 0; axis < 3; ++axis)
      result.octant[c] |= static_cast<std::uint8_t>((place[axis] & 1) << axis);
  }
  return across;
}

void find_corners(const std::span<const Across> across, Coarsening& result) {
  const std::size_t n = 8 * result.coarse.n_copies();
  UnionFind joined(n);
  std::vector<std::array<std::uint32_t, 3>> above_of(result.coarse.n_copies(), {none, none, none}); // joined last
  for (const auto& [below, above, axis] : across) {
    const std::uint32_t low = result.parent[below], high = result.parent[above];
    if (std::exchange(above_of[low][static_cast<std::size_t>(axis)], high) == high)
      continue;
    for (const int v : grid::cube::face_vertices[2 * axis])
      joined.unite(8 * low + static_cast<std::uint32_t>(v | 1 << axis), 8 * high + static_cast<std::uint32_t>(v));
  }
  Numbers numbers(n);
  result.coarse.corners.reserve(n);
  for (std::uint32_t i = 0; i < n; ++i)
    result.coarse.corners.push_back(numbers.of(joined.root(i)));
  result.coarse.n_corners = numbers.n();
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

/// Every copy with a corner says the same of it.
void find_weights(const CellsView& fine, Coarsening& result) {
  static const TableOfWeights table = table_of_weights();
  std::vector<std::uint32_t> user(fine.n_corners, none);
  for (std::uint32_t i = 0; i < fine.corners.size(); ++i)
    if (const std::uint32_t corner = fine.corners[i]; corner != none && user[corner] == none)
      user[corner] = i;
  Weights& weights = result.prolongation;
  weights.begin.reserve(fine.n_corners + 1);
  weights.column.reserve(4 * fine.n_corners);
  weights.weight.reserve(4 * fine.n_corners);
  for (const std::uint32_t i : user) {
    if (i != none) {
      const RowOfWeights& row = table[result.octant[i / 8]][i % 8];
      const std::uint32_t* const corners = result.coarse.corners.data() + 8 * std::size_t(result.parent[i / 8]);
      for (std::uint32_t k = 0; k < row.n; ++k) {
        weights.column.push_back(corners[row.vertex[k]]);
        weights.weight.push_back(row.weight[k]);
      }
    }
    weights.begin.push_back(static_cast<std::uint32_t>(weights.column.size()));
  }
}

} // namespace

Weights transposed(const Weights& weights, const std::size_t n_columns) {
  Weights result;
  result.begin.assign(n_columns + 1, 0);
  for (const std::uint32_t column : weights.column)
    ++result.begin[column + 1];
  std::partial_sum(result.begin.begin(), result.begin.end(), result.begin.begin());
  std::vector<std::uint32_t> end(result.begin.begin(), result.begin.end() - 1);
  result.column.resize(weights.column.size());
  result.weight.resize(weights.column.size());
  for (std::uint32_t row = 0; row + 1 < weights.begin.size(); ++row)
    for (std::uint32_t k = weights.begin[row]; k < weights.begin[row + 1]; ++k) {
      const std::uint32_t place = end[weights.column[k]]++;
      result.column[place] = row;
      result.weight[place] = weights.weight[k];
    }
  return result;
}

Coarsening coarsened(const CellsView& fine) {
  Coarsening result;
  find_corners(find_copies(fine, result), result);
  find_weights(fine, result);
  result.restriction = transposed(result.prolongation, result.coarse.n_corners);
  return result;
}

} // namespace kerf::fem
