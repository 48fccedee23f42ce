#include "lattice/shares.h"

#include "grid/followed.h"
#include "grid/material.h"

#include "base/parallel.h"

#include <algorithm>
#include <bit>

namespace kerf::lattice {

namespace {

/// Of a cube: a piece of skin without volume has corners too, and they are to move with its node.
constexpr double least_share = 1e-12;

/// By the vertex of a node, and of a corner.
using CopyShares = std::array<std::array<double, 8>, 8>;

/// The integral of each N_a over the material at each node of the copy, and over that under the skin of nodes that are
/// not the copy's.
struct Integrals {
  CopyShares at_nodes{};
  std::array<double, 8> elsewhere{};
};

Integrals integrals_of(const grid::Solid& solid, const grid::Copy& copy) {
  Integrals integrals;
  grid::for_each_tetrahedron(solid, copy, [&](const grid::Tetrahedron& t, const int vertex) {
    auto& sum = copy.nodes >> vertex & 1 ? integrals.at_nodes[vertex] : integrals.elsewhere;
    const auto of_tetrahedron = grid::shape_integrals(t);
    for (int a = 0; a < 8; ++a)
      sum[a] += of_tetrahedron[a];
  });
  return integrals;
}

/// Bits of those vertices of `nodes` that are the fewest edges away from `corner`.
unsigned nearest(const unsigned nodes, const int corner) {
  for (int distance = 0; distance <= 3; ++distance) {
    unsigned found = 0;
    for (int v = 0; v < 8; ++v)
      if ((nodes >> v & 1) != 0 && std::popcount(static_cast<unsigned>(v ^ corner)) == distance)
        found |= 1u << v;
    if (found != 0)
      return found;
  }
  return 0;
}

CopyShares shares_of(const grid::Solid& solid, const grid::Copy& copy) {
  CopyShares shares{};
  if (copy.nodes == 0xff) { // a full cube, wherever its octants meet
    for (int a = 0; a < 8; ++a)
      shares[a][a] = 1.0 / 8;
    return shares;
  }
  const auto& [integrals, elsewhere] = integrals_of(solid, copy);
  std::array<double, 8> total = elsewhere;
  for (int a = 0; a < 8; ++a)
    for (int v = 0; v < 8; ++v)
      total[a] += integrals[v][a];
  for (int a = 0; a < 8; ++a) {
    const unsigned owners = nearest(copy.nodes, a);
    double of_owners = 0, least = 1;
    for (int v = 0; v < 8; ++v)
      if ((owners >> v & 1) != 0) {
        of_owners += integrals[v][a];
        least = std::min(least, integrals[v][a]);
      }
    for (int v = 0; v < 8; ++v)
      if ((owners >> v & 1) != 0) // even parts where the cell's vertex does not see all of a node's
        shares[v][a] =
          std::max(total[a], 0.0) * (least > 0 ? integrals[v][a] / of_owners : 1.0 / std::popcount(owners));
  }
  return shares;
}

bool is_before(const Share& a, const Share& b) { return a.node != b.node ? a.node < b.node : a.corner < b.corner; }

/// One share for each pair; sums in the order of the copies.
std::vector<Share> merged(std::vector<Share> shares) {
  std::stable_sort(shares.begin(), shares.end(), is_before);
  std::vector<Share> unique;
  for (const Share& share : shares) {
    if (!unique.empty() && unique.back().node == share.node && unique.back().corner == share.corner)
      unique.back().mass += share.mass;
    else
      unique.push_back(share);
  }
  return unique;
}

} // namespace

std::vector<Share> material_shares(const grid::Solid& solid, const double density) {
  std::vector<CopyShares> of_copy(solid.complex.n_copies());
  parallel_for(
    solid.complex.n_copies(),
    [&](const std::size_t c) {
      if (!solid.crumbs.holds(grid::CopyId(c)))
        of_copy[c] = shares_of(solid, solid.complex.copies[grid::CopyId(c)]);
    },
    256);
  const double scale = density * solid.grid.h() * solid.grid.h() * solid.grid.h();
  std::vector<Share> shares;
  for (const auto& [c, node] : grid::followed_nodes(solid)) {
    if (solid.crumbs.holds(c))
      continue;
    const grid::Copy& copy = solid.complex.copies[c];
    const auto integrals = integrals_of(solid, copy).elsewhere;
    for (int a = 0; a < 8; ++a)
      shares.push_back({node, copy.corners[a], scale * std::max(integrals[a], least_share)});
  }
  for (const auto c : ids<grid::CopyId>(solid.complex.n_copies())) {
    const grid::Copy& copy = solid.complex.copies[c];
    for (int vertex = 0; vertex < 8; ++vertex)
      for (int a = 0; a < 8; ++a)
        if (const double share = of_copy[c.value][vertex][a]; share > 0)
          shares.push_back({solid.grid.nodes(copy.cell)[vertex], copy.corners[a], scale * share});
  }
  return merged(std::move(shares));
}

} // namespace kerf::lattice
