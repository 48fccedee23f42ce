#include "tests/support/spectrum.h"

#include <Eigen/Eigenvalues>

namespace kerf::support {

Eigen::VectorXd spectrum(const Eigen::MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

} // namespace kerf::support
