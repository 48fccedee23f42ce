#include "lattice/matching.h"

#include "base/error.h"
#include "base/loan.h"
#include "base/parallel.h"
#include "base/parameters.h"
#include "lattice/kernels.h"
#include "material/polar.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace kerf::lattice {

namespace {

/// A second thread pays from about this many corners or regions on, and blocks of eight regions.
constexpr std::size_t worth_items = 4096, worth_blocks = 128;
constexpr std::size_t block_size = 8;

Eigen::Map<Vec3> vector(double* const p) { return Eigen::Map<Vec3>(p); }
Eigen::Map<const Vec3> vector(const double* const p) { return Eigen::Map<const Vec3>(p); }
Eigen::Map<Mat3> matrix(double* const p) { return Eigen::Map<Mat3>(p); }

void require_positive(const std::string& path, const double value) {
  if (!positive.contains(value))
    throw ParameterError({.path = path, .value = to_text(value), .rule = positive.rule()});
}

Vec3 mean(const Points& x) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : x)
    sum += p;
  return sum / static_cast<double>(x.size());
}

/// The angular velocity of a body with angular momentum L, whose sum of m x x^T from its centre is J. None about a line
/// on which all of it lies: there L is zero as well.
Vec3 angular_velocity(const Mat3& J, const Vec3& L) {
  const Mat3 inertia = J.trace() * Mat3::Identity() - J;
  constexpr double well_conditioned = 1e-6, nothing = 1e-12;
  const double size = inertia.trace();
  Vec3 omega = Vec3::Zero();
  if (!(size > 0)) // a point; round-off may have turned its sign
    return omega;
  if (inertia.determinant() > well_conditioned * size * size * size)
    return inertia.inverse() * L;
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(inertia);
  for (int i = 0; i < 3; ++i)
    if (solver.eigenvalues()[i] > nothing * size)
      omega += solver.eigenvectors().col(i).dot(L) / solver.eigenvalues()[i] * solver.eigenvectors().col(i);
  return omega;
}

} // namespace

Matching::Matching(const grid::Solid& solid, const MatchingOptions& options)
  : stiffness_(options.stiffness),
    numbers_(solid, options.counted),
    lines_(solid, options.half_width),
    mass_(numbers_.size(), 0.0) {
  numbers_.gather(grid::rest_positions(solid), rest_);
  require_positive("Density [kg/m^3]", options.density);
  require_positive("Stiffness [1/s^2]", options.stiffness);
  const Vec3 middle = mean(rest_);
  for (Vec3& X : rest_)
    X -= middle;
  count_shares(material_shares(solid, options.density));
  measure_regions();
  const double h = solid.grid.h();
  std::vector<double> mass_by_corner(solid.complex.n_corners(), 0.0);
  numbers_.spread(mass_, mass_by_corner);
  riders_ = Riders(solid.complex, mass_by_corner, options.density * h * h * h);
  riders_.count_by(numbers_);
}

void Matching::count_shares(const std::vector<Share>& shares) {
  std::vector<double> holders(6 * lines_.n_points(), 1.0);
  lines_.sum_over_holders(holders); // N_n, six times
  for (const Share& share : shares)
    mass_[numbers_[share.corner.value]] += share.mass;

  of_corners_.start.assign(mass_.size() + 1, 0);
  std::size_t k = 0;
  for (std::size_t p = 0; p < lines_.n_points(); ++p) {
    for (; k < shares.size() && shares[k].node == lines_.nodes()[p]; ++k) {
      const auto corner = numbers_[shares[k].corner.value];
      of_points_.add_entry(corner, shares[k].mass / holders[6 * p]);
      ++of_corners_.start[corner + 1];
    }
    of_points_.end_row();
  }
  for (std::size_t c = 0; c < mass_.size(); ++c)
    of_corners_.start[c + 1] += of_corners_.start[c];

  std::vector<std::uint32_t> next(of_corners_.start.begin(), of_corners_.start.end() - 1);
  of_corners_.columns.resize(of_points_.columns.size());
  of_corners_.values.resize(of_points_.columns.size());
  for (std::uint32_t p = 0; p < lines_.n_points(); ++p)
    for (auto i = of_points_.start[p]; i < of_points_.start[p + 1]; ++i) {
      const auto c = of_points_.columns[i];
      of_corners_.columns[next[c]] = p;
      of_corners_.values[next[c]++] = of_points_.values[i] / mass_[c];
    }
}

