#include "material/polar.h"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace kerf::material {

namespace {

Mat3 rotation_by_svd(const Mat3& F) {
  const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0)
    U.col(2) *= -1;
  return U * svd.matrixV().transpose();
}

} // namespace

Mat3 rotation_of(const Mat3& F) {
  constexpr double well_conditioned = 1e-3;
  constexpr int max_iterations = 20;
  const double size = F.norm();
  if (!(F.determinant() > well_conditioned * size * size * size / 6))
    return rotation_by_svd(F);
  Mat3 R = F;
  for (int i = 0; i < max_iterations; ++i) {
    const Mat3 next = 0.5 * (R + R.inverse().transpose());
    const double change = (next - R).squaredNorm();
    R = next;
    if (change < 1e-28)
      return R;
  }
  return rotation_by_svd(F);
}

} // namespace kerf::material
