#pragma once

/// When two complexes, or two surfaces, are one up to the names of copies, corners and vertices.

#include "surface/surface.h"

#include <optional>

namespace kerf::support {

/// For each copy and corner of one complex, that of another.
struct Renaming {
  Table<grid::CopyId, grid::CopyId> copies;
  Table<grid::CornerId, grid::CornerId> corners;
};

/// Pairs names one to one.
template <class Key>
class Pairs {
 public:
  Pairs(const std::size_t n_a, const std::size_t n_b) : to_b_(n_a), to_a_(n_b) {}
  bool add(const Key a, const Key b) {
    if (!to_b_[a].valid() && !to_a_[b].valid()) {
      to_b_[a] = b;
      to_a_[b] = a;
    }
    return to_b_[a] == b && to_a_[b] == a;
  }
  const Table<Key, Key>& to_b() const { return to_b_; }

 private:
  Table<Key, Key> to_b_, to_a_;
};

/// Nothing when the complexes differ. The copies of a cell are told apart by their nodes, and come in a fixed order.
inline std::optional<Renaming> renaming(const grid::CellComplex& a, const grid::CellComplex& b) {
  if (a.n_copies() != b.n_copies() || a.n_corners() != b.n_corners() || a.first_copy.size() != b.first_copy.size())
    return std::nullopt;
  Pairs<grid::CopyId> copies(a.n_copies(), b.n_copies());
  Pairs<grid::CornerId> corners(a.n_corners(), b.n_corners());
  std::size_t n_found = 0;
  for (const auto cell : ids<grid::CellId>(a.first_copy.size())) {
    auto i = a.copies_of(cell).begin(), j = b.copies_of(cell).begin();
    for (; (*i).valid() && (*j).valid(); ++i, ++j, ++n_found) {
      const grid::Copy &p = a.copies[*i], &q = b.copies[*j];
      if (!copies.add(*i, *j) || p.cell != cell || q.cell != cell || p.nodes != q.nodes)
        return std::nullopt;
      for (int v = 0; v < 8; ++v)
        if (!corners.add(p.corners[v], q.corners[v]) || a.node[p.corners[v]] != b.node[q.corners[v]])
          return std::nullopt;
    }
    if ((*i).valid() || (*j).valid())
      return std::nullopt;
  }
  for (const auto n : ids<grid::NodeId>(a.real_corner.size())) {
    const grid::CornerId p = a.real_corner[n], q = b.real_corner[n];
    if (p.valid() != q.valid() || (p.valid() && corners.to_b()[p] != q))
      return std::nullopt;
  }
  if (n_found != a.n_copies())
    return std::nullopt;
  return Renaming{copies.to_b(), corners.to_b()};
}

/// Surfaces of the same cuts, on complexes that `names` pairs: the same triangles, the same bits of rest positions and
/// weights.
inline bool is_same(const surface::Surface& a, const surface::Surface& b, const Renaming& names) {
  if (a.rest.size() != b.rest.size() || a.labels != b.labels || a.triangles.size() != b.triangles.size() ||
      a.copies.size() != b.copies.size() || a.weights.n_rows() != b.weights.n_rows())
    return false;
  Pairs<Id<void>> vertices(a.rest.size(), b.rest.size());
  for (std::size_t t = 0; t < a.triangles.size(); ++t) {
    if (names.copies[a.copies[t]] != b.copies[t])
      return false;
    for (int i = 0; i < 3; ++i)
      if (!vertices.add(Id<void>(a.triangles[t][i]), Id<void>(b.triangles[t][i])))
        return false;
  }
  for (std::size_t i = 0; i < a.rest.size(); ++i) {
    const Id<void> j = vertices.to_b()[Id<void>(i)];
    if (!j.valid() || a.rest[i] != b.rest[j.value])
      return false;
    const surface::Weights &v = a.weights, &w = b.weights;
    const std::uint32_t first = v.row_start[i], other = w.row_start[j.value], n = v.row_start[i + 1] - first;
    if (w.row_start[j.value + 1] - other != n)
      return false;
    for (std::uint32_t k = 0; k < n; ++k)
      if (v.values[first + k] != w.values[other + k] || names.corners[v.corners[first + k]] != w.corners[other + k])
        return false;
  }
  return true;
}

} // namespace kerf::support