void Matching::measure_regions() {
  corner_field_.assign(6 * mass_.size(), 0.0);
  for (std::size_t c = 0; c < mass_.size(); ++c) {
    corner_field_[6 * c] = 1;
    vector(&corner_field_[6 * c + 1]) = rest_[c];
    corner_field_[6 * c + 4] = rest_[c].squaredNorm();
  }
  sum_over_regions();
  for (std::size_t r = 0; r < lines_.n_points(); ++r) {
    const double* const sums = &region_field_[6 * r];
    const Vec3 centre = vector(&region_field_[6 * r + 1]) / sums[0];
    regions_.push_back({sums[0], centre, sums[4] - sums[0] * centre.squaredNorm()});
  }
}

void Matching::sum_over_regions() const {
  if (lines_.n_points() == 0)
    return;
  const std::size_t width = corner_field_.size() / mass_.size();
  region_field_.resize(width * lines_.n_points());
  parallel_ranges(lines_.n_points(), worth_items, [&](const std::size_t first, const std::size_t last) {
    weighted_sums({first, last, of_points_.start.data(), of_points_.columns.data(), of_points_.values.data()}, width,
                  corner_field_.data(), region_field_.data());
  });
  lines_.sum_over_regions(region_field_);
}

void Matching::average_over_regions() const {
  if (lines_.n_points() == 0) {
    corner_field_.assign(corner_field_.size(), 0.0);
    return;
  }
  const std::size_t width = region_field_.size() / lines_.n_points();
  corner_field_.resize(width * mass_.size());
  lines_.sum_over_holders(region_field_);
  parallel_ranges(mass_.size(), worth_items, [&](const std::size_t first, const std::size_t last) {
    weighted_sums({first, last, of_corners_.start.data(), of_corners_.columns.data(), of_corners_.values.data()}, width,
                  region_field_.data(), corner_field_.data());
  });
}

double Matching::match(const Points& x, const Vec3& centre) const {
  corner_field_.resize(12 * mass_.size());
  parallel_for(
    mass_.size(),
    [&](const std::size_t c) {
      const Vec3 p = x[c] - centre;
      vector(&corner_field_[12 * c]) = p;
      matrix(&corner_field_[12 * c + 3]) = p * rest_[c].transpose();
    },
    worth_items);
  sum_over_regions();
  const std::size_t n_blocks = (regions_.size() + block_size - 1) / block_size;
  Loan<double> residuals(n_blocks);
  parallel_for(
    n_blocks,
    [&](const std::size_t b) {
      residuals[b] = match_block(b * block_size, std::min(block_size, regions_.size() - b * block_size));
    },
    worth_blocks);
  double residual = 0;
  for (std::size_t c = 0; c < mass_.size(); ++c)
    residual += mass_[c] * (x[c] - centre).squaredNorm();
  for (const double of_block : residuals)
    residual += of_block;
  return residual;
}

double Matching::match_block(const std::size_t first, const std::size_t n) const {
  double* const field = &region_field_[12 * first];
  std::array<Mat3, block_size> covariance;
  for (std::size_t i = 0; i < n; ++i) {
    const Region& region = regions_[first + i];
    const Vec3 first_moment = vector(field + 12 * i);
    auto A = matrix(field + 12 * i + 3);
    A -= first_moment * region.centre.transpose();
    covariance[i] = A;
  }
  const unsigned difficult = rotate_in_place(n, field + 3);
  double residual = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Region& region = regions_[first + i];
    auto R = matrix(field + 12 * i + 3);
    if ((difficult >> i & 1) != 0 && covariance[i].allFinite())
      R = material::rotation_of(covariance[i]);
    auto shift = vector(field + 12 * i);
    const Vec3 centre = shift / region.mass;
    residual += region.extent - region.mass * centre.squaredNorm() - 2 * R.cwiseProduct(covariance[i]).sum();
    shift = centre - R * region.centre;
  }
  return residual;
}

