#include "fem/coarsening.h"

#include "grid/cube.h"

#include <numeric>

namespace kerf::fem {

namespace {

constexpr std::uint32_t none = CellsOfLevel::unused;

class UnionFind {
 public:
  explicit UnionFind(const std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }

  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i)
      i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// The lower number stays the root.
  void unite(const std::uint32_t i, const std::uint32_t j) {
    const std::uint32_t a = root(i), b = root(j);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// The copies whose lowest vertex is each corner.
class ByLowestCorner {
 public:
  explicit ByLowestCorner(const CellsOfLevel& cells) : first_(cells.n_corners, none), next_(cells.n_copies(), none) {
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

bool are_glued(const CellsOfLevel& cells, const std::uint32_t below, const std::uint32_t above, const int axis) {
  for (const int v : grid::cube::face_vertices[2 * axis])
    if (cells.corners[8 * std::size_t(below) + (v | 1 << axis)] != cells.corners[8 * std::size_t(above) + v])
      return false;
  return true;
}

/// Calls f(below, above, axis) for all pairs of copies that are glued.
template <class Function>
void for_each_glued(const CellsOfLevel& cells, const Function& f) {
  const ByLowestCorner at(cells);
  for (std::uint32_t c = 0; c < cells.n_copies(); ++c)
    for (int axis = 0; axis < 3 && cells.is_used(c); ++axis)
      for (auto above = at.first(cells.corners[8 * std::size_t(c) + (std::size_t(1) << axis)]); above != none;
           above = at.next(above))
        if (are_glued(cells, c, above, axis))
          f(c, above, axis);
}

bool is_upper(const CellsOfLevel& cells, const std::uint32_t copy, const int axis) {
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

void find_copies(const CellsOfLevel& fine, Coarsening& result) {
  UnionFind joined(fine.n_copies());
  for_each_glued(fine, [&](const std::uint32_t below, const std::uint32_t above, const int axis) {
    if (!is_upper(fine, below, axis))
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
}

void find_corners(const CellsOfLevel& fine, Coarsening& result) {
  const std::size_t n = 8 * result.coarse.n_copies();
  UnionFind joined(n);
  for_each_glued(fine, [&](const std::uint32_t below, const std::uint32_t above, const int axis) {
    if (is_upper(fine, below, axis))
      for (const int v : grid::cube::face_vertices[2 * axis])
        joined.unite(8 * result.parent[below] + static_cast<std::uint32_t>(v | 1 << axis),
                     8 * result.parent[above] + static_cast<std::uint32_t>(v));
  });
  Numbers numbers(n);
  for (std::uint32_t i = 0; i < n; ++i)
    result.coarse.corners.push_back(numbers.of(joined.root(i)));
  result.coarse.n_corners = numbers.n();
}

/// Every copy with a corner says the same of it.
void find_weights(const CellsOfLevel& fine, Coarsening& result) {
  std::vector<std::uint32_t> user(fine.n_corners, none);
  for (std::uint32_t i = 0; i < fine.corners.size(); ++i)
    if (const std::uint32_t corner = fine.corners[i]; corner != none && user[corner] == none)
      user[corner] = i;
  Weights& weights = result.prolongation;
  for (const std::uint32_t i : user) {
    for (unsigned v = 0; v < 8 && i != none; ++v) {
      float weight = 1;
      for (unsigned axis = 0; axis < 3; ++axis) {
        const unsigned halves = (result.octant[i / 8] >> axis & 1) + (i % 8 >> axis & 1); // from the lower vertex
        weight *= 0.5f * static_cast<float>((v >> axis & 1) != 0 ? halves : 2 - halves);
      }
      if (weight == 0)
        continue;
      weights.column.push_back(result.coarse.corners[8 * std::size_t(result.parent[i / 8]) + v]);
      weights.weight.push_back(weight);
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

Coarsening coarsened(const CellsOfLevel& fine) {
  Coarsening result;
  find_copies(fine, result);
  find_corners(fine, result);
  find_weights(fine, result);
  result.restriction = transposed(result.prolongation, result.coarse.n_corners);
  return result;
}

} // namespace kerf::fem
