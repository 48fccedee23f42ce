#include "fem/hexahedra.h"

#include "base/parallel.h"
#include "fem/assembly.h"
#include "fem/kernels.h"
#include "material/polar.h"

#include <algorithm>
#include <numeric>

namespace kerf::fem {

namespace {

/// A second thread pays from about this many elements (1 us each) and corners (0.1 us each) on.
constexpr std::size_t worth_elements = 256, worth_corners = 4096;
/// Elements in one call of a kernel, and in one piece of work of a thread.
constexpr std::size_t run_size = 64;

using material::Tangent;

Frame frame_of(const material::AnyLaw& law) {
  return std::holds_alternative<material::SmallStrain>(law) ? Frame::fixed : Frame::turning;
}

ElementTableOptions table_options(const HexahedraOptions& options) {
  const bool is_hookean = options.material.law == "small strain" || options.material.law == "corotational";
  return {options.material, options.boundary, {options.strain, is_hookean ? Part::whole : Part::hourglass}};
}

/// The 3 x 3 block A : (. b_c^T) b_a of a law's tangent.
Mat3 tangent_block(const Eigen::Ref<const Tangent>& A, const Vec3& b_a, const Vec3& b_c) {
  Mat3 sum = Mat3::Zero();
  for (int j = 0; j < 3; ++j)
    for (int l = 0; l < 3; ++l)
      sum += b_a[j] * b_c[l] * A.block<3, 3>(3 * j, 3 * l);
  return sum;
}

} // namespace

Hexahedra::Hexahedra(const grid::Solid& solid, const HexahedraOptions& options)
  : h_(solid.grid.h()),
    law_(material::law_of(options.material)),
    frame_(frame_of(law_)),
    inertia_(options.inertia),
    elements_(solid, table_options(options)),
    incidence_(solid),
    ghost_penalty_(options.ghost_penalty, options.material, h_) {
  std::vector<std::uint32_t> corners(solid.complex.n_corners());
  std::iota(corners.begin(), corners.end(), 0);
  std::vector<grid::CopyId> copies;
  copies.reserve(solid.complex.n_copies());
  for (const auto c : ids<grid::CopyId>(solid.complex.n_copies()))
    copies.push_back(c);
  follow(solid, copies, corners);
  linearise(grid::rest_positions(solid));
}

void Hexahedra::update(const grid::Solid& solid, const std::span<const grid::CopyId> changed) {
  elements_.update(solid, changed);
  follow(solid, changed, incidence_.update(solid, changed));
}

void Hexahedra::follow(const grid::Solid& solid, const std::span<const grid::CopyId> changed,
                       const std::span<const std::uint32_t> corners) {
  find_runs();
  sum_mass(corners);
  ghost_penalty_.update( // to which a crumb's copies are as good as full
    solid, changed, [this](const std::size_t copy) { return incidence_.is_used(copy) ? fill(copy) : 1; }, mass_);
}

void Hexahedra::find_runs() {
  runs_.clear();
  for (std::size_t e = 0; e < n_elements(); ++e) {
    if (!incidence_.is_used(e))
      continue;
    const bool goes_on = !runs_.empty() && runs_.back().first + runs_.back().n == e && runs_.back().n < run_size;
    if (goes_on)
      ++runs_.back().n;
    else
      runs_.push_back({e, 1});
  }
}

template <class Function>
void Hexahedra::for_each_element(const Function& f) const {
  parallel_for(
    runs_.size(),
    [&](const std::size_t r) {
      for (std::size_t e = runs_[r].first; e < runs_[r].first + runs_[r].n; ++e)
        f(e);
    },
    worth_elements / run_size);
}

void Hexahedra::sum_mass(const std::span<const std::uint32_t> corners) {
  mass_.resize(incidence_.n_corners());
  for (const auto corner : corners) {
    mass_[corner] = 0;
    for (const auto user : incidence_.users(corner))
      mass_[corner] += elements_[user / 8].mass[user % 8];
  }
}

double Hexahedra::volume() const {
  double sum = 0;
  for (std::size_t e = 0; e < n_elements(); ++e)
    sum += incidence_.is_used(e) ? elements_[e].volume : 0;
  return sum;
}

std::array<Vec3, 8> Hexahedra::corners_of(const std::size_t copy, const Points& x) const {
  const std::uint32_t* const c = incidence_.corners(copy);
  return {x[c[0]], x[c[1]], x[c[2]], x[c[3]], x[c[4]], x[c[5]], x[c[6]], x[c[7]]};
}

Mat3 Hexahedra::deformation_gradient(const std::size_t copy, const Points& x) const {
  const std::uint32_t* const c = incidence_.corners(copy);
  Mat3 F = Mat3::Zero();
  for (int a = 1; a < 8; ++a)
    F += (x[c[a]] - x[c[0]]) * elements_[copy].gradient[a].transpose();
  return F;
}

Turned Hexahedra::turned_element(const std::size_t copy, const Points& x) const {
  return turned(elements_[copy], h_, corners_of(copy, x), frame_);
}

void Hexahedra::gather(const double* const values, double* const y) const {
  parallel_for(
    incidence_.n_corners(),
    [&](const std::size_t corner) {
      Vec3 sum = Vec3::Zero();
      for (const auto user : incidence_.users(corner))
        sum += Eigen::Map<const Vec3>(values + 3 * std::size_t(user));
      Eigen::Map<Vec3>(y + 3 * corner) = sum;
    },
    worth_corners);
}

double Hexahedra::energy(const Points& x) const {
  auto energies = scratch_.borrow(n_elements());
  for_each_element([&](const std::size_t e) {
    const Turned state = turned_element(e, x);
    double& energy = energies.data()[e];
    energy = 0.5 * state.u.dot(Eigen::Map<const Matrix24>(elements_[e].stiffness.data()) * state.u);
    if (!is_hookean())
      energy += elements_[e].volume * std::visit([&](const auto& law) { return law.energy(state.F); }, law_);
  });
  double sum = ghost_penalty_.energy(x);
  for (const Run& run : runs_)
    sum = std::accumulate(energies.data() + run.first, energies.data() + run.first + run.n, sum);
  return sum;
}

void Hexahedra::force(const Points& x, Points& forces) const {
  auto values = scratch_.borrow(24 * n_elements());
  for_each_element([&](const std::size_t e) {
    const Turned state = turned_element(e, x);
    Eigen::Map<Vector24> f(values.data() + 24 * e);
    f = -gradient(elements_[e], state, frame_);
    if (is_hookean())
      return;
    const Mat3 P = std::visit([&](const auto& law) { return Mat3(law.stress(state.F)); }, law_);
    for (int a = 0; a < 8; ++a)
      f.segment<3>(3 * a) -= elements_[e].volume * P * elements_[e].gradient[a];
  });
  forces.resize(mass_.size());
  gather(values.data(), forces[0].data());
  ghost_penalty_.add_force(x, forces);
}

void Hexahedra::linearise(const Points& x) {
  rotations_.resize(9 * n_elements());
  tangents_.resize(is_hookean() ? 0 : 81 * n_elements());
  for_each_element([&](const std::size_t e) {
    const Mat3 F = deformation_gradient(e, x);
    Eigen::Map<Mat3>(rotations_.data() + 9 * e) =
      frame_ == Frame::turning ? material::rotation_of(F) : Mat3(Mat3::Identity());
    if (!is_hookean())
      Eigen::Map<Tangent>(tangents_.data() + 81 * e) =
        elements_[e].volume * std::visit([&](const auto& law) { return Tangent(law.positive_tangent(F)); }, law_);
  });
}

void Hexahedra::apply_stiffness(const std::span<const double> p, const std::span<double> y) const {
  static_assert(sizeof(Element) % sizeof(double) == 0);
  auto values = scratch_.borrow(24 * n_elements());
  parallel_for(
    runs_.size(),
    [&](const std::size_t r) {
      const auto& [first, n] = runs_[r];
      const ElementBlock elements{n,
                                  incidence_.corners(first),
                                  elements_.element_of() + first,
                                  elements_.elements()->stiffness.data(),
                                  elements_.elements()->gradient[0].data(),
                                  sizeof(Element) / sizeof(double),
                                  rotations_.data() + 9 * first};
      fem::apply_stiffness(elements, p.data(), values.data() + 24 * first);
      if (!is_hookean())
        add_mean_tangent(elements, tangents_.data() + 81 * first, p.data(), values.data() + 24 * first);
    },
    worth_elements / run_size);
  gather(values.data(), y.data());
  ghost_penalty_.add_product(p, y);
}

void Hexahedra::stiffness_diagonal(std::vector<Mat3>& blocks) const {
  blocks.resize(mass_.size());
  const std::vector<double> penalty = ghost_penalty_.diagonal(mass_.size());
  parallel_for(
    mass_.size(),
    [&](const std::size_t corner) {
      Mat3 sum = penalty[corner] * Mat3::Identity();
      for (const auto user : incidence_.users(corner)) {
        const std::size_t e = user / 8;
        const int a = user % 8;
        const Eigen::Map<const Mat3> R(rotations_.data() + 9 * e);
        const Eigen::Map<const Matrix24> K(elements_[e].stiffness.data());
        sum += R * K.block<3, 3>(3 * a, 3 * a) * R.transpose();
        if (!is_hookean())
          sum += tangent_block(Eigen::Map<const Tangent>(tangents_.data() + 81 * e), elements_[e].gradient[a],
                               elements_[e].gradient[a]);
      }
      blocks[corner] = sum;
    },
    worth_corners);
}

Matrix24 Hexahedra::element_matrix(const std::size_t copy, const Points& x, const dynamics::Tangent kind) const {
  const Element& element = elements_[copy];
  const Turned state = turned_element(copy, x);
  const bool is_exact = kind == dynamics::Tangent::exact;
  Matrix24 K = is_exact ? hessian(element, state, frame_) : turned_stiffness(element, state.R);
  if (is_hookean())
    return K;
  const Tangent A = std::visit(
    [&](const auto& law) { return Tangent(is_exact ? law.tangent(state.F) : law.positive_tangent(state.F)); }, law_);
  for (int a = 0; a < 8; ++a)
    for (int c = 0; c < 8; ++c)
      K.block<3, 3>(3 * a, 3 * c) += element.volume * tangent_block(A, element.gradient[a], element.gradient[c]);
  return K;
}

Eigen::SparseMatrix<double> Hexahedra::stiffness_matrix(const Points& x, const dynamics::Tangent kind) const {
  std::vector<Eigen::Triplet<double>> penalty;
  ghost_penalty_.add_entries(penalty);
  const auto n = static_cast<Eigen::Index>(3 * mass_.size());
  Eigen::SparseMatrix<double> K(n, n);
  K.setFromTriplets(penalty.begin(), penalty.end());
  K += assemble(incidence_, [&](const std::size_t copy) { return element_matrix(copy, x, kind); });
  return K;
}

void Hexahedra::apply_mass(const std::span<const double> p, const std::span<double> y) const {
  auto values = scratch_.borrow(24 * n_elements());
  for_each_element([&](const std::size_t e) {
    Eigen::Matrix<double, 3, 8> q;
    for (int a = 0; a < 8; ++a)
      q.col(a) = Eigen::Map<const Vec3>(p.data() + 3 * std::size_t(incidence_.corners(e)[a]));
    Eigen::Map<Eigen::Matrix<double, 3, 8>>(values.data() + 24 * e) =
      q * Eigen::Map<const Eigen::Matrix<double, 8, 8>>(elements_[e].consistent_mass.data());
  });
  gather(values.data(), y.data());
}

} // namespace kerf::fem
