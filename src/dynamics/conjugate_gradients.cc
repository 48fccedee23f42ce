#include "dynamics/conjugate_gradients.h"

#include "base/loan.h"
#include "base/parallel.h"
#include "dynamics/state.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace kerf::dynamics {

namespace {

constexpr std::size_t block = 4096;     // numbers a partial sum
constexpr std::size_t worth_blocks = 3; // from which on a second thread pays

/// Of the error, by what iterations take off its square.
class Estimate {
 public:
  /// `delay`: how many of the last iterations an error is told by, 8 at most. `room`: for a product.
  Estimate(const CgStop& stop, const std::size_t delay, const std::span<double> room)
    : stop_(stop), delay_(delay), room_(room) {}

  /// y.Ay - 2 b.y of the x that was given.
  void start_at(const double given) { given_ = given; }
  /// The start is nearer than what was given by so much, in squares.
  void start_nearer(const double excess) { all_ += excess; }
  void take_off(const double alpha, const double rz) {
    all_ += alpha * rz;
    last_[n_++ % delay_] = alpha * rz;
    least_.reset();
    largest_alpha_ = std::max(largest_alpha_, alpha);
  }
  double way() { return std::sqrt(square_of_way()); }
  /// By what the last iterations took: those left before them.
  bool says_enough() {
    constexpr double bound_is_low = 10; // squared: what these iterations left may be more than what they took
    return n_ >= delay_ && is_little(bound_is_low * std::accumulate(last_.begin(), last_.begin() + delay_, 0.0));
  }
  /// By r.Jr of the iterate at hand, to be called once for each before r.Br is known, where B is more than J.
  bool foresees_enough(const double square) {
    constexpr double bound_is_low = 16; // squared, see the header
    const double factor = square / std::exchange(square_, square);
    return n_ >= 1 && bound_is_low * largest_alpha_ * factor * rz_[1] <= most();
  }
  /// By r.Br, likewise.
  bool says_enough(const double rz) {
    const double bound_is_low = n_ == 1 ? 10 : 4; // squared, see the header
    const double factor = n_ == 1 ? rz / rz_[1] : std::max(rz / rz_[1], rz_[1] / rz_[0]);
    rz_ = {rz_[1], rz};
    return n_ >= 1 && factor < 1 && is_little(bound_is_low * largest_alpha_ * rz / (1 - factor));
  }

 private:
  double square_of_way() {
    if (stop_.from && !farther_) {
      if (!least_)
        least_ = stop_.from->least();
      return *least_ * *least_;
    }
    return std::max(0.0, all_ + farther_.value_or(0));
  }
  /// Of a square of the error.
  bool is_little(const double square) {
    constexpr double far = 100; // squared: a way so many times what is known of it is rare
    const double known = most();
    if (square <= known)
      return true;
    if (!stop_.from || farther_ || stop_.of_way == 0 || (known > 0 && square > far * known))
      return false;
    farther_ = stop_.from->potential(room_) - given_;
    return square <= most();
  }
  double most() { return std::max(stop_.error * stop_.error, stop_.of_way * stop_.of_way * square_of_way()); }

  CgStop stop_;
  std::size_t delay_;
  std::span<double> room_;
  std::array<double, 8> last_ = {};
  std::array<double, 2> rz_ = {0, 0}; // of the last two iterates
  double square_ = 0;                 // r.Jr of the last one
  std::size_t n_ = 0;
  double all_ = 0, given_ = 0, largest_alpha_ = 0;
  std::optional<double> least_;   // way of the iterate at hand; none before it is asked for
  std::optional<double> farther_; // y than what was given, in squares; none before it is asked for
};

} // namespace

double sum_of(const std::size_t n, const FunctionRef<double(std::size_t, std::size_t)> of_range) {
  return sum_in_blocks(
    n, 0.0, [&](const std::size_t begin, const std::size_t end, double& sum) { sum = of_range(begin, end); });
}

double dot(const std::span<const double> a, const std::span<const double> b) {
  return sum_of(a.size(), [&](const std::size_t begin, const std::size_t end) {
    double sums[4] = {0, 0, 0, 0}; // four at a time: additions do not wait for each other
    std::size_t i = begin;
    for (; i + 4 <= end; i += 4)
      for (int k = 0; k < 4; ++k)
        sums[k] += a[i + k] * b[i + k];
    for (; i < end; ++i)
      sums[0] += a[i] * b[i];
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
  });
}

