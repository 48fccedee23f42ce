#pragma once

/// Preconditioned conjugate gradients (Hestenes and Stiefel 1952) that stop where the matrix is not positive (Steihaug
/// 1983): a direction p with p.Ap <= 0 ends the iteration at the last iterate, or at p itself when nothing was found
/// yet, so that what comes back is a descent direction of 1/2 x.Ax - b.x. Sums are taken in blocks of fixed size, so
/// any number of threads gives the same bits.

#include "base/function_ref.h"
#include "base/loan.h"
#include "base/parallel.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace kerf::dynamics {

/// Sum over ranges of fixed size that cover 0 .. n - 1, the same for any number of threads; `of_range` adds to its sum.
template <class T, class OfRange>
T sum_in_blocks(const std::size_t n, const T& zero, const OfRange& of_range) {
  constexpr std::size_t block = 4096, worth_blocks = 3; // from which on a second thread pays
  Loan<T> parts((n + block - 1) / block, zero);
  parallel_for(
    parts.size(), [&](const std::size_t b) { of_range(b * block, std::min(n, (b + 1) * block), parts[b]); },
    worth_blocks);
  T sum = zero;
  for (const T& part : *parts)
    sum += part;
  return sum;
}
double sum_of(std::size_t n, FunctionRef<double(std::size_t begin, std::size_t end)> of_range);
double dot(std::span<const double> a, std::span<const double> b);

/// From where a way counts: some y.
struct WayFrom {
  /// y.Ay - 2 b.y, which takes a product, and room for it: asked for where the other says too little.
  std::function<double(std::span<double> product)> potential;
  std::function<double()> least; ///< |x - y|_A of the x at hand, at least
};

/// Where to stop: at whichever comes first. Errors are in the energy norm |e|_A = sqrt(e.Ae).
struct CgStop {
  double residual = 0; ///< of b - A x, in the measure of the equation
  double error = 0;    ///< of x
  double of_way = 0;   ///< error of x over the way to the solution [1]
  std::optional<WayFrom> from = {}; ///< none: from the x that was given
  int patience = 0; ///< gives up once so many iterations have not brought the residual to a tenth; 0: never
};

struct CgReport {
  int n_iterations = 0;
  double residual = 0;     ///< of b - A x, in the measure of the equation
  double way = 0;          ///< |x - y|_A for the y of the stop; where its potential was not asked for, at least that
  bool converged = false;  ///< as the stop says
  bool indefinite = false; ///< stopped by a direction that the matrix does not resist
};

/// y = A p.
using Product = std::function<void(std::span<const double> p, std::span<double> y)>;

/// A x = b, with B near A^-1 and J the measure of a residual, sqrt(r.Jr): all symmetric, B and J positive.
struct CgEquation {
  Product A, B;
  Product J = {}; ///< empty: B
};

/// Solves A x = b from the x that is given, or from zero where that is nearer in the energy norm. `left`: where b - A x
/// is to be, but after a direction that the matrix does not resist; nowhere if empty.
///
/// An iteration takes alpha r.Br off the error's square, exactly (Hestenes and Stiefel 1952, theorem 6:3), so what the
/// last few took is a lower bound for the error before them that round-off does not spoil (Strakos and Tichy 2002, On
/// error estimation in the conjugate gradient method and why it works in finite precision computations, ETNA 13), and
/// the sum of all is the square of the way.
///
/// Where B is more than J, the error of the iterate at hand is told too: its square is the sum of all alpha r.Br to
/// come. With alpha at most that of any iteration so far, and r.Br falling at least by the factor q that was the larger
/// of the last two, that is alpha r.Br / (1 - q). Multigrid's B is good for that: in 8,300 iterations of seven scenes,
/// soft and stiff, cut and not, nu up to .49, the square of the error was more than four times that in six. After the
/// first iteration there is one q: the square of the error was 1.2 times that in the middle and 3.8 at most, in 690
/// solutions of eight scenes. Before Br is had, r.Br is taken to fall as r.Jr does: the square of the error was .9
/// times what that says, 15 at most. So the application of B that would tell that the error is small, and do nothing
/// else, is mostly spared.
CgReport conjugate_gradients(const CgEquation& equation, std::span<const double> b, const CgStop& stop,
                             int max_iterations, std::span<double> x, std::span<double> left = {});

/// The same, but for an equation with J of its own by B as long as 400 iterations bring the residual to a tenth,
/// and from there by J: where B gets on badly, the blocks alone may do as well, at a fraction of its cost.
CgReport patient_conjugate_gradients(const CgEquation& equation, std::span<const double> b, const CgStop& stop,
                                     int max_iterations, std::span<double> x, std::span<double> left = {});

} // namespace kerf::dynamics
