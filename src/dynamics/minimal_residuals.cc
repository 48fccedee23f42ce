#include "dynamics/minimal_residuals.h"

#include "base/loan.h"
#include "dynamics/state.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace kerf::dynamics {

namespace {

constexpr int most_directions = 30; // that are remembered
constexpr std::size_t worth_two = 12288; // numbers from which on a second thread pays

/// Calls f(i) for each number.
template <class Function>
void for_each_number(const std::size_t n, const Function& f) {
  parallel_ranges(n, worth_two, [&](const std::size_t begin, const std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      f(i);
  });
}

/// In the memory that steps have for vectors of corners.
class Numbers {
 public:
  explicit Numbers(const std::size_t n) : n_(n), lent_((n + 2) / 3, AnyValues()) {}

  std::span<double> all() { return flat(*lent_).first(n_); }

 private:
  std::size_t n_;
  Loan<Vec3> lent_;
};

/// Of both rows, one after the other, with B of the first.
struct Direction {
  Direction(const std::size_t n, const std::size_t n_rows) : n_x(n), values(n + n_rows), of_B(n) {}

  std::span<double> all() { return values.all(); }
  std::span<double> x() { return values.all().first(n_x); }
  std::span<double> q() { return values.all().subspan(n_x); }
  std::span<double> Bx() { return of_B.all(); }

  std::size_t n_x;
  Numbers values, of_B;
};

double product(Direction& a, Direction& b) { return dot(a.x(), b.Bx()) + dot(a.q(), b.q()); }

class Iteration {
 public:
  /// From what is left of the equation for x alone, and q - C x.
  Iteration(const CgEquation& equation, const StiffPart& stiff, const std::span<const double> r,
            const std::span<const double> g)
    : equation_(equation), stiff_(stiff), n_(r.size()), q_(stiff.n_rows()) {
    directions_.reserve(most_directions + 1);
    Direction& first = add();
    std::copy(r.begin(), r.end(), first.x().begin());
    const auto minus = first.q();
    for_each_number(g.size(), [&](const std::size_t i) { minus[i] = -g[i]; });
    stiff.add_transposed(minus, first.x());
    std::copy(g.begin(), g.end(), first.q().begin());
    scale(first);
    right_[0] = size_;
  }

  /// Of both rows: the first in the norm of B.
  double residual() const { return std::abs(right_[n_taken_]); }
  bool is_full() const { return n_taken_ == most_directions || !(size_ > 0); }

  void take() {
    const int k = n_taken_;
    Direction& from = directions_[k];
    const std::span<double> q = q_.all();
    Direction& next = add();
    const double of_q = 1 / (1 + stiff_.excess());
    stiff_.product(from.Bx(), q); // C z
    const auto from_q = from.q(), next_q = next.q();
    equation_.A(from.Bx(), next.x());
    // With z_q = (C z - v_q) / (1 + e): A z - C^T (C z) + C^T z_q, and C z - z_q.
    for_each_number(q.size(), [&](const std::size_t i) {
      const double z_q = of_q * (q[i] - from_q[i]);
      next_q[i] = q[i] - z_q;
      q[i] = z_q - q[i];
    });
    stiff_.add_transposed(q, next.x());
    std::array<double, most_directions + 1>& column = columns_[k];
    for (int i = 0; i <= k; ++i) {
      column[i] = product(next, directions_[i]);
      const auto to = next.all(), v = directions_[i].all();
      for_each_number(to.size(), [&](const std::size_t j) { to[j] -= column[i] * v[j]; });
    }
    scale(next);
    column[k + 1] = size_;
    for (int i = 0; i < k; ++i) {
      const double upper = column[i], lower = column[i + 1];
      column[i] = cosines_[i] * upper + sines_[i] * lower;
      column[i + 1] = -sines_[i] * upper + cosines_[i] * lower;
    }
    const double length = std::hypot(column[k], column[k + 1]);
    cosines_[k] = length > 0 ? column[k] / length : 1;
    sines_[k] = length > 0 ? column[k + 1] / length : 0;
    column[k] = length;
    right_[k + 1] = -sines_[k] * right_[k];
    right_[k] *= cosines_[k];
    ++n_taken_;
  }

