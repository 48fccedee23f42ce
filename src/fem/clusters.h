#pragma once

/// Springs at points that follow corners, and the blocks of Jacobi's matrix for corners that they join.

#include "base/sparse_rows.h"
#include "fem/coarsening.h"

#include <functional>
#include <vector>

namespace kerf::fem {

/// The square of w u in the measure of a block, for a row w of weights.
struct PointSprings {
  SparseRows<float> rows;
  std::vector<Eigen::Matrix3f> blocks; ///< one a row, over the stiffness factor [N/m]

  bool empty() const { return blocks.empty(); }
};
/// For motions of coarse cubes.
PointSprings coarsened(const PointSprings& fine, const Coarsening& coarsening);

/// Corners at both ends of edges that springs hold between them, a few together: opposite motions of the two ends meet
/// no spring, but blocks of one corner each, which have to bound it.
class Clusters {
 public:
  Clusters() = default;
  /// Joins the corners of rows of two.
  Clusters(const PointSprings& points, std::size_t n_corners);

  bool empty() const { return clusters_.empty(); }

  /// Adds what bounds springs, |sum w_k u_k|^2 <= sum |w_l| sum over groups g of |sum over g of w_k u_k|^2 / |w|_g: of
  /// clusters to their own blocks, of corners that are in none by `add`.
  void add_bound(const PointSprings& points, const std::function<void(std::uint32_t corner, const Mat3& block)>& add);
  /// With the blocks of their corners beside, and these corners' projectors onto the directions that are free.
  void invert(const std::function<Mat3(std::uint32_t corner)>& block,
              const std::function<Mat3(std::uint32_t corner)>& project);

  /// Calls f(corner, v) with v = D^-1 r, for r = of(corner).
  template <class Of, class Function>
  void for_each(const Of& of, const Function& f) const {
    Eigen::Matrix<float, 3 * most, 1> r, v;
    for (const Cluster& one : clusters_) {
      const auto n = static_cast<int>(one.corners.size());
      for (int i = 0; i < n; ++i)
        r.segment<3>(3 * i) = of(one.corners[i]);
      v.head(3 * n).noalias() = one.inverse * r.head(3 * n);
      for (int i = 0; i < n; ++i)
        f(one.corners[i], Eigen::Vector3f(v.segment<3>(3 * i)));
    }
  }

 private:
  static constexpr int most = 8; ///< corners
  struct Cluster {
    std::vector<std::uint32_t> corners;
    Eigen::MatrixXd block;
    Eigen::MatrixXf inverse;
  };
  struct Place {
    std::uint32_t cluster = CellsOfLevel::unused;
    int index = 0;
  };
  std::vector<Cluster> clusters_;
  std::vector<Place> place_; // of each corner; empty without clusters
};

} // namespace kerf::fem
