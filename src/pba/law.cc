#include "pba/law.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

namespace kerf::pba {

namespace {

Mat3 cofactor(const Mat3& F) {
  Mat3 C;
  C << F.col(1).cross(F.col(2)), F.col(2).cross(F.col(0)), F.col(0).cross(F.col(1));
  return C;
}

/// Derivative of the cofactor along dF.
Mat3 cofactor_change(const Mat3& F, const Mat3& dF) {
  Mat3 C;
  for (int k = 0; k < 3; ++k) {
    const int a = (k + 1) % 3, b = (k + 2) % 3;
    C.col(k) = dF.col(a).cross(F.col(b)) + F.col(a).cross(dF.col(b));
  }
  return C;
}

Mat3 green(const Strain& strain) { return 0.5 * (strain.F.transpose() * strain.F - strain.M * strain.M); }

/// What is left of lambda for the trace of the strain.
double trace_modulus(const Law& law, const Strain& strain) { return law.lambda - law.volume * strain.d * strain.d; }

/// Hooke's stress of a strain: the second Piola-Kirchhoff one [Pa].
Mat3 hooke(const Law& law, const Strain& strain, const Mat3& E) {
  return 2 * law.mu * E + trace_modulus(law, strain) * E.trace() * Mat3::Identity();
}

Mat3 without_compression(const Mat3& S) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(S);
  const Mat3& Q = eigen.eigenvectors();
  return Q * eigen.eigenvalues().cwiseMax(0).asDiagonal() * Q.transpose();
}

} // namespace

double energy_density(const Law& law, const Strain& strain) {
  const Mat3 E = green(strain);
  const double trace = E.trace(), change = strain.F.determinant() - strain.d;
  return law.mu * E.squaredNorm() + 0.5 * trace_modulus(law, strain) * trace * trace +
         0.5 * law.volume * change * change;
}

Mat3 stress(const Law& law, const Strain& strain) {
  const Mat3 C = cofactor(strain.F);
  const double change = strain.F.col(0).dot(C.col(0)) - strain.d;
  return strain.F * hooke(law, strain, green(strain)) + law.volume * change * C;
}

Linearised linearise(const Law& law, const Strain& strain, const dynamics::Tangent tangent) {
  Linearised at;
  at.F = strain.F;
  at.cofactor = cofactor(strain.F);
  at.mu = law.mu;
  at.trace = trace_modulus(law, strain);
  at.volume = law.volume;
  at.spin_stress = hooke(law, strain, green(strain));
  at.pressure = law.volume * (strain.F.determinant() - strain.d);
  if (tangent == dynamics::Tangent::positive) {
    at.spin_stress = without_compression(at.spin_stress);
    at.pressure = 0;
  }
  return at;
}

Mat3 stress_change(const Linearised& at, const Mat3& dF) {
  const Mat3 twice_dE = dF.transpose() * at.F + at.F.transpose() * dF;
  const Mat3 dS = at.mu * twice_dE + 0.5 * at.trace * twice_dE.trace() * Mat3::Identity();
  Mat3 dP = dF * at.spin_stress + at.F * dS + at.volume * at.cofactor.cwiseProduct(dF).sum() * at.cofactor;
  if (at.pressure != 0)
    dP += at.pressure * cofactor_change(at.F, dF);
  return dP;
}

Mat3 block(const Linearised& at, const Vec3& g) {
  // The second derivative of det F vanishes for two changes of the same rank-one direction.
  const Vec3 Fg = at.F * g, Cg = at.cofactor * g;
  return g.dot(at.spin_stress * g) * Mat3::Identity() + at.mu * g.squaredNorm() * at.F * at.F.transpose() +
         (at.mu + at.trace) * Fg * Fg.transpose() + at.volume * Cg * Cg.transpose();
}

} // namespace kerf::pba
