#pragma once

/// When two complexes, or two surfaces, are one up to the names of copies, corners and vertices.

#include "surface/surface.h"

#include <algorithm>
#include <optional>
#include <string>

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

inline std::size_t n_in_use(const grid::CellComplex& complex) {
  return static_cast<std::size_t>(
    std::ranges::count_if(complex.copies, [](const grid::Copy& copy) { return !copy.is_lapsed(); }));
}

/// Nothing when the complexes differ. The copies of a cell are told apart by their parts, and come in a fixed order.
/// What has lapsed does not count.
inline std::optional<Renaming> renaming(const grid::CellComplex& a, const grid::CellComplex& b) {
  if (n_in_use(a) != n_in_use(b) || a.n_corners() - a.lapsed.size() != b.n_corners() - b.lapsed.size() ||
      a.first_copy.size() != b.first_copy.size())
    return std::nullopt;
  Pairs<grid::CopyId> copies(a.n_copies(), b.n_copies());
  Pairs<grid::CornerId> corners(a.n_corners(), b.n_corners());
  std::size_t n_found = 0;
  for (const auto cell : ids<grid::CellId>(a.first_copy.size())) {
    auto i = a.copies_of(cell).begin(), j = b.copies_of(cell).begin();
    for (; (*i).valid() && (*j).valid(); ++i, ++j, ++n_found) {
      const grid::Copy &p = a.copies[*i], &q = b.copies[*j];
      if (!copies.add(*i, *j) || p.cell != cell || q.cell != cell || p.nodes != q.nodes || p.skin != q.skin)
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
  if (n_found != n_in_use(a))
    return std::nullopt;
  return Renaming{copies.to_b(), corners.to_b()};
}

/// A triangle by what it is: copy, label, and the bits of its vertices' rest positions and weights, from the smallest
/// vertex on.
inline std::string described(const surface::Surface& s, const std::size_t t, const Renaming* const names) {
  std::array<std::string, 3> vertices;
  const auto add = [](std::string& text, const auto value) {
    text.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t v = s.triangles[t][i];
    for (const double x : s.rest[v])
      add(vertices[i], x + 0.0); // one zero
    for (auto k = s.weights.start[v]; k < s.weights.start[v + 1]; ++k) {
      const grid::CornerId corner(s.weights.columns[k]);
      add(vertices[i], (names ? names->corners[corner] : corner).value);
      add(vertices[i], s.weights.values[k]);
    }
  }
  std::rotate(vertices.begin(), std::min_element(vertices.begin(), vertices.end()), vertices.end());
  std::string text = vertices[0] + vertices[1] + vertices[2];
  add(text, s.labels[t]);
  add(text, (names ? names->copies[s.copies[t]] : s.copies[t]).value);
  return text;
}

/// Surfaces of the same cuts, on complexes that `names` pairs: the same triangles, the same bits of rest positions and
/// weights; neither their order nor vertices without triangles count.
inline bool is_same(const surface::Surface& a, const surface::Surface& b, const Renaming& names) {
  if (a.triangles.size() != b.triangles.size() || a.labels.size() != a.triangles.size() ||
      b.labels.size() != b.triangles.size() || a.copies.size() != a.triangles.size() ||
      b.copies.size() != b.triangles.size() || a.weights.n_points() != a.rest.size() ||
      b.weights.n_points() != b.rest.size())
    return false;
  std::vector<std::string> of_a, of_b;
  for (std::size_t t = 0; t < a.triangles.size(); ++t) {
    of_a.push_back(described(a, t, &names));
    of_b.push_back(described(b, t, nullptr));
  }
  std::sort(of_a.begin(), of_a.end());
  std::sort(of_b.begin(), of_b.end());
  return of_a == of_b;
}

} // namespace kerf::support
