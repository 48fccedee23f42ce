#include "fem/fields.h"

#include "base/parallel.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace kerf::fem {

namespace {

constexpr std::size_t many_copies = 256;

/// The copies that hold a corner, ascending; with all around those too, if `rings` is 2.
std::vector<std::uint32_t> patch(const Incidence& incidence, const std::size_t corner, const int rings) {
  std::vector<std::uint32_t> copies;
  const auto add_users = [&](const std::size_t c) {
    for (const auto user : incidence.users(c))
      copies.push_back(user / 8);
  };
  add_users(corner);
  if (rings == 2)
    for (std::size_t i = 0, n = copies.size(); i < n; ++i)
      for (int a = 0; a < 8; ++a)
        add_users(incidence.corners(copies[i])[a]);
  std::sort(copies.begin(), copies.end());
  copies.erase(std::unique(copies.begin(), copies.end()), copies.end());
  return copies;
}

/// Where the copies of a patch lie, weighted by volume; lengths in cube edges.
struct Spread {
  double volume = 0;
  Vec3 mean = Vec3::Zero();
  Eigen::SelfAdjointEigenSolver<Mat3> variance; ///< of the position
  std::vector<Vec3> positions;
};

Spread spread_of(const Hexahedra& model, const Points& rest, const std::vector<std::uint32_t>& copies) {
  Spread spread;
  for (const auto copy : copies) {
    const Element& element = model.element(copy);
    spread.positions.push_back(rest[model.incidence().corners(copy)[0]] / model.h() + element.centroid);
    spread.volume += element.volume;
    spread.mean += element.volume * spread.positions.back();
  }
  spread.mean /= spread.volume;
  Mat3 sum = Mat3::Zero();
  for (std::size_t i = 0; i < copies.size(); ++i) {
    const Vec3 d = spread.positions[i] - spread.mean;
    sum += model.element(copies[i]).volume / spread.volume * d * d.transpose();
  }
  spread.variance.compute(sum);
  return spread;
}

constexpr double least_variance = 0.02; // of half a cube's distance 0.25; a direction of less has no slope

Mat3 fitted(const Hexahedra& model, const std::vector<std::uint32_t>& copies, const Spread& spread,
            const std::vector<Mat3>& values, const Vec3& position) {
  // The fit's value is a mean with weights w (1 + d^T C^-1 (x - mean)), C the variance.
  Vec3 inverse;
  for (int i = 0; i < 3; ++i)
    inverse[i] = spread.variance.eigenvalues()[i] > least_variance ? 1 / spread.variance.eigenvalues()[i] : 0;
  const Mat3& V = spread.variance.eigenvectors();
  const Vec3 direction = V * inverse.asDiagonal() * V.transpose() * (position - spread.mean);
  Mat3 sum = Mat3::Zero();
  for (std::size_t i = 0; i < copies.size(); ++i) {
    const double weight = model.element(copies[i]).volume / spread.volume;
    sum += weight * (1 + direction.dot(spread.positions[i] - spread.mean)) * values[copies[i]];
  }
  return sum;
}

template <class Function>
std::vector<Mat3> of_copies(const Hexahedra& model, const Points& x, const Function& f) {
  std::vector<Mat3> values(model.n_elements());
  parallel_for(
    values.size(),
    [&](const std::size_t c) {
      values[c] = model.incidence().is_used(c) ? Mat3(f(model.deformation_gradient(c, x))) : Mat3(Mat3::Zero());
    },
    many_copies);
  return values;
}

} // namespace

std::vector<Mat3> strain_of_copies(const Hexahedra& model, const Points& x) {
  const bool is_small = std::holds_alternative<material::SmallStrain>(model.law());
  return of_copies(model, x, [&](const Mat3& F) {
    return is_small ? Mat3(0.5 * (F + F.transpose()) - Mat3::Identity())
                    : Mat3(0.5 * (F.transpose() * F - Mat3::Identity()));
  });
}

std::vector<Mat3> stress_of_copies(const Hexahedra& model, const Points& x) {
  return of_copies(model, x, [&](const Mat3& F) { return material::cauchy_stress(model.law(), F); });
}

std::vector<Mat3> at_corners(const Hexahedra& model, const Points& rest, const std::vector<Mat3>& of_copies) {
  std::vector<Mat3> values(rest.size());
  parallel_for(
    values.size(),
    [&](const std::size_t corner) {
      auto copies = patch(model.incidence(), corner, 1);
      if (copies.empty()) { // a rigid crumb's
        values[corner].setZero();
        return;
      }
      Spread spread = spread_of(model, rest, copies);
      if (spread.variance.eigenvalues()[0] < least_variance) {
        copies = patch(model.incidence(), corner, 2);
        spread = spread_of(model, rest, copies);
      }
      values[corner] = fitted(model, copies, spread, of_copies, rest[corner] / model.h());
    },
    many_copies);
  return values;
}

double von_mises(const Mat3& stress) {
  const Mat3 deviator = stress - stress.trace() / 3 * Mat3::Identity();
  return std::sqrt(1.5) * deviator.norm();
}

} // namespace kerf::fem