double Matching::energy(const Points& x) const { return std::max(0.0, 0.5 * stiffness_ * match(x, mean(x))); }

void Matching::goals(const Points& x, Points& g) const {
  const Vec3 centre = mean(x);
  match(x, centre);
  average_over_regions();
  g.resize(x.size());
  parallel_for(
    x.size(),
    [&](const std::size_t c) {
      g[c] = centre + vector(&corner_field_[12 * c]) + matrix(&corner_field_[12 * c + 3]) * rest_[c];
    },
    worth_items);
}

void Matching::force(const Points& x, Points& forces) const {
  goals(x, forces);
  parallel_for(
    x.size(), [&](const std::size_t c) { forces[c] = stiffness_ * mass_[c] * (forces[c] - x[c]); }, worth_items);
}

void Matching::spread_over_regions(std::vector<std::uint8_t>& is_marked) const {
  corner_field_.assign(6 * mass_.size(), 0.0);
  for (std::size_t c = 0; c < mass_.size(); ++c)
    corner_field_[6 * c] = is_marked[c];
  sum_over_regions();
  average_over_regions();
  for (std::size_t c = 0; c < mass_.size(); ++c)
    is_marked[c] = corner_field_[6 * c] > 0 ? 1 : is_marked[c];
}

void Matching::sum_moments(const Points& x, const Points& v, const Vec3& centre) const {
  corner_field_.resize(12 * x.size());
  parallel_for(
    x.size(),
    [&](const std::size_t c) {
      const Vec3 p = x[c] - centre;
      double* const field = &corner_field_[12 * c];
      vector(field) = p;
      vector(field + 3) = p[0] * p;
      vector(field + 6) = Vec3(p[1] * p[1], p[1] * p[2], p[2] * p[2]);
      vector(field + 9) = v[c];
    },
    worth_items);
  sum_over_regions();
}

void Matching::sum_angular_momentum(const Points& x, const Points& v, const Vec3& centre) const {
  corner_field_.resize(6 * x.size());
  parallel_for(
    x.size(),
    [&](const std::size_t c) {
      vector(&corner_field_[6 * c]) = (x[c] - centre).cross(v[c]);
      vector(&corner_field_[6 * c + 3]).setZero();
    },
    worth_items);
  sum_over_regions();
}

void Matching::rigid_velocities(const Points& x, const Points& v, Points& u) const {
  const Vec3 centre = mean(x);
  sum_moments(x, v, centre);
  const Loan<double> moments(region_field_);
  sum_angular_momentum(x, v, centre);
  parallel_for(
    regions_.size(),
    [&](const std::size_t r) {
      const double *const m = &moments[12 * r], mass = regions_[r].mass;
      const Vec3 x_r = vector(m) / mass, momentum = vector(m + 9);
      Mat3 J;
      J << m[3], m[4], m[5], m[4], m[6], m[7], m[5], m[7], m[8];
      J -= mass * x_r * x_r.transpose();
      auto shift = vector(&region_field_[6 * r]), omega = vector(&region_field_[6 * r + 3]);
      omega = angular_velocity(J, shift - x_r.cross(momentum));
      shift = momentum / mass - omega.cross(x_r);
    },
    worth_items);
  average_over_regions();
  u.resize(x.size());
  parallel_for(
    x.size(),
    [&](const std::size_t c) {
      const auto shift = vector(&corner_field_[6 * c]), omega = vector(&corner_field_[6 * c + 3]);
      u[c] = shift + omega.cross(x[c] - centre);
    },
    worth_items);
}

} // namespace kerf::lattice
