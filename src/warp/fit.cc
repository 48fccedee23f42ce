#include "warp/fit.h"

#include "warp/minimise.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <functional>

namespace kerf::warp {

namespace {

constexpr int n_points = 256;
constexpr int finer = 4; ///< points of the second curve by one of the first

Vec2 mean_of(const Curve& curve) {
  Vec2 sum = Vec2::Zero();
  for (const Vec2& p : curve)
    sum += p;
  return sum / static_cast<double>(curve.size());
}

/// Root of the second moments about the mean: where a curve reaches, in each direction.
Mat2 spread_of(const Curve& curve) {
  const Vec2 mean = mean_of(curve);
  Mat2 sum = Mat2::Zero();
  for (const Vec2& p : curve)
    sum += (p - mean) * (p - mean).transpose();
  return Eigen::SelfAdjointEigenSolver<Mat2>(sum / static_cast<double>(curve.size())).operatorSqrt();
}

/// Two curves, and their partners under a map.
struct Matched {
  Curve from, to, partners;

  template <class Map>
  void find_partners(const Map& map) {
    Curve there;
    for (const Vec2& p : from)
      there.push_back(map(p));
    partners.clear();
    for (const int j : warp::partners(there, to))
      partners.push_back(to[j]);
  }
  std::vector<Pin> pins() const {
    std::vector<Pin> pins;
    for (std::size_t i = 0; i < from.size(); ++i)
      pins.push_back({from[i], partners[i]});
    return pins;
  }
};

/// The affine map between two curves, from moments, then point by point. One that would crush the section is not taken.
Affine affine_between(Matched& curves) {
  const Mat2 linear = spread_of(curves.to) * spread_of(curves.from).inverse();
  Affine affine{linear, mean_of(curves.to) - linear * mean_of(curves.from)};
  for (int i = 0; i < 4; ++i) {
    curves.find_partners(affine);
    const Affine next = best_affine(curves.from, curves.partners);
    if (!(next.linear.determinant() > 0.3 * linear.determinant()))
      break;
    affine = next;
  }
  return affine;
}

/// The map from a start to the least energy.
LatticeMap relaxed(const LatticeMap& start, const std::vector<Pin>& pins, const EnergyOptions& options,
                   const Mat2& global) {
  Energy energy(start, nullptr, pins, options);
  energy.take_out(global);
  Eigen::VectorXd x = to_unknowns(start);
  minimise(std::cref(energy), x, {.n_iterations = 300, .relative_fall = 1e-7});
  LatticeMap map = start;
  from_unknowns(x, map);
  return map;
}

} // namespace

Affine best_affine(const Curve& from, const Curve& to) {
  const Vec2 from_mean = mean_of(from), to_mean = mean_of(to);
  Mat2 covariance = Mat2::Zero(), spread = Mat2::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    covariance += (to[i] - to_mean) * (from[i] - from_mean).transpose();
    spread += (from[i] - from_mean) * (from[i] - from_mean).transpose();
  }
  const Mat2 linear = covariance * spread.inverse();
  return {linear, to_mean - linear * from_mean};
}

LatticeMap fit(const Curve& from, const Curve& to, const image::Grey& section, const Vec2& lower, const Vec2& upper,
               const FitOptions& options) {
  Matched curves{equally_spaced(from, n_points), equally_spaced(to, finer * n_points), {}};
  const Affine start = affine_between(curves);
  const Vec2 size = upper - lower;
  EnergyOptions energy;
  energy.regularity = options.inside;
  energy.border = Border::free;
  energy.barrier = options.barrier;
  energy.pin_weight = 1;
  energy.pin_unit = 0.01 * (start.linear * size).norm();
  energy.section = &section;
  LatticeMap map = lattice_of(start, lower, upper, 2, 2);
  for (int n = std::max(2, options.n_cells / 8); n <= options.n_cells; n *= 2) {
    const auto along = [&](const double length) {
      return std::max(2, static_cast<int>(std::lround(n * length / size.maxCoeff())));
    };
    LatticeMap denser = lattice_of(map, lower, upper, along(size[0]) + 1, along(size[1]) + 1);
    if (smallest_determinant(denser, start.linear) > 0)
      map = std::move(denser);
    // A coarse lattice cannot follow the curve and must not be crushed by trying to.
    energy.stiffness = options.stiffness * std::pow(options.n_cells / n, 2);
    map = relaxed(map, curves.pins(), energy, start.linear);
    curves.find_partners(map);
  }
  constexpr double hardest = 30;
  for (int round = 1; round <= options.n_rounds; ++round) {
    energy.pin_weight = std::pow(hardest, static_cast<double>(round) / options.n_rounds);
    map = relaxed(map, curves.pins(), energy, start.linear);
    curves.find_partners(map);
  }
  return map;
}

} // namespace kerf::warp
