#include "dynamics/direct.h"

#include "base/error.h"
#include "base/parallel.h"

#include <Eigen/CholmodSupport>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>

#include <cmath>
#include <limits>

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

/// 1 / sqrt(|diagonal|): entries of any unit and size become comparable.
Eigen::VectorXd scaling(const Matrix& A) {
  Eigen::VectorXd s = A.diagonal().cwiseAbs();
  for (double& value : s)
    value = value > 0 ? 1 / std::sqrt(value) : 1;
  return s;
}

[[noreturn]] void refuse_singular() {
  throw NumericalError("the stiffness is singular: a part of the body is free to move, or has lost all stiffness");
}

/// A matrix with a unit diagonal has pivots between its smallest and largest eigenvalue, and a kernel leaves one that
/// is round-off. Where the condition is bad, what the first solution leaves is solved for again.
constexpr double round_off_of_pivots = 64 * std::numeric_limits<double>::epsilon();

/// Of a positive matrix: its dense blocks make it many times faster than what takes any symmetric one.
class Cholesky : public Eigen::CholmodSupernodalLLT<Matrix> {
 public:
  explicit Cholesky(const Matrix& A) {
    cholmod().print = 0; // a matrix that is not positive is nothing to tell of
    compute(A);
    is_positive_ = info() == Eigen::Success && cholmod_rcond(m_cholmodFactor, &cholmod()) > round_off_of_pivots;
  }
  bool is_positive() const { return is_positive_; }

 private:
  bool is_positive_ = false;
};

void require_regular(const Eigen::SimplicialLDLT<Matrix>& solver) {
  if (solver.info() != Eigen::Success || !(solver.vectorD().cwiseAbs().minCoeff() > round_off_of_pivots))
    refuse_singular();
}
void require_regular(const Eigen::SparseLU<Matrix>& solver) {
  if (solver.info() != Eigen::Success)
    refuse_singular();
}

template <class Solver>
Eigen::VectorXd solve_with(const Solver& solver, const Matrix& A, const Eigen::VectorXd& b) {
  constexpr int n_refinements = 3;
  constexpr double solved = 1e-6; // what a regular matrix leaves is far below
  Eigen::VectorXd x = solver.solve(b);
  for (int k = 0; k < n_refinements && x.allFinite(); ++k)
    x += Eigen::VectorXd(solver.solve(b - A * x));
  if (!x.allFinite() || (A * x - b).norm() > solved * b.norm())
    refuse_singular();
  return x;
}
template <class Solver>
Eigen::VectorXd solve_if_regular(const Matrix& A, const Eigen::VectorXd& b) {
  const Solver solver(A);
  require_regular(solver);
  return solve_with(solver, A, b);
}

Eigen::VectorXd solution(const Matrix& A, const Eigen::VectorXd& b) {
  if (b.size() == 0)
    return b;
  if (!is_symmetric(A))
    return solve_if_regular<Eigen::SparseLU<Matrix>>(A, b);
  if (const Cholesky cholesky(A); cholesky.is_positive())
    return solve_with(cholesky, A, b);
  return solve_if_regular<Eigen::SimplicialLDLT<Matrix>>(A, b);
}

} // namespace

void solve_directly(const Matrix& A, const Constraints& constraints, const Points& force, Points& d) {
  keep_libraries_to_one_thread();
  const Matrix T = free_directions(constraints);
  Matrix reduced = T.transpose() * A * T;
  const Eigen::VectorXd scale = scaling(reduced);
  reduced = scale.asDiagonal() * reduced * scale.asDiagonal();
  const Eigen::Map<const Eigen::VectorXd> f(force.empty() ? nullptr : force[0].data(),
                                            static_cast<Eigen::Index>(3 * force.size()));
  const Eigen::VectorXd b = scale.cwiseProduct(T.transpose() * f);
  const Eigen::VectorXd y = solution(reduced, b);
  d.resize(force.size());
  Eigen::Map<Eigen::VectorXd>(d.empty() ? nullptr : d[0].data(), f.size()) = T * scale.cwiseProduct(y);
}

} // namespace kerf::dynamics
