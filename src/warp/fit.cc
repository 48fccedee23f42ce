#include "warp/fit.h"

#include "warp/minimise.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <functional>

namespace kerf::warp {

namespace {

template <class Map>
Curve images(const Curve& curve, const Map& map) {
  Curve result;
  for (const Vec2& p : curve)
    result.push_back(map(p));
  return result;
}

/// The same curve from the point farthest from the middle of what it bounds: the same however a picture is stored.
Curve from_farthest(Curve curve) {
  const Vec2 middle = moments_of(curve).mean;
  const auto farther = [&](const Vec2& a, const Vec2& b) { return (a - middle).norm() < (b - middle).norm(); };
  std::rotate(curve.begin(), std::max_element(curve.begin(), curve.end(), farther), curve.end());
  return curve;
}

/// The point at a real number of points along a closed curve.
Vec2 at(const Curve& curve, const double number) {
  const auto n = static_cast<double>(curve.size());
  const double place = number - n * std::floor(number / n);
  const auto i = std::min(static_cast<std::size_t>(place), curve.size() - 1);
  return curve[i] + (place - static_cast<double>(i)) * (curve[(i + 1) % curve.size()] - curve[i]);
}

/// Numbers of partners once around, of m points, as means over some neighbours: so steps from one point to the next,
/// and which of two as good ones round-off has taken, do not count.
std::vector<double> smoothed(const std::vector<int>& partners, const int m) {
  constexpr int n_rounds = 4;
  const std::size_t n = partners.size();
  std::vector<double> result(partners.begin(), partners.end());
  for (std::size_t i = 1; i < n; ++i) // once around: they only grow
    while (result[i] < result[i - 1] - 0.5)
      result[i] += m;
  for (int round = 0; round < n_rounds; ++round) {
    const std::vector<double> before = result;
    for (std::size_t i = 0; i < n; ++i)
      result[i] = 0.5 * before[i] +
                  0.25 * ((i > 0 ? before[i - 1] : before[n - 1] - m) + (i + 1 < n ? before[i + 1] : before[0] + m));
  }
  return result;
}

/// What goes where, asked anew as a map comes closer.
using PinsOf = std::function<std::vector<Pin>(const LatticeMap&)>;

EnergyOptions energy_options(const FitOptions& options, const Affine& start, const Vec2& size) {
  EnergyOptions energy;
  energy.regularity = options.inside;
  energy.border = Border::free;
  energy.barrier = options.barrier;
  energy.pin_weight = 1;
  energy.pin_unit = 0.01 * (start.linear * size).norm();
  return energy;
}

/// `map` becomes that of least energy.
void relax(LatticeMap& map, const PinsOf& pins, const EnergyOptions& options, const Mat2& global) {
  Energy energy(map, nullptr, pins(map), options);
  energy.take_out(global);
  Eigen::VectorXd x = to_unknowns(map);
  minimise(std::cref(energy), x, {.n_iterations = 300, .relative_fall = 1e-7});
  from_unknowns(x, map);
}

LatticeMap coarse_to_fine(const Affine& start, const PinsOf& pins, const Vec2& lower, const Vec2& upper,
                          const FitOptions& options, EnergyOptions energy) {
  const Vec2 size = upper - lower;
  LatticeMap map = lattice_of(start, lower, upper, 2, 2);
  for (int n = std::max(2, options.n_cells / 8); n <= options.n_cells; n *= 2) {
    const auto along = [&](const double length) {
      return std::max(2, static_cast<int>(std::lround(n * length / size.maxCoeff())));
    };
    LatticeMap finer = lattice_of(map, lower, upper, along(size[0]) + 1, along(size[1]) + 1);
    if (smallest_determinant(finer, start.linear) > 0)
      map = std::move(finer);
    // A coarse lattice cannot follow the boundary and must not be crushed by trying to.
    energy.stiffness = options.stiffness * std::pow(options.n_cells / n, 2);
    relax(map, pins, energy, start.linear);
  }
  return map;
}

} // namespace

Affine affine_between(const Curve& from, const Curve& to) {
  const Moments a = moments_of(from), b = moments_of(to);
  const Eigen::SelfAdjointEigenSolver<Mat2> spread(a.spread);
  const Mat2 root = spread.operatorSqrt(), back = spread.operatorInverseSqrt();
  const Mat2 linear = back * Eigen::SelfAdjointEigenSolver<Mat2>(root * b.spread * root).operatorSqrt() * back;
  return {linear, b.mean - linear * a.mean};
}

LatticeMap fit(const std::vector<Pin>& pairs, const Affine& start, const Vec2& lower, const Vec2& upper,
               const FitOptions& options) {
  const auto pins = [&](const LatticeMap&) { return pairs; };
  return coarse_to_fine(start, pins, lower, upper, options, energy_options(options, start, upper - lower));
}

LatticeMap fit(const Curve& from, const Curve& to, const image::Grey& section, const Vec2& lower, const Vec2& upper,
               const FitOptions& options) {
  constexpr int n_points = 512, denser = 4;
  constexpr double softer = 0.3, hardest = 10; // what is no star has more to bend
  constexpr int n_rounds = 3;
  const Affine start = affine_between(from, to);
  // At equal steps where they lie beside each other, so that an affine map changes no pace.
  const Curve points = images(equally_spaced(from_farthest(images(from, start)), n_points), start.inverse());
  const Curve targets = equally_spaced(from_farthest(to), denser * n_points);
  const auto pins = [&](const LatticeMap& map) {
    std::vector<Pin> result;
    const std::vector<double> found = smoothed(partners(images(points, map), targets), denser * n_points);
    for (int i = 0; i < n_points; ++i)
      result.push_back({points[i], at(targets, found[i])});
    return result;
  };
  FitOptions soft = options;
  soft.stiffness *= softer;
  EnergyOptions energy = energy_options(soft, start, upper - lower);
  energy.section = &section;
  LatticeMap map = coarse_to_fine(start, pins, lower, upper, soft, energy);
  energy.stiffness = soft.stiffness;
  for (int round = 1; round <= n_rounds; ++round) {
    energy.pin_weight = std::pow(hardest, static_cast<double>(round) / n_rounds);
    relax(map, pins, energy, start.linear);
  }
  return map;
}

} // namespace kerf::warp
