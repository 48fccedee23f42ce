#include "warp/fit.h"

#include "warp/minimise.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace kerf::warp {

Affine best_similarity(const std::vector<Pin>& pairs) {
  Vec2 from = Vec2::Zero(), to = Vec2::Zero();
  for (const Pin& pair : pairs) {
    from += pair.from / static_cast<double>(pairs.size());
    to += pair.to / static_cast<double>(pairs.size());
  }
  Mat2 covariance = Mat2::Zero();
  double spread = 0;
  for (const Pin& pair : pairs) {
    covariance += (pair.to - to) * (pair.from - from).transpose();
    spread += (pair.from - from).squaredNorm();
  }
  const Mat2 rotation = nearest_rotation(covariance);
  const double scale = (rotation.transpose() * covariance).trace() / spread;
  const Mat2 linear = scale * rotation;
  return {linear, to - linear * from};
}

LatticeMap fit(const std::vector<Pin>& pairs, const Vec2& lower, const Vec2& upper, const FitOptions& options) {
  const Affine start = best_similarity(pairs);
  const Vec2 size = upper - lower;
  EnergyOptions energy_options;
  energy_options.regularity = options.inside;
  energy_options.border = Border::free;
  energy_options.barrier = options.barrier;
  energy_options.pin_weight = 1;
  energy_options.pin_unit = 0.01 * (start.linear * size).norm();
  LatticeMap map = lattice_of(start, lower, upper, 2, 2);
  for (int n = std::max(2, options.n_cells / 8); n <= options.n_cells; n *= 2) {
    const auto along = [&](const double length) {
      return std::max(2, static_cast<int>(std::lround(n * length / size.maxCoeff())));
    };
    LatticeMap finer = lattice_of(map, lower, upper, along(size[0]) + 1, along(size[1]) + 1);
    if (smallest_determinant(finer, start.linear) > 0)
      map = std::move(finer);
    // A coarse lattice cannot follow the boundary and must not be crushed by trying to.
    energy_options.stiffness = options.stiffness * std::pow(options.n_cells / n, 2);
    Energy energy(map, nullptr, pairs, energy_options);
    energy.take_out(start.linear);
    Eigen::VectorXd x = to_unknowns(map);
    minimise(std::cref(energy), x, {.n_iterations = 300, .relative_fall = 1e-7});
    from_unknowns(x, map);
  }
  return map;
}

} // namespace kerf::warp
