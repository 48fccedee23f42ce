#include "pba/corners.h"

#include "base/loan.h"
#include "base/parallel.h"
#include "grid/followed.h"
#include "pba/kernel.h"
#include "pba/point_grid.h"
#include "pba/reach.h"

#include <algorithm>
#include <bit>
#include <numeric>

namespace kerf::pba {

namespace {

constexpr std::size_t many_corners = 512; // corners from which on a second thread pays

/// x + F (X - X_i) as a + F X: F in columns 0 .. 2, a in column 3.
using Motion = Eigen::Matrix<double, 3, 4>;

/// Row of each material node.
Table<grid::NodeId, std::uint32_t> rows_of(const grid::CellComplex& complex, const NodePairs& pairs) {
  Table<grid::NodeId, std::uint32_t> rows(complex.real_corner.size(), Id<void>::no_value);
  for (std::uint32_t r = 0; r < pairs.nodes.size(); ++r)
    rows[pairs.nodes[r]] = r;
  return rows;
}

/// The phyxels that each row sees, and those that carry rows that see none.
void fill_rows(const grid::Solid& solid, const Phyxels& phyxels, std::span<const grid::CopyId> copies,
               const NodePairs& pairs, std::span<const Sight> sights, CornerMap& map) {
  std::vector<double> weights, sums(pairs.nodes.size(), 0.0);
  for (std::size_t p = 0; p < pairs.pairs.size(); ++p) {
    weights.push_back(weight(sights[p], pairs.support[p]));
    sums[pairs.pairs[p][0]] += weights[p];
  }
  std::vector<std::uint32_t> blind;
  for (std::uint32_t r = 0; r < sums.size(); ++r)
    if (!(sums[r] > 0))
      blind.push_back(r);
  map.n_blind = blind.size();
  const Reached reached = reach(solid, pairs.nodes, pairs.rest, phyxels.rest, copies, blind);
  map.n_orphans = reached.n_orphans;

  std::size_t p = 0, b = 0;
  for (std::uint32_t r = 0; r < sums.size(); ++r) {
    for (; p < pairs.pairs.size() && pairs.pairs[p][0] == r; ++p)
      if (sums[r] > 0 && weights[p] > 0)
        map.rows.add_entry(pairs.pairs[p][1], weights[p] / sums[r]);
    if (!(sums[r] > 0))
      map.rows.add_entry(reached.phyxel[b++], 1);
    map.rows.end_row();
  }
}

/// Real corners of a copy the fewest edges away from one of its corners, as rows of the map.
constexpr int far = 99; ///< more edges than a copy has
struct Sources {
  int n_edges = far;
  std::vector<std::uint32_t> rows;