  /// Adds what has been found to x, and to q.
  void add_to(const std::span<double> x, const std::span<double> q) {
    std::array<double, most_directions> y;
    for (int i = n_taken_ - 1; i >= 0; --i) {
      y[i] = right_[i];
      for (int k = i + 1; k < n_taken_; ++k)
        y[i] -= columns_[k][i] * y[k];
      y[i] = columns_[i][i] > 0 ? y[i] / columns_[i][i] : 0;
    }
    for (int k = 0; k < n_taken_; ++k) {
      const auto z = directions_[k].Bx(), v = directions_[k].q(), Cz = q_.all();
      for_each_number(x.size(), [&](const std::size_t i) { x[i] += y[k] * z[i]; });
      if (q.empty())
        continue;
      stiff_.product(z, Cz);
      const double of_q = 1 / (1 + stiff_.excess());
      for_each_number(q.size(), [&](const std::size_t i) { q[i] += y[k] * of_q * (Cz[i] - v[i]); });
    }
  }

 private:
  Direction& add() { return directions_.emplace_back(n_, stiff_.n_rows()); }
  void scale(Direction& direction) {
    equation_.B(direction.x(), direction.Bx());
    size_ = std::sqrt(std::max(0.0, product(direction, direction)));
    const double over = size_ > 0 ? 1 / size_ : 0;
    const auto all = direction.all(), Bx = direction.Bx();
    for_each_number(all.size(), [&](const std::size_t i) { all[i] *= over; });
    for_each_number(Bx.size(), [&](const std::size_t i) { Bx[i] *= over; });
  }

  const CgEquation& equation_;
  const StiffPart& stiff_;
  std::size_t n_;
  Numbers q_;
  std::vector<Direction> directions_;
  std::array<std::array<double, most_directions + 1>, most_directions> columns_ = {};
  std::array<double, most_directions> cosines_ = {}, sines_ = {};
  std::array<double, most_directions + 1> right_ = {};
  double size_ = 0; // of the last direction, before it was scaled
  int n_taken_ = 0;
};

} // namespace

CgReport minimal_residuals(const CgEquation& equation, const StiffPart& stiff, const std::span<const double> b,
                           const CgStop& stop, const int max_iterations, const std::span<double> x,
                           const std::span<double> left) {
  constexpr double of_energy = 1.5; // what both rows lack may be as large as the root of two times its square's root
  const std::size_t n = b.size();
  Numbers lent(n), lent_start(n), lent_q(stiff.n_rows()), lent_Cx(stiff.n_rows());
  const std::span<double> room = lent.all(), start = lent_start.all(), r = left, q = lent_q.all(), Cx = lent_Cx.all();
  const auto put_residual = [&] {
    equation.A(x, room);
    for_each_number(n, [&](const std::size_t i) { r[i] = b[i] - room[i]; });
  };
  /// x.Ax - 2 b.x.
  const auto potential = [&] { return -dot(x, b) - dot(x, r); };
  put_residual();
  double from = potential(); // of what ways count from
  if (from > 0) {
    std::fill(x.begin(), x.end(), 0);
    std::copy(b.begin(), b.end(), r.begin());
  }
  if (stop.from && stop.of_way > 0)
    from = stop.from->potential(room);
  CgReport report;
  const auto way = [&] { return std::sqrt(std::max(0.0, from - potential())); };
  const auto measure = [&] {
    equation.J(r, room);
    report.residual = std::sqrt(std::max(0.0, dot(r, room)));
    return report.residual <= stop.residual;
  };
  report.converged = measure();
  stiff.product(x, q);
  while (!report.converged && report.n_iterations < max_iterations) {
    stiff.product(x, Cx);
    for_each_number(q.size(), [&](const std::size_t i) { Cx[i] = q[i] - Cx[i]; });
    Iteration iteration(equation, stiff, r, Cx);
    std::copy(x.begin(), x.end(), start.begin());
    const double at_start = iteration.residual();
    while (!report.converged && !iteration.is_full() && report.n_iterations < max_iterations) {
      iteration.take();
      ++report.n_iterations;
      const double error = of_energy * iteration.residual();
      const bool asks = error <= stop.error || (stop.of_way > 0 && report.n_iterations % 4 == 0) ||
                        iteration.residual() <= stop.residual || iteration.is_full();
      if (getenv("DBG")) fprintf(stderr, "%d res %.3e J %.3e of %.3e err %.2e %d\n", report.n_iterations, iteration.residual(), report.residual, stop.residual, stop.error, asks);
      if (!asks)
        continue;
      std::copy(start.begin(), start.end(), x.begin());
      iteration.add_to(x, iteration.is_full() ? q : std::span<double>());
      put_residual();
      report.converged = measure() || error <= stop.error || (stop.of_way > 0 && error <= stop.of_way * way());
    }
    if (!(iteration.residual() <= 0.5 * at_start))
      break;
  }
  report.way = way();
  if (!(dot(x, b) - dot(x, r) >= 0)) // x.Ax < 0
    report.converged = false;
  return report;
}

} // namespace kerf::dynamics
