#include "dynamics/minimal_residuals.h"

#include "base/loan.h"
#include "dynamics/state.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace kerf::dynamics {

namespace {

constexpr int most_directions = 15; // with 30 a tenth fewer iterations, for twice the memory and work beside B

/// Calls f(i) for each number.
template <class Function>
void for_each_number(const std::size_t n, const Function& f) {
  constexpr std::size_t worth = 12288; // from which on a second thread pays
  parallel_ranges(n, worth, [&](const std::size_t begin, const std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      f(i);
  });
}

/// Not a number where the square is none of anything, as of what is not positive or not finite.
double root(const double square) { return square >= 0 ? std::sqrt(square) : std::numeric_limits<double>::quiet_NaN(); }

/// In the memory that steps have for vectors of corners.
class Numbers {
 public:
  explicit Numbers(const std::size_t n) : n_(n), lent_((n + 2) / 3, AnyValues()) {}

  std::span<double> all() { return flat(*lent_).first(n_); }

 private:
  std::size_t n_;
  Loan<Vec3> lent_;
};

/// Residuals of both rows, one after the other, and B times that of the first.
class Direction {
 public:
  Direction(const std::size_t n, const std::size_t n_rows) : n_(n), both_(n + n_rows), Bx_(n) {}

  std::span<double> all() { return both_.all(); }
  std::span<double> x() { return all().first(n_); }
  std::span<double> q() { return all().subspan(n_); }
  std::span<double> Bx() { return Bx_.all(); }

 private:
  std::size_t n_;
  Numbers both_, Bx_;
};

/// Of as many iterations as there are directions.
class Cycle {
 public:
  /// From what is left of the equation for x alone, and g = q - C x.
  Cycle(const CgEquation& equation, const StiffPart& stiff, const std::span<const double> r,
        const std::span<const double> g)
    : equation_(equation), stiff_(stiff), of_q_(1 / (1 + stiff.excess())), Cz_(stiff.n_rows()) {
    directions_.reserve(most_directions + 1);
    Direction& first = add(r.size());
    const std::span<double> minus = first.q();
    for_each_number(g.size(), [&](const std::size_t i) { minus[i] = -g[i]; });
    std::copy(r.begin(), r.end(), first.x().begin());
    stiff.add_transposed(minus, first.x());
    std::copy(g.begin(), g.end(), first.q().begin());
    scale(first);
    right_[0] = size_;
  }

  double residual() const { return std::abs(right_[n_taken_]); }
  bool is_full() const { return n_taken_ == most_directions || !(size_ > 0); }
  int n_taken() const { return n_taken_; }

  /// Where it finds nothing new that the preconditioner measures, the cycle ends as if it had not been asked.
  void take() {
    const int k = n_taken_;
    Direction& from = directions_[k];
    Direction& next = add(from.x().size());
    apply(from, next);
    std::array<double, most_directions + 1>& column = columns_[k];
    for (int i = 0; i <= k; ++i) {
      column[i] = product(next, directions_[i]);
      const std::span<double> to = next.all(), v = directions_[i].all();
      for_each_number(to.size(), [&](const std::size_t j) { to[j] -= column[i] * v[j]; });
    }
    scale(next);
    column[k + 1] = size_;
    for (int i = 0; i < k; ++i) {
      const double upper = column[i], lower = column[i + 1];
      column[i] = cosines_[i] * upper + sines_[i] * lower;
      column[i + 1] = cosines_[i] * lower - sines_[i] * upper;
    }
    const double length = std::hypot(column[k], column[k + 1]);
    if (!(length > 0)) { // or no number
      size_ = 0;
      return;
    }
    cosines_[k] = column[k] / length;
    sines_[k] = column[k + 1] / length;
    column[k] = length;
    right_[k + 1] = -sines_[k] * right_[k];
    right_[k] *= cosines_[k];
    ++n_taken_;
  }

  /// Adds what has been found.
  void add_to(const std::span<double> x, const std::span<double> q) {
    std::array<double, most_directions> y;
    for (int i = n_taken_ - 1; i >= 0; --i) {
      y[i] = right_[i];
      for (int k = i + 1; k < n_taken_; ++k)
        y[i] -= columns_[k][i] * y[k];
      y[i] /= columns_[i][i];
    }
    Numbers lent(x.size());
    const std::span<double> Cz = Cz_.all(), z = lent.all();
    std::fill(z.begin(), z.end(), 0);
    for (int k = 0; k < n_taken_; ++k) {
      const std::span<const double> of_x = directions_[k].Bx(), g = directions_[k].q();
      for_each_number(z.size(), [&](const std::size_t i) { z[i] += y[k] * of_x[i]; });
      for_each_number(q.size(), [&](const std::size_t i) { q[i] -= y[k] * of_q_ * g[i]; });
    }
    stiff_.product(z, Cz);
    for_each_number(x.size(), [&](const std::size_t i) { x[i] += z[i]; });
    for_each_number(q.size(), [&](const std::size_t i) { q[i] += of_q_ * Cz[i]; });
  }

