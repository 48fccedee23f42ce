#include "spring/inversion.h"

#include "base/parallel.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace kerf::spring {

namespace {

constexpr double least_volume = 0.5; // J_0
constexpr std::size_t worth = 4096;  // copies from which on a second thread pays

/// h times the gradient of corner v's shape function in the middle of the cube.
Vec3 slope(const int v) { return 0.25 * Vec3((v & 1) != 0 ? 1 : -1, (v & 2) != 0 ? 1 : -1, (v & 4) != 0 ? 1 : -1); }

/// Derivatives of det F by F.
Mat3 cofactors(const Mat3& F) {
  Mat3 cof;
  cof << F.col(1).cross(F.col(2)), F.col(2).cross(F.col(0)), F.col(0).cross(F.col(1));
  return cof;
}

/// Second derivatives of det F by the places of two corners with these gradients of their shape functions.
Mat3 second_derivative(const Mat3& F, const Vec3& a, const Vec3& b) {
  const Vec3 w = F * a.cross(b); // sum of a_k b_l e_klm f_m
  return -cross_matrix(w);
}

} // namespace

Inversion::Inversion(const grid::Solid& solid, const grid::CornerNumbers& numbers, const std::span<const double> fill,
                     const double youngs_modulus)
  : h_(solid.grid.h()) {
  for (const auto c : ids<grid::CopyId>(solid.complex.n_copies())) {
    if (fill[c.value] == 0)
      continue;
    Cube cube{.corners = {}, .strength = youngs_modulus * fill[c.value] * h_ * h_ * h_};
    std::ranges::transform(solid.complex.copies[c].corners, cube.corners.begin(),
                           [&](const grid::CornerId corner) { return numbers[corner.value]; });
    cubes_.push_back(cube);
  }
}

Mat3 Inversion::mean_gradient(const Cube& cube, const Points& x) const {
  Mat3 F = Mat3::Zero();
  for (int v = 0; v < 8; ++v)
    F += x[cube.corners[v]] * slope(v).transpose();
  return F / h_;
}

std::array<Vec3, 8> Inversion::gradient_of_volume(const Mat3& F) const {
  const Mat3 cof = cofactors(F) / h_;
  std::array<Vec3, 8> gradient;
  for (int v = 0; v < 8; ++v)
    gradient[v] = cof * slope(v);
  return gradient;
}

Loan<double> Inversion::volumes(const Points& x) const {
  Loan<double> J(cubes_.size(), AnyValues());
  parallel_for(
    J.size(), [&](const std::size_t c) { J[c] = mean_gradient(cubes_[c], x).determinant(); }, worth);
  return J;
}

double Inversion::energy(const Points& x) const {
  Loan<double> sum(1, 0);
  add_energies(x, dynamics::Pieces(), sum);
  return sum[0];
}

void Inversion::add_energies(const Points& x, const dynamics::Pieces& pieces, const std::span<double> sums) const {
  const Loan<double> J = volumes(x);
  for (std::size_t c = 0; c < J.size(); ++c)
    if (J[c] < least_volume)
      sums[pieces.of(cubes_[c].corners[0])] +=
        0.5 * cubes_[c].strength * (least_volume - J[c]) * (least_volume - J[c]);
}

void Inversion::add_force(const Points& x, Points& forces) const {
  const Loan<double> J = volumes(x);
  for (std::size_t c = 0; c < J.size(); ++c) {
    if (!(J[c] < least_volume))
      continue;
    const auto gradient = gradient_of_volume(mean_gradient(cubes_[c], x));
    for (int v = 0; v < 8; ++v)
      forces[cubes_[c].corners[v]] += cubes_[c].strength * (least_volume - J[c]) * gradient[v];
  }
}

void Inversion::linearise(const Points& x) {
  const Loan<double> J = volumes(x);
  squashed_.clear();
  for (std::size_t c = 0; c < J.size(); ++c)
    if (J[c] < least_volume)
      squashed_.push_back({&cubes_[c], gradient_of_volume(mean_gradient(cubes_[c], x))});
}

void Inversion::add_product(const std::span<const double> p, const std::span<double> y) const {
  for (const auto& [cube, gradient] : squashed_) {
    double along = 0;
    for (int v = 0; v < 8; ++v)
      along += gradient[v].dot(Eigen::Map<const Vec3>(p.data() + 3 * std::size_t(cube->corners[v])));
    for (int v = 0; v < 8; ++v)
      Eigen::Map<Vec3>(y.data() + 3 * std::size_t(cube->corners[v])) += cube->strength * along * gradient[v];
  }
}

void Inversion::add_diagonal(std::vector<Mat3>& blocks) const {
  for (const auto& [cube, gradient] : squashed_)
    for (int v = 0; v < 8; ++v)
      blocks[cube->corners[v]] += cube->strength * gradient[v] * gradient[v].transpose();
}

void Inversion::add_entries(const Points& x, const dynamics::Tangent kind,
                            std::vector<Eigen::Triplet<double>>& entries) const {
  const Loan<double> J = volumes(x);
  for (std::size_t c = 0; c < J.size(); ++c) {
    if (!(J[c] < least_volume))
      continue;
    const Cube& cube = cubes_[c];
    const Mat3 F = mean_gradient(cube, x);
    const auto gradient = gradient_of_volume(F);
    for (int a = 0; a < 8; ++a)
      for (int b = 0; b < 8; ++b) {
        Mat3 block = gradient[a] * gradient[b].transpose();
        if (kind != dynamics::Tangent::positive)
          block -= (least_volume - J[c]) * second_derivative(F, slope(a), slope(b)) / (h_ * h_);
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j)
            entries.emplace_back(static_cast<int>(3 * cube.corners[a] + i), static_cast<int>(3 * cube.corners[b] + j),
                                 cube.strength * block(i, j));
      }
  }
}

} // namespace kerf::spring
