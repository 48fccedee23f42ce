#include "fem/clusters.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace kerf::fem {

namespace {

constexpr std::uint32_t no_place = CellsOfLevel::unused;

/// Groups of corners, up to some each, that rows join: one of two joins both; one of four or eight what of its corners
/// is alone, to each other where these are two, one to the others: so corners beyond a body's own edges, which no row
/// of two knows, belong to somebody.
std::vector<std::vector<std::uint32_t>> joined(const SparseRows<float>& rows, const std::size_t n_corners,
                                               const std::size_t most) {
  std::vector<std::vector<std::uint32_t>> groups;
  std::vector<std::uint32_t> of(n_corners, no_place);
  const auto group_of = [&](const std::uint32_t corner) {
    if (of[corner] == no_place) {
      of[corner] = static_cast<std::uint32_t>(groups.size());
      groups.push_back({corner});
    }
    return of[corner];
  };
  const auto join = [&](const std::uint32_t one, const std::uint32_t other) {
    const std::uint32_t a = group_of(one), b = group_of(other);
    if (a == b || groups[a].size() + groups[b].size() > most)
      return;
    for (const std::uint32_t corner : groups[b])
      of[corner] = a;
    groups[a].insert(groups[a].end(), groups[b].begin(), groups[b].end());
    groups[b].clear();
  };
  std::vector<std::uint32_t> alone;
  for (const std::size_t n : {2u, 4u, 8u})
    for (std::size_t i = 0; i < rows.n_rows(); ++i) {
      if (rows.start[i + 1] - rows.start[i] != n)
        continue;
      alone.clear();
      for (std::uint32_t k = rows.start[i]; k < rows.start[i + 1]; ++k)
        if (n == 2 || groups[group_of(rows.columns[k])].size() == 1)
          alone.push_back(rows.columns[k]);
      if (alone.size() == 2)
        join(alone[0], alone[1]);
      for (std::uint32_t k = rows.start[i]; k < rows.start[i + 1] && alone.size() == 1; ++k)
        join(rows.columns[k], alone[0]); // the first with room
    }
  return groups;
}

} // namespace

PointSprings coarsened(const PointSprings& fine, const Coarsening& coarsening) {
  PointSprings coarse{{}, fine.blocks};
  std::vector<std::uint32_t> place(coarsening.coarse.n_corners, no_place);
  SparseRows<float>& rows = coarse.rows;
  for (std::size_t i = 0; i < fine.blocks.size(); ++i) {
    for (std::uint32_t k = fine.rows.start[i]; k < fine.rows.start[i + 1]; ++k) {
      coarsening.for_each_weight(fine.rows.columns[k], [&](const std::uint32_t corner, const float weight) {
        std::uint32_t& p = place[corner];
        if (p == no_place) {
          p = static_cast<std::uint32_t>(rows.columns.size());
          rows.add_entry(corner, 0);
        }
        rows.values[p] += fine.rows.values[k] * weight;
      });
    }
    for (std::size_t k = rows.start.back(); k < rows.columns.size(); ++k)
      place[rows.columns[k]] = no_place;
    rows.end_row();
  }
  return coarse;
}

Clusters::Clusters(const PointSprings& points, const std::size_t n_corners) {
  if (points.empty())
    return;
  const auto groups = joined(points.rows, n_corners, most);
  place_.resize(n_corners);
  for (const auto& group : groups) {
    if (group.size() < 2)
      continue;
    const auto n = static_cast<Eigen::Index>(3 * group.size());
    for (int i = 0; i < static_cast<int>(group.size()); ++i)
      place_[group[i]] = {static_cast<std::uint32_t>(clusters_.size()), i};
    clusters_.push_back({group, Eigen::MatrixXd::Zero(n, n), {}});
  }
}

void Clusters::add_bound(const PointSprings& points,
                         const std::function<void(std::uint32_t corner, const Mat3& block)>& add) {
  struct Entry {
    Place place;
    std::uint32_t corner;
    double weight;
  };
  std::vector<Entry> entries;
  for (std::size_t i = 0; i < points.blocks.size(); ++i) {
    const Mat3 block = points.blocks[i].cast<double>();
    entries.clear();
    double sum = 0;
    for (std::uint32_t k = points.rows.start[i]; k < points.rows.start[i + 1]; ++k) {
      const std::uint32_t corner = points.rows.columns[k];
      entries.push_back({place_[corner], corner, double(points.rows.values[k])});
      sum += std::abs(entries.back().weight);
    }
    for (const Entry& a : entries) {
      if (a.place.cluster == no_place) {
        add(a.corner, sum * std::abs(a.weight) * block);
        continue;
      }
      double of_group = 0;
      for (const Entry& b : entries)
        of_group += b.place.cluster == a.place.cluster ? std::abs(b.weight) : 0;
      for (const Entry& b : entries)
        if (b.place.cluster == a.place.cluster && of_group > 0)
          clusters_[a.place.cluster].block.block<3, 3>(3 * a.place.index, 3 * b.place.index) +=
            sum / of_group * a.weight * b.weight * block;
    }
  }
}

void Clusters::invert(const std::function<Mat3(std::uint32_t corner)>& block,
                      const std::function<Mat3(std::uint32_t corner)>& project) {
  for (Cluster& one : clusters_) {
    const auto n = static_cast<Eigen::Index>(3 * one.corners.size());
    Eigen::MatrixXd P = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t i = 0; i < one.corners.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(3 * i);
      one.block.block<3, 3>(at, at) += block(one.corners[i]);
      P.block<3, 3>(at, at) = project(one.corners[i]);
    }
    const double size = one.block.trace() / double(n);
    const Eigen::MatrixXd held = Eigen::MatrixXd::Identity(n, n) - P;
    constexpr double unseen = 1e-7; // in single precision: a block that is singular stays bounded
    const Eigen::MatrixXd regular = P * one.block * P + size * (held + unseen * Eigen::MatrixXd::Identity(n, n));
    const Eigen::MatrixXd inverse = size > 0 ? Eigen::MatrixXd(regular.llt().solve(P)) : Eigen::MatrixXd::Zero(n, n);
    one.inverse = (0.5 * (P * inverse + (P * inverse).transpose())).cast<float>();
    one.block.setZero();
  }
}

} // namespace kerf::fem
