#include "pba/fit.h"

#include "material/polar.h"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace kerf::pba {

namespace {

/// From 0 at a tenth of the threshold to 1 at the threshold, with a continuous slope.
double share(const double value, const double threshold) {
  const double t = std::clamp((value / threshold - 0.1) / 0.9, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

} // namespace

Fit fit(const Mat3& moment, const double reference, const double threshold) {
  constexpr double smallest = 1e-8; // of the reference: far above the round-off of the moment
  Fit result;
  if (!(reference > 0))
    return result;
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(moment);
  Vec3 inverse, used;
  for (int k = 0; k < 3; ++k) {
    const double value = eigen.eigenvalues()[k];
    inverse[k] = value > smallest * reference ? 1 / value : 0.0;
    used[k] = share(value / reference, threshold);
  }
  const Mat3& Q = eigen.eigenvectors();
  result.inverse = Q * inverse.asDiagonal() * Q.transpose();
  result.determinant = used.prod();
  result.used = used.minCoeff() == 1 ? Mat3(Mat3::Identity()) : Mat3(Q * used.asDiagonal() * Q.transpose());
  return result;
}

Mat3 completed(const Mat3& known, const Fit& fit) {
  if (fit.determinant == 1)
    return known;
  constexpr double faint = 1e-6; // settles what is not known, without a say in what is
  const Mat3 unknown = Mat3::Identity() - fit.used;
  return known + material::rotation_of(known + faint * unknown) * unknown;
}

} // namespace kerf::pba
