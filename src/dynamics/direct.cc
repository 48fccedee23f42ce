#include "dynamics/direct.h"

#include "base/error.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>

namespace kerf::dynamics {

namespace {

using Matrix = Eigen::SparseMatrix<double>;

/// Columns: a unit vector for each free direction of each corner.
Matrix free_directions(const Constraints& constraints) {
  std::vector<Eigen::Triplet<double>> entries;
  int column = 0;
  for (std::size_t i = 0; i < constraints.n_corners(); ++i) {
    const auto& freedom = constraints.freedom(i);
    for (int k = 0; k < freedom.n_free; ++k, ++column)
      for (int a = 0; a < 3; ++a)
        if (freedom.basis(a, k) != 0)
          entries.emplace_back(3 * i + a, column, freedom.basis(a, k));
  }
  Matrix T(3 * constraints.n_corners(), column);
  T.setFromTriplets(entries.begin(), entries.end());
  return T;
}

bool is_symmetric(const Matrix& A) {
  constexpr double round_off = 1e-12;
  return (A - Matrix(A.transpose())).norm() <= round_off * A.norm();
}

template <class Solver>
Eigen::VectorXd solve_with(const Matrix& A, const Eigen::VectorXd& b) {
  const Solver solver(A);
  const Eigen::VectorXd x = solver.info() == Eigen::Success ? Eigen::VectorXd(solver.solve(b)) : Eigen::VectorXd();
  constexpr double solved = 1e-6; // what a regular matrix leaves is far below
  if (x.size() != b.size() || !x.allFinite() || (A * x - b).norm() > solved * b.norm())
    throw NumericalError("the stiffness is singular: a part of the body is free to move, or has lost all stiffness");
  return x;
}

} // namespace

void solve_directly(const Matrix& A, const Constraints& constraints, const Points& force, Points& d) {
  const Matrix T = free_directions(constraints);
  const Matrix reduced = T.transpose() * A * T;
  const Eigen::Map<const Eigen::VectorXd> f(force.empty() ? nullptr : force[0].data(),
                                            static_cast<Eigen::Index>(3 * force.size()));
  const Eigen::VectorXd b = T.transpose() * f;
  const Eigen::VectorXd y = is_symmetric(reduced) ? solve_with<Eigen::SimplicialLDLT<Matrix>>(reduced, b)
                                                  : solve_with<Eigen::SparseLU<Matrix>>(reduced, b);
  d.resize(force.size());
  Eigen::Map<Eigen::VectorXd>(d.empty() ? nullptr : d[0].data(), f.size()) = T * y;
}

} // namespace kerf::dynamics
