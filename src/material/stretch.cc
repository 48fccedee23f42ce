#include "material/stretch.h"

#include "material/polar.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace kerf::material {

Stretches stretches_of(const Mat3& F) {
  const Mat3 R = rotation_of(F), S = R.transpose() * F;
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(0.5 * (S + S.transpose()));
  Stretches result;
  for (int i = 0; i < 3; ++i) { // Eigen's ascend
    result.V.col(i) = solver.eigenvectors().col(2 - i);
    result.s[i] = solver.eigenvalues()[2 - i];
  }
  if (result.V.determinant() < 0)
    result.V.col(2) *= -1;
  result.U = R * result.V;
  return result;
}

Curvature absolute_value(const Curvature& curvature) {
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(curvature.stretch);
  return {solver.eigenvectors() * solver.eigenvalues().cwiseAbs().asDiagonal() * solver.eigenvectors().transpose(),
          curvature.flip.cwiseAbs(), curvature.twist.cwiseAbs()};
}

Tangent tangent_of(const Stretches& stretches, const Curvature& curvature) {
  Tangent local = Tangent::Zero(), frame;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      frame.block<3, 3>(3 * i, 3 * j) = stretches.V(i, j) * stretches.U;
      local(4 * i, 4 * j) = curvature.stretch(i, j);
    }
  for (int k = 0; k < 3; ++k) {
    const int ij = (k + 1) % 3 + 3 * ((k + 2) % 3), ji = (k + 2) % 3 + 3 * ((k + 1) % 3);
    local(ij, ij) = local(ji, ji) = 0.5 * (curvature.flip[k] + curvature.twist[k]);
    local(ij, ji) = local(ji, ij) = 0.5 * (curvature.flip[k] - curvature.twist[k]);
  }
  return frame * local * frame.transpose();
}

} // namespace kerf::material
