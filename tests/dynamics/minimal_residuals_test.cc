/// Equations with a part that is much stiffer than the rest, against a factorisation.

#include "dynamics/minimal_residuals.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace kerf::dynamics::minimal_residuals_test {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

Vector vector_of(const std::span<const double> values) {
  return Eigen::Map<const Vector>(values.data(), static_cast<Eigen::Index>(values.size()));
}
void put(const Vector& values, const std::span<double> to) { std::copy(values.begin(), values.end(), to.begin()); }

struct Dense : StiffPart {
  Matrix C;
  double largest = 0;

  std::size_t n_rows() const override { return static_cast<std::size_t>(C.rows()); }
  void product(const std::span<const double> p, const std::span<double> q) const override { put(C * vector_of(p), q); }
  void add_transposed(const std::span<const double> q, const std::span<double> y) const override {
    put(vector_of(y) + C.transpose() * vector_of(q), y);
  }
  double excess() const override { return largest; }
};

/// (A + C^T C) x = b with eigenvalues of C A^-1 C^T from .16 e to e: no constraint follows from the others.
struct Problem {
  Matrix A, whole, B;
  Dense stiff;
  Vector b, solution;

  explicit Problem(const double e, const unsigned seed = 5) {
    constexpr Eigen::Index n = 300, n_rows = 100;
    std::mt19937 random(seed);
    const auto drawn = [&](const Eigen::Index rows, const Eigen::Index columns) {
      return Matrix(Matrix::NullaryExpr(
        rows, columns, [&] { return std::uniform_real_distribution<double>(-1, 1)(random); }));
    };
    const Matrix Q = drawn(n, n).householderQr().householderQ();
    A = Q * Vector::LinSpaced(n, 1, 30).asDiagonal() * Q.transpose();
    const Matrix P = drawn(n, n).householderQr().householderQ(); // B: half to one and a half of A^-1
    const Matrix root = Eigen::SelfAdjointEigenSolver<Matrix>(A.inverse()).operatorSqrt();
    B = root * P * Vector::LinSpaced(n, 0.5, 1.5).asDiagonal() * P.transpose() * root;
    const Matrix W = drawn(n, n).householderQr().householderQ();
    stiff.C = std::sqrt(e) * Vector::LinSpaced(n_rows, 0.4, 1).asDiagonal() * W.leftCols(n_rows).transpose() *
              Eigen::SelfAdjointEigenSolver<Matrix>(A).operatorSqrt();
    stiff.largest = e;
    whole = A + stiff.C.transpose() * stiff.C;
    b = drawn(n, 1);
    solution = whole.ldlt().solve(b);
  }
  CgEquation equation() const {
    return {[this](const auto p, const auto y) { put(whole * vector_of(p), y); },
            [this](const auto r, const auto z) { put(B * vector_of(r), z); },
            [this](const auto r, const auto z) { put(vector_of(r).cwiseQuotient(whole.diagonal()), z); }};
  }
  double size_of_b() const { return std::sqrt(b.dot(b.cwiseQuotient(whole.diagonal()))); }
  CgReport solve(const double residual, Vector& x, Vector& left, const int most = 1000) const {
    left.resize(b.size());
    return minimal_residuals(equation(), stiff, {b.data(), b.data() + b.size()}, residual, most,
                             {x.data(), x.data() + x.size()}, {left.data(), left.data() + left.size()});
  }
};

TEST(MinimalResiduals, TakeAsManyIterationsHoweverStiffAPartIs) {
  std::vector<int> counts, by_conjugate_gradients;
  for (const double e : {1e2, 1e4, 1e6}) {
    const Problem problem(e);
    Vector x = Vector::Zero(problem.b.size()), left;
    const double residual = 1e-7 * problem.size_of_b();
    const CgReport report = problem.solve(residual, x, left);
    EXPECT_TRUE(report.converged) << e;
    EXPECT_LE(report.residual, residual);
    EXPECT_LT((problem.b - problem.whole * x - left).norm(), 1e-9 * std::sqrt(e) * problem.b.norm());
    const Vector error = x - problem.solution;
    EXPECT_LT(std::sqrt(error.dot(problem.whole * error)), 1e-5 * std::sqrt(problem.solution.dot(problem.b))) << e;
    counts.push_back(report.n_iterations);
    Vector y = Vector::Zero(problem.b.size());
    by_conjugate_gradients.push_back(
      conjugate_gradients(problem.equation(), {problem.b.data(), problem.b.data() + problem.b.size()},
                          {.residual = residual}, 3000, {y.data(), y.data() + y.size()})
        .n_iterations);
  }
  EXPECT_LT(counts[2], 2 * counts[0]) << counts[0] << ", " << counts[1] << ", " << counts[2];
  EXPECT_GT(by_conjugate_gradients[2], 2 * counts[2]) << by_conjugate_gradients[2];
}

