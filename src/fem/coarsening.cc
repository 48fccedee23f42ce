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

constexpr std::size_t many_children = 4096; // copies or corners from which on a second thread pays

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
      many_children);
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
    many_children);
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
    many_children);
  parallel_for(
    n,
    [&](const std::size_t coarse) {
      const Index3& place = fine.place[result.children.of(coarse)[0]];
      result.coarse.place[coarse] = {place[0] >> 1, place[1] >> 1, place[2] >> 1};
    },
    many_children);
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
    many_children / 8);
  result.coarse.n_corners = joined.number(result.coarse.corners);
}

/// Of each corner the lowest of the 8 copy + vertex that have it.
std::vector<std::uint32_t> users(const CellsView& cells) {
  std::vector<std::uint32_t> user(cells.n_corners, none);
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
    many_children);
  return user;
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

const Coarsening::Table& Coarsening::weights() {
  static const Table table = [] {
    Table made;
    for (unsigned place = 0; place < 64; ++place)
      for (unsigned v = 0; v < 8; ++v) {
        float weight = 1;
        for (unsigned axis = 0; axis < 3; ++axis) {
          const unsigned halves = (place >> (3 + axis) & 1) + (place >> axis & 1); // from the lower vertex
          weight *= 0.5f * static_cast<float>((v >> axis & 1) != 0 ? halves : 2 - halves);
        }
        VertexWeights& row = made[place];
        if (weight > 0) {
          row.vertex[row.n] = v;
          row.weight[row.n++] = weight;
        }
      }
    return made;
  }();
  return table;
}

void Coarsening::ask(const CellsView& fine) {
  user_ = users(fine);
  begin_.assign(coarse.n_copies() + 1, 0);
  const auto for_each = [&](const std::size_t c, const auto& f) {
    for (const std::uint32_t child : children.of(c))
      for (std::uint32_t i = 8 * child; i < 8 * child + 8; ++i)
        if (user_[fine.corners[i]] == i)
          f(i);
  };
  parallel_for(
    coarse.n_copies(), [&](const std::size_t c) { for_each(c, [&](std::uint32_t) { ++begin_[c + 1]; }); },
    many_children / 8);
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  corner_.resize(begin_.back());
  place_.resize(begin_.back());
  parallel_for(
    coarse.n_copies(),
    [&](const std::size_t c) {
      std::uint32_t at = begin_[c];
      for_each(c, [&](const std::uint32_t i) {
        corner_[at] = fine.corners[i];
        place_[at++] = place_of(i);
      });
    },
    many_children / 8);
}

Coarsening coarsened(const CellsView& fine) {
  Coarsening result;
  const Glued glued(fine);
  find_copies(fine, glued, result);
  find_corners(fine, glued, result);
  result.ask(fine);
  return result;
}

} // namespace kerf::fem
