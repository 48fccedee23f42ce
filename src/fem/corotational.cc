#include "fem/corotational.h"

#include "base/parallel.h"
#include "fem/kernels.h"
#include "material/polar.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>

namespace kerf::fem {

namespace {

/// A second thread pays from about this many elements (1 us each) and corners (0.1 us each) on.
constexpr std::size_t worth_elements = 256, worth_corners = 4096;

Vec3 vertex_offset(const int a) { return Vec3(a & 1, a >> 1 & 1, a >> 2 & 1); }

bool is_full(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellComplex& complex, const grid::CopyId c) {
  const grid::Copy& copy = complex.copies[c];
  return copy.nodes == 0xff || (cuts.configuration(grid, copy.cell) == 0);
}

} // namespace

Corotational::Corotational(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellComplex& complex,
                           const CorotationalOptions& options)
  : h_(grid.h()), element_of_(complex.n_copies(), 0), mass_(complex.n_corners(), 0.0) {
  const std::size_t n = complex.n_copies();
  std::vector<grid::CopyId> partial;
  if (options.integration == Integration::octants)
    for (const auto c : ids<grid::CopyId>(n))
      if (!is_full(grid, cuts, complex, c)) {
        partial.push_back(c);
        element_of_[c.value] = static_cast<std::uint32_t>(partial.size());
      }
  elements_.resize(partial.size() + 1);
  const auto make = [&](const Moments& moments) {
    Element element = make_element(moments, h_, options.material, options.sliver_floor);
    spread_mass(element, options.mass_spread);
    return element;
  };
  elements_[0] = make(full_cube_moments());
  parallel_for(partial.size(), [&](const std::size_t i) {
    const grid::Copy& copy = complex.copies[partial[i]];
    elements_[i + 1] = make(octant_moments(grid, cuts, copy.cell, copy.nodes));
  });

  corners_.reserve(8 * n);
  user_start_.assign(complex.n_corners() + 1, 0);
  for (const auto c : ids<grid::CopyId>(n)) {
    stiffness_.push_back(element(c.value).stiffness.data());
    for (int a = 0; a < 8; ++a) {
      const auto corner = complex.copies[c].corners[a].value;
      corners_.push_back(corner);
      ++user_start_[corner + 1];
      mass_[corner] += element(c.value).mass[a];
    }
  }
  for (std::size_t i = 1; i < user_start_.size(); ++i)
    user_start_[i] += user_start_[i - 1];
  users_.resize(8 * n);
  std::vector<std::uint32_t> next(user_start_.begin(), user_start_.end() - 1);
  for (std::uint32_t i = 0; i < 8 * n; ++i)
    users_[next[corners_[i]]++] = i;

  values_.resize(24 * n);
  rotations_.resize(9 * n);
  for (std::size_t e = 0; e < n; ++e)
    Eigen::Map<Mat3>(rotations_.data() + 9 * e).setIdentity();
}

double Corotational::volume() const {
  double sum = 0;
  for (std::size_t e = 0; e < n_elements(); ++e)
    sum += element(e).volume;
  return sum;
}

Mat3 Corotational::deformation_gradient(const std::size_t e, const Points& x) const {
  const std::uint32_t* const c = corners_.data() + 8 * e;
  Mat3 F = Mat3::Zero();
  for (int a = 1; a < 8; ++a)
    F += (x[c[a]] - x[c[0]]) * element(e).gradient[a].transpose();
  return F;
}

void Corotational::local_displacement(const std::size_t e, const Points& x, const Mat3& R, double* const u) const {
  const std::uint32_t* const c = corners_.data() + 8 * e;
  for (int a = 0; a < 8; ++a)
    Eigen::Map<Vec3>(u + 3 * a) = R.transpose() * (x[c[a]] - x[c[0]]) - h_ * vertex_offset(a);
}

void Corotational::gather(const std::vector<double>& values, double* const y) const {
  parallel_for(
    mass_.size(),
    [&](const std::size_t corner) {
      Vec3 sum = Vec3::Zero();
      for (auto k = user_start_[corner]; k < user_start_[corner + 1]; ++k)
        sum += Eigen::Map<const Vec3>(values.data() + 3 * std::size_t(users_[k]));
      Eigen::Map<Vec3>(y + 3 * corner) = sum;
    },
    worth_corners);
}

double Corotational::energy(const Points& x) const {
  std::vector<double> energies(n_elements());
  parallel_for(
    n_elements(),
    [&](const std::size_t e) {
      Eigen::Matrix<double, 24, 1> u;
      local_displacement(e, x, material::rotation_of(deformation_gradient(e, x)), u.data());
      energies[e] = 0.5 * u.dot(Eigen::Map<const Eigen::Matrix<double, 24, 24>>(stiffness_[e]) * u);
    },
    worth_elements);
  double sum = 0;
  for (const double energy : energies)
    sum += energy;
  return sum;
}

void Corotational::force(const Points& x, Points& forces) const {
  parallel_for(
    n_elements(),
    [&](const std::size_t e) {
      const Mat3 F = deformation_gradient(e, x), R = material::rotation_of(F);
      Eigen::Matrix<double, 24, 1> u, Ku;
      local_displacement(e, x, R, u.data());
      Ku.noalias() = Eigen::Map<const Eigen::Matrix<double, 24, 24>>(stiffness_[e]) * u;

      // dE = Ku . (R^T dx) - omega . tau with R^T dR = [omega]x, tau = sum y_a x (Ku)_a and, from the polar
      // decomposition, (tr(S) I - S) omega = sum g_a x R^T dx_a.
      Vec3 tau = Vec3::Zero();
      for (int a = 0; a < 8; ++a)
        tau +=
          u.segment<3>(3 * a).cross(Ku.segment<3>(3 * a)) + h_ * vertex_offset(a).cross(Vec3(Ku.segment<3>(3 * a)));
      const Mat3 S = R.transpose() * F;
      const Mat3 spin = S.trace() * Mat3::Identity() - S;
      constexpr double collapsed = 1e-6; // the rotation is not differentiable there: leave its term out
      const Vec3 z = spin.determinant() > collapsed ? Vec3(spin.inverse() * tau) : Vec3(Vec3::Zero());
      for (int a = 0; a < 8; ++a)
        Eigen::Map<Vec3>(values_.data() + 24 * e + 3 * a) =
          R * (z.cross(element(e).gradient[a]) - Ku.segment<3>(3 * a));
    },
    worth_elements);
  forces.resize(mass_.size());
  gather(values_, forces[0].data());
}

void Corotational::linearise(const Points& x) {
  parallel_for(
    n_elements(),
    [&](const std::size_t e) {
      Eigen::Map<Mat3>(rotations_.data() + 9 * e) = material::rotation_of(deformation_gradient(e, x));
    },
    worth_elements);
}

void Corotational::apply_stiffness(const std::span<const double> p, const std::span<double> y) const {
  constexpr std::size_t block = 64;
  parallel_for((n_elements() + block - 1) / block,
               [&](const std::size_t b) {
                 const std::size_t first = b * block;
                 fem::apply_stiffness({std::min(block, n_elements() - first), corners_.data() + 8 * first,
                                       stiffness_.data() + first, rotations_.data() + 9 * first},
                                      p.data(), values_.data() + 24 * first);
               },
               worth_elements / block);
  gather(values_, y.data());
}

void Corotational::stiffness_diagonal(std::vector<Mat3>& blocks) const {
  blocks.resize(mass_.size());
  parallel_for(
    mass_.size(),
    [&](const std::size_t corner) {
      Mat3 sum = Mat3::Zero();
      for (auto k = user_start_[corner]; k < user_start_[corner + 1]; ++k) {
        const std::size_t e = users_[k] / 8;
        const int a = users_[k] % 8;
        const Eigen::Map<const Mat3> R(rotations_.data() + 9 * e);
        const Eigen::Map<const Eigen::Matrix<double, 24, 24>> K(stiffness_[e]);
        sum += R * K.block<3, 3>(3 * a, 3 * a) * R.transpose();
      }
      blocks[corner] = sum;
    },
    worth_corners);
}

} // namespace kerf::fem