CgReport conjugate_gradients(const CgEquation& equation, const std::span<const double> b, const CgStop& stop,
                             const int max_iterations, const std::span<double> x, const std::span<double> left) {
  const std::size_t n = b.size();
  const std::size_t n_triples = (n + 2) / 3; // in the memory that steps have for vectors of corners
  Loan<Vec3> lent_r = left.empty() ? Loan<Vec3>(n_triples) : Loan<Vec3>::none();
  Loan<Vec3> lent_z(n_triples), lent_p(n_triples, Vec3::Zero()), lent_Ap(n_triples, Vec3::Zero());
  const std::span<double> r = left.empty() ? flat(*lent_r).first(n) : left, z = flat(*lent_z).first(n),
                          p = flat(*lent_p).first(n), Ap = flat(*lent_Ap).first(n);
  // One iteration with more than block Jacobi is worth many. Between iterations nobody asks for Ap.
  Estimate estimate(stop, equation.J ? 3 : 8, Ap);
  const auto is_zero = [](const double value) { return value == 0; };
  double excess = 0; // of the error's square over that of zero
  if (!std::all_of(x.begin(), x.end(), is_zero)) {
    equation.A(x, Ap);
    excess = dot(x, Ap) - 2 * dot(b, x);
    if (excess > 0) {
      estimate.start_nearer(excess);
      std::fill(x.begin(), x.end(), 0);
      std::fill(Ap.begin(), Ap.end(), 0);
    }
  }
  estimate.start_at(excess);
  parallel_ranges(n, worth_blocks * block, [&](const std::size_t begin, const std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      r[i] = b[i] - Ap[i];
  });
  CgReport report;
  double rz = 0; // r.Br
  const auto measure = [&] {
    (equation.J ? equation.J : equation.B)(r, z);
    const double square = dot(r, z);
    report.residual = std::sqrt(square);
    report.converged = report.residual <= stop.residual || estimate.says_enough() ||
                       (equation.J && estimate.foresees_enough(square));
    if (report.converged || report.n_iterations == max_iterations)
      return;
    if (equation.J)
      equation.B(r, z);
    const double rz_new = equation.J ? dot(r, z) : square, beta = rz > 0 ? rz_new / rz : 0;
    report.converged = equation.J && estimate.says_enough(rz_new);
    if (report.converged)
      return;
    rz = rz_new;
    parallel_ranges(n, worth_blocks * block, [&](const std::size_t begin, const std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        p[i] = z[i] + beta * p[i];
    });
  };
  const auto with_way = [&] {
    report.way = estimate.way();
    return report;
  };
  measure();
  double earlier = report.residual; // by the patience's iterations
  while (!report.converged && report.n_iterations < max_iterations) {
    if (stop.patience > 0 && report.n_iterations > 0 && report.n_iterations % stop.patience == 0) {
      constexpr double tenth = 0.1;
      if (!(report.residual <= tenth * earlier))
        break;
      earlier = report.residual;
    }
    equation.A(p, Ap);
    const double pAp = dot(p, Ap);
    if (!(pAp > 0 && rz > 0)) {
      report.indefinite = true;
      if (report.n_iterations == 0 && std::all_of(x.begin(), x.end(), is_zero))
        std::copy(p.begin(), p.end(), x.begin());
      return with_way();
    }
    const double alpha = rz / pAp;
    parallel_ranges(n, worth_blocks * block, [&](const std::size_t begin, const std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        x[i] += alpha * p[i];
        r[i] -= alpha * Ap[i];
      }
    });
    estimate.take_off(alpha, rz);
    ++report.n_iterations;
    measure();
  }
  return with_way();
}

CgReport patient_conjugate_gradients(const CgEquation& equation, const std::span<const double> b, const CgStop& stop,
                                     const int max_iterations, const std::span<double> x,
                                     const std::span<double> left) {
  if (!equation.J)
    return conjugate_gradients(equation, b, stop, max_iterations, x, left);
  CgStop patient = stop;
  patient.patience = 400;
  const CgReport first = conjugate_gradients(equation, b, patient, max_iterations, x, left);
  if (first.converged || first.indefinite || first.n_iterations >= max_iterations)
    return first;
  CgReport report =
    conjugate_gradients({equation.A, equation.J, {}}, b, stop, max_iterations - first.n_iterations, x, left);
  report.n_iterations += first.n_iterations;
  if (!stop.from)
    report.way = std::hypot(report.way, first.way);
  return report;
}

} // namespace kerf::dynamics