 private:
  double product(Direction& a, Direction& b) const { return dot(a.x(), b.Bx()) + of_q_ * dot(a.q(), b.q()); }
  Direction& add(const std::size_t n) { return directions_.emplace_back(n, stiff_.n_rows()); }
  /// The preconditioned rows of a direction. For x that is z = B x, for q it is z_q = (C z - q) / (1 + e).
  void apply(Direction& from, Direction& next) {
    const std::span<double> Cz = Cz_.all(), to = next.q();
    const std::span<const double> q = from.q();
    equation_.A(from.Bx(), next.x()); // K z, from which C^T C z is taken below
    stiff_.product(from.Bx(), Cz);
    for_each_number(q.size(), [&](const std::size_t i) {
      const double z_q = of_q_ * (Cz[i] - q[i]);
      to[i] = Cz[i] - z_q;
      Cz[i] = -to[i];
    });
    stiff_.add_transposed(Cz, next.x());
  }
  void scale(Direction& direction) {
    equation_.B(direction.x(), direction.Bx());
    size_ = root(product(direction, direction));
    const double over = size_ > 0 ? 1 / size_ : 0;
    for (const std::span<double> values : {direction.all(), direction.Bx()})
      for_each_number(values.size(), [&](const std::size_t i) { values[i] *= over; });
  }

  const CgEquation& equation_;
  const StiffPart& stiff_;
  double of_q_;
  Numbers Cz_;
  std::vector<Direction> directions_;
  std::array<std::array<double, most_directions + 1>, most_directions> columns_ = {}; // of the triangular factor
  std::array<double, most_directions> cosines_ = {}, sines_ = {};
  std::array<double, most_directions + 1> right_ = {};
  double size_ = 0; // of the last direction before it was scaled
  int n_taken_ = 0;
};

} // namespace

CgReport minimal_residuals(const CgEquation& equation, const StiffPart& stiff, const std::span<const double> b,
                           const double residual, const int max_iterations, const std::span<double> x,
                           const std::span<double> left) {
  constexpr double too_slow = 0.9, safety = 0.7; // of a residual, what a cycle leaves; of what is aimed at
  Numbers lent_product(b.size()), lent_q(stiff.n_rows()), lent_g(stiff.n_rows());
  const std::span<double> product = lent_product.all(), q = lent_q.all(), g = lent_g.all();
  CgReport report;
  const auto measure = [&] {
    equation.A(x, product);
    for_each_number(b.size(), [&](const std::size_t i) { left[i] = b[i] - product[i]; });
    equation.J(left, product);
    report.residual = root(dot(left, product));
    report.converged = report.residual <= residual;
  };
  measure();
  stiff.product(x, q);
  double aim = residual / std::sqrt(1 + stiff.excess()); // in the measure of both rows, if g is all that is left
  double earlier = std::numeric_limits<double>::infinity(), earlier_of_x = earlier;
  while (!report.converged && report.n_iterations < max_iterations) {
    stiff.product(x, g);
    for_each_number(g.size(), [&](const std::size_t i) { g[i] = q[i] - g[i]; });
    Cycle cycle(equation, stiff, left, g);
    const bool gets_on = cycle.residual() <= too_slow * earlier || report.residual <= too_slow * earlier_of_x;
    if (!gets_on)
      break;
    earlier = cycle.residual();
    earlier_of_x = report.residual;
    while (!cycle.is_full() && cycle.residual() > aim && report.n_iterations < max_iterations) {
      cycle.take();
      ++report.n_iterations;
    }
    if (cycle.n_taken() == 0)
      break;
    cycle.add_to(x, q);
    measure();
    if (cycle.residual() <= aim)
      aim = safety * std::min(1.0, residual / report.residual) * cycle.residual();
  }
  if (dot(x, b) < dot(x, left)) // x.Kx < 0
    report.converged = false;
  return report;
}

CgReport solve_equation(const CgEquation& equation, const StiffPart* const stiff, const std::span<const double> b,
                        const CgStop& stop, const int max_iterations, const std::span<double> x,
                        const std::span<double> left) {
  CgReport first;
  if (stiff)
    first = minimal_residuals(equation, *stiff, b, stop.residual, max_iterations / 2, x, left);
  if (first.converged)
    return first;
  if (!std::isfinite(first.residual))
    std::fill(x.begin(), x.end(), 0);
  CgReport report = patient_conjugate_gradients(equation, b, stop, max_iterations - first.n_iterations, x, left);
  report.n_iterations += first.n_iterations;
  return report;
}

} // namespace kerf::dynamics
