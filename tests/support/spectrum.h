#pragma once

/// Eigenvalues for tests, compiled once: the templates behind them take seconds in every file that names them.

#include <Eigen/Core>

namespace kerf::support {

/// The eigenvalues of a symmetric matrix (its lower half is read), ascending.
Eigen::VectorXd spectrum(const Eigen::MatrixXd& A);

} // namespace kerf::support
