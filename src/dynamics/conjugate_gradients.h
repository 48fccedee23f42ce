#pragma once

/// Conjugate gradients (Hestenes and Stiefel 1952) that stop where the matrix is not positive (Steihaug 1983): a
/// direction p with p.Ap <= 0 ends the iteration at the last iterate, or at p itself when nothing was found yet, so
/// that what comes back is a descent direction of 1/2 x.Ax - b.x. Sums are taken in blocks of fixed size, so any
/// number of threads gives the same bits.

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace kerf::dynamics {

/// Sum of term(i) for i < n, the same for any number of threads.
double sum_of(std::size_t n, const std::function<double(std::size_t begin, std::size_t end)>& of_range);
double dot(std::span<const double> a, std::span<const double> b);

struct CgReport {
  int n_iterations = 0;
  double residual = 0;     ///< Euclidean norm of b - A x
  bool converged = false;  ///< residual <= tolerance
  bool indefinite = false; ///< stopped by a direction that the matrix does not resist
};

/// y = A p.
using Product = std::function<void(std::span<const double> p, std::span<double> y)>;

/// Solves A x = b from the x that is given, until the residual's norm is at most `tolerance`.
CgReport conjugate_gradients(const Product& A, std::span<const double> b, double tolerance, int max_iterations,
                             std::span<double> x);

} // namespace kerf::dynamics
