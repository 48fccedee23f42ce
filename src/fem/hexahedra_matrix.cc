/// Stiffness as a matrix: of elements, and summed.

#include "dynamics/state.h"
#include "fem/assembly.h"
#include "fem/hexahedra.h"

namespace kerf::fem {

using material::Tangent;

namespace {

/// The 3 x 3 block A : (. b_c^T) b_a of a law's tangent.
Mat3 tangent_block(const Eigen::Ref<const Tangent>& A, const Vec3& b_a, const Vec3& b_c) {
  Mat3 sum = Mat3::Zero();
  for (int j = 0; j < 3; ++j)
    for (int l = 0; l < 3; ++l)
      sum += b_a[j] * b_c[l] * A.block<3, 3>(3 * j, 3 * l);
  return sum;
}

} // namespace

std::array<Vec3, 8> Hexahedra::corners_of(const std::size_t copy, const Points& x) const {
  const std::uint32_t* const c = corner_numbers(copy);
  return {x[c[0]], x[c[1]], x[c[2]], x[c[3]], x[c[4]], x[c[5]], x[c[6]], x[c[7]]};
}

Mat3 Hexahedra::deformation_gradient(const std::size_t copy, const Points& x) const {
  const std::uint32_t* const c = incidence_.corners(copy);
  Mat3 F = Mat3::Zero();
  for (int a = 1; a < 8; ++a)
    F += (x[c[a]] - x[c[0]]) * elements_[copy].gradient(a).transpose();
  return F;
}

Turned Hexahedra::turned_element(const std::size_t copy, const Points& x) const {
  return turned(elements_[copy], h_, corners_of(copy, x), frame_);
}

Matrix24 Hexahedra::element_matrix(const std::size_t copy, const Points& x, const dynamics::Tangent kind) const {
  const Element& element = elements_[copy];
  const Turned state = turned_element(copy, x);
  const bool is_exact = kind == dynamics::Tangent::exact;
  Matrix24 K = stiffness(element, material_, is_hookean() ? Part::whole : Part::hourglass);
  const Mat3 as_kept = state.R.cast<float>().cast<double>(); // as products have it
  K = is_exact ? hessian(element, K, state, frame_) : turned_stiffness(K, as_kept);
  if (is_hookean())
    return K;
  const Tangent A = std::visit(
    [&](const auto& law) { return Tangent(is_exact ? law.tangent(state.F) : law.positive_tangent(state.F)); }, law_);
  for (int a = 0; a < 8; ++a)
    for (int c = 0; c < 8; ++c)
      K.block<3, 3>(3 * a, 3 * c) += element.volume * tangent_block(A, element.gradient(a), element.gradient(c));
  return K;
}

Eigen::SparseMatrix<double> Hexahedra::stiffness_matrix(const Points& x, const dynamics::Tangent kind) const {
  std::vector<Eigen::Triplet<double>> entries;
  ghost_penalty_.add_entries(entries);
  ties_.add_entries(entries);
  add_entries(incidence_, numbers_, [&](const std::size_t copy) { return element_matrix(copy, x, kind); }, entries);
  const auto n = static_cast<Eigen::Index>(3 * numbers_.size());
  Eigen::SparseMatrix<double> K(n, n);
  K.setFromTriplets(entries.begin(), entries.end());
  return K;
}

} // namespace kerf::fem