/// More iterations than directions that are remembered: cycles go on from where others ended.
TEST(MinimalResiduals, GoOnFromCycleToCycle) {
  const Problem problem(1e4, 6);
  Vector x = Vector::Zero(problem.b.size()), left;
  const int n = problem.solve(1e-9 * problem.size_of_b(), x, left).n_iterations;
  EXPECT_GT(n, 30);
  Vector half = Vector::Zero(problem.b.size());
  const CgReport stopped = problem.solve(1e-9 * problem.size_of_b(), half, left, n / 2);
  EXPECT_FALSE(stopped.converged);
  EXPECT_EQ(stopped.n_iterations, n / 2);
  const CgReport rest = problem.solve(1e-9 * problem.size_of_b(), half, left);
  EXPECT_TRUE(rest.converged);
  EXPECT_LT((half - x).norm(), 1e-7 * x.norm());
}

TEST(MinimalResiduals, StartFromWhatIsGiven) {
  const Problem problem(1e3, 7);
  Vector x = problem.solution, left;
  const CgReport none = problem.solve(1e-6 * problem.size_of_b(), x, left);
  EXPECT_TRUE(none.converged);
  EXPECT_EQ(none.n_iterations, 0);
  EXPECT_EQ(x, problem.solution);
  x = 2 * problem.solution;
  EXPECT_TRUE(problem.solve(1e-6 * problem.size_of_b(), x, left).converged);
  EXPECT_LT((x - problem.solution).norm(), 1e-4 * problem.solution.norm());
  Problem zero(1e3, 8);
  x = zero.solution;
  const double from = 1e-6 * zero.size_of_b();
  zero.b.setZero();
  EXPECT_TRUE(zero.solve(from, x, left).converged);
  EXPECT_LT(x.norm(), 1e-4 * zero.solution.norm());
}

/// K x = b has a solution there too, but one that no descent leads to.
TEST(MinimalResiduals, GiveUpWhereTheMatrixDoesNotResist) {
  Problem problem(1e2, 9);
  problem.whole -= 100 * problem.solution * problem.solution.transpose() * problem.whole.norm() /
                   problem.solution.squaredNorm();
  problem.b = problem.whole * problem.solution;
  Vector x = problem.solution, left;
  const CgReport report = problem.solve(1e-6 * problem.b.norm(), x, left);
  EXPECT_LE(report.residual, 1e-6 * problem.b.norm()) << "solved, but at no minimum";
  EXPECT_FALSE(report.converged);
}

/// What B gives is not positive, nothing, or no number: that is said, and comes to an end.
TEST(MinimalResiduals, GiveUpWhereThePreconditionerMeasuresNothing) {
  for (const double factor : {-1., 0., std::numeric_limits<double>::quiet_NaN()}) {
    Problem problem(1e3, 11);
    problem.B *= factor;
    Vector x = Vector::Zero(problem.b.size()), left;
    const CgReport report = problem.solve(1e-6 * problem.size_of_b(), x, left);
    EXPECT_FALSE(report.converged) << factor;
    EXPECT_EQ(x, Vector::Zero(x.size())) << factor;
  }
  Problem problem(1e3, 12);
  problem.whole(3, 3) = std::numeric_limits<double>::quiet_NaN();
  Vector x = Vector::Zero(problem.b.size()), left;
  EXPECT_FALSE(problem.solve(1e-6 * problem.b.norm(), x, left).converged);
}

/// A part that misjudges itself, so that cycles get nowhere: conjugate gradients go on.
TEST(MinimalResiduals, AreFollowedByConjugateGradientsWhereTheyGiveUp) {
  Problem problem(1e4, 10);
  problem.stiff.largest = -1 + 1e-6;
  const double residual = 1e-8 * problem.size_of_b();
  Vector x = Vector::Zero(problem.b.size()), left = x;
  const CgReport alone = problem.solve(residual, x, left, 10000);
  EXPECT_FALSE(alone.converged);
  x.setZero();
  const CgReport report =
    solve_equation(problem.equation(), &problem.stiff, {problem.b.data(), problem.b.data() + problem.b.size()},
                   {.residual = residual}, 20000, {x.data(), x.data() + x.size()},
                   {left.data(), left.data() + left.size()});
  EXPECT_TRUE(report.converged);
  EXPECT_GT(report.n_iterations, alone.n_iterations);
  EXPECT_LT((x - problem.solution).norm(), 1e-5 * problem.solution.norm());
}

} // namespace
} // namespace kerf::dynamics::minimal_residuals_test