  void offer(const int distance, const std::uint32_t row) {
    if (distance > n_edges)
      return;
    if (distance < n_edges)
      rows.clear();
    n_edges = distance;
    if (std::find(rows.begin(), rows.end(), row) == rows.end())
      rows.push_back(row);
  }
};

void fill_sources(const grid::Solid& solid, const NodePairs& pairs, CornerMap& map) {
  const auto rows = rows_of(solid.complex, pairs);
  std::vector<Sources> sources(solid.complex.n_corners());
  for (const grid::Copy& copy : solid.complex.copies)
    for (unsigned v = 0; v < 8; ++v)
      for (unsigned real = 0; real < 8; ++real)
        if (copy.nodes >> real & 1)
          sources[copy.corners[v].value].offer(std::popcount(v ^ real), rows[solid.complex.node[copy.corners[real]]]);
  for (const auto& [c, node] : grid::followed_nodes(solid))
    for (const grid::CornerId corner : solid.complex.copies[c].corners)
      sources[corner.value].offer(far, rows[node]);
  for (const auto& [corner, heir] : solid.complex.lapsed)
    sources[corner.value] = sources[heir.value];
  map.source_start.push_back(0);
  for (Sources& s : sources) {
    std::sort(s.rows.begin(), s.rows.end());
    map.source.insert(map.source.end(), s.rows.begin(), s.rows.end());
    map.source_start.push_back(static_cast<std::uint32_t>(map.source.size()));
  }
}

} // namespace

NodePairs find_node_pairs(const grid::Grid& grid, const Phyxels& phyxels) {
  const double widest = *std::max_element(phyxels.support.begin(), phyxels.support.end());
  const PointGrid points(phyxels.rest, widest);
  NodePairs pairs;
  std::vector<std::uint32_t> near;
  for (const auto n : ids<grid::NodeId>(grid.n_nodes())) {
    if (!grid.is_material(n))
      continue;
    const auto row = static_cast<std::uint32_t>(pairs.nodes.size());
    pairs.nodes.push_back(n);
    pairs.rest.push_back(grid.position(n));
    points.within(pairs.rest.back(), widest, near);
    for (const auto i : near)
      if ((phyxels.rest[i] - pairs.rest.back()).norm() < phyxels.support[i]) {
        pairs.pairs.push_back({row, i});
        pairs.support.push_back(phyxels.support[i]);
      }
  }
  return pairs;
}

CornerMap build_corner_map(const grid::Solid& solid, const Phyxels& phyxels, const std::span<const grid::CopyId> copies,
                           const NodePairs& pairs, const std::span<const Sight> sights) {
  CornerMap map;
  map.rest = phyxels.rest;
  map.corners = grid::rest_positions(solid);
  fill_rows(solid, phyxels, copies, pairs, sights, map);
  fill_sources(solid, pairs, map);
  return map;
}

void follow(const CornerMap& map, const Points& x, const std::vector<Mat3>& F, Points& corners) {
  Loan<Motion> motions(x.size()), rows(map.rows.n_rows());
  for (std::size_t i = 0; i < x.size(); ++i)
    motions[i] << F[i], x[i] - F[i] * map.rest[i];
  parallel_for(
    rows.size(),
    [&](const std::size_t r) {
      rows[r].setZero();
      for (auto k = map.rows.start[r]; k < map.rows.start[r + 1]; ++k)
        rows[r] += map.rows.values[k] * motions[map.rows.columns[k]];
    },
    many_corners);
  corners.resize(map.corners.size());
  parallel_for(
    corners.size(),
    [&](const std::size_t c) {
      const auto begin = map.source_start[c], end = map.source_start[c + 1];
      Vec3 sum = Vec3::Zero();
      for (auto k = begin; k < end; ++k)
        sum += rows[map.source[k]].leftCols<3>() * map.corners[c] + rows[map.source[k]].col(3);
      corners[c] = sum / (end - begin);
    },
    many_corners);
}

std::vector<std::uint32_t> phyxel_pieces(const grid::CellComplex& complex, const std::span<const grid::CopyId> copies) {
  const grid::Pieces all = grid::pieces(complex);
  std::vector<std::uint32_t> pieces;
  for (const auto c : copies)
    pieces.push_back(all.piece[c]);
  return pieces;
}

std::vector<std::uint32_t> node_pieces(const grid::CellComplex& complex, const NodePairs& pairs) {
  const auto rows = rows_of(complex, pairs);
  const grid::Pieces all = grid::pieces(complex);
  std::vector<std::uint32_t> pieces(pairs.nodes.size(), 0);
  for (const auto c : ids<grid::CopyId>(complex.n_copies()))
    for (int v = 0; v < 8; ++v)
      if (complex.copies[c].nodes >> v & 1)
        pieces[rows[complex.node[complex.copies[c].corners[v]]]] = all.piece[c];
  return pieces;
}

void part(const std::span<const Pair> pairs, const std::span<const std::uint32_t> first_pieces,
          const std::span<const std::uint32_t> second_pieces, const std::span<Sight> sights) {
  for (std::size_t p = 0; p < pairs.size(); ++p)
    if (first_pieces[pairs[p][0]] != second_pieces[pairs[p][1]])
      sights[p].factor = 0;
}

} // namespace kerf::pba
