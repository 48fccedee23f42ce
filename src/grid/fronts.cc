#include "grid/fronts.h"

#include "base/sort_unique.h"
#include "grid/material.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace kerf::grid {

namespace {

constexpr double stiffness = 0.59; // c

/// The vertices at which two copies of a cell do not share a corner.
std::vector<int> vertices_apart(const Copy& one, const Copy& other) {
  std::vector<int> apart;
  for (int v = 0; v < cube::n_vertices; ++v)
    if (one.corners[v] != other.corners[v])
      apart.push_back(v);
  return apart;
}

std::array<CornerId, 2> both_of(const Tie& tie) { return {std::min(tie.a, tie.b), std::max(tie.a, tie.b)}; }

/// Is it of skin alone?
bool is_skin(const Copy& copy) { return copy.nodes == 0; }

/// Of the ties at these vertices.
std::vector<double> lengths(const Solid& solid, const Front& front, const Copy& one, const Copy& other,
                            const std::vector<int>& apart) {
  const double h = solid.grid.h();
  if (is_skin(one) || is_skin(other))
    return std::vector<double>(apart.size(), std::max(0.0, std::min(fill(solid, one), fill(solid, other))) * h /
                                               static_cast<double>(apart.size()));
  std::vector<double> lengths;
  for (const int v : apart)
    lengths.push_back(stiffness * front.held[v] / h);
  return lengths;
}

/// Do cuts leave two copies of a cell in one part?
bool hang_together(const Parts& parts, const Copy& one, const Copy& other) {
  return std::any_of(parts.begin(), parts.end(), [&](const Part& part) {
    return (part.items() & one.items()) != 0 && (part.items() & other.items()) != 0;
  });
}

} // namespace

double front_lag(const Vec3& ahead) {
  const Vec3 squares = ahead.cwiseAbs2();
  const double along_grid = squares.squaredNorm() / std::pow(squares.sum(), 2);
  return 0.232 + 0.018 * along_grid * along_grid;
}

std::vector<std::array<CopyId, 2>> tied_copies(const Solid& solid, const CellComplex& complex,
                                               const std::span<const CellId> cells) {
  const auto& copies = complex.copies;
  std::vector<std::array<CopyId, 2>> tied;
  for (const CellId cell : cells) {
    if (!solid.cuts.front(cell))
      continue;
    const Parts parts = whole_parts_of(cuts_of(solid, cell));
    for (const CopyId c : complex.copies_of(cell))
      for (CopyId d = copies[c].next; d.valid(); d = copies[d].next)
        if (hang_together(parts, copies[c], copies[d]))
          tied.push_back({c, d});
  }
  return tied;
}

std::vector<Tie> ties(const Solid& solid) {
  const auto& copies = solid.complex.copies;
  std::vector<Tie> ties;
  std::vector<bool> are_shared;             // by the cells around
  std::map<std::array<CornerId, 2>, int> n; // cells that share the tie of these
  for (const auto& [c, d] : solid.complex.tied) {
    if (solid.crumbs.holds(c))
      continue;
    const Front& front = *solid.cuts.front(copies[c].cell);
    const std::vector<int> apart = vertices_apart(copies[c], copies[d]);
    const bool is_shared = !is_skin(copies[c]) && !is_skin(copies[d]);
    const std::vector<double> length = lengths(solid, front, copies[c], copies[d], apart);
    for (std::size_t i = 0; i < apart.size(); ++i) {
      ties.push_back({copies[c].corners[apart[i]], copies[d].corners[apart[i]], length[i]});
      are_shared.push_back(is_shared);
      if (is_shared)
        ++n[both_of(ties.back())];
    }
  }
  for (std::size_t i = 0; i < ties.size(); ++i)
    if (are_shared[i])
      ties[i].length /= n.at(both_of(ties[i]));
  return ties;
}

void share_mass(const std::span<const Tie> ties, const FunctionRef<double(CornerId)> enough,
                std::vector<double>& mass) {
  constexpr double part = 1.0 / 16; // that a corner gives away in all
  struct Gift {
    CornerId from, to;
    double amount = 0;
    auto operator<=>(const Gift& other) const = default;
  };
  std::vector<Gift> gifts;
  for (const auto& [a, b, length] : ties) {
    const bool is_a_lighter = mass[a.value] < mass[b.value];
    const Gift gift = is_a_lighter ? Gift{b, a} : Gift{a, b};
    if (mass[gift.to.value] < enough(gift.to))
      gifts.push_back(gift);
  }
  sort_unique(gifts); // cells around a corner have the same ties
  std::map<CornerId, int> n_from, n_to;
  for (const Gift& gift : gifts) {
    ++n_from[gift.from];
    ++n_to[gift.to];
  }
  for (auto& [from, to, amount] : gifts) {
    const double wanted = (enough(to) - mass[to.value]) / n_to[to];
    amount = std::min(wanted, std::max(0.0, part * mass[from.value] / n_from[from] - mass[to.value]));
  }
  for (const auto& [from, to, amount] : gifts) {
    mass[from.value] -= amount;
    mass[to.value] += amount;
  }
}

void soften(std::vector<Tie>& ties, const double modulus, const double square_frequency,
            const FunctionRef<double(CornerId)> mass) {
  std::map<CornerId, double> parts; // of ties at a corner that are left
  for (const Tie& tie : ties)
    for (const CornerId c : {tie.a, tie.b})
      parts[c] += tie.length;
  for (auto& [c, part] : parts) {
    const double most = mass(c) * square_frequency / modulus;
    part = part > most ? most / part : 1;
  }
  for (Tie& tie : ties)
    tie.length *= std::min(parts.at(tie.a), parts.at(tie.b));
}

} // namespace kerf::grid
