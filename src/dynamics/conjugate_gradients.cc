#include "dynamics/conjugate_gradients.h"

#include "base/parallel.h"

#include <algorithm>
#include <cmath>

namespace kerf::dynamics {

namespace {

constexpr std::size_t block = 4096;     // numbers a partial sum
constexpr std::size_t worth_blocks = 3; // from which on a second thread pays

} // namespace

double sum_of(const std::size_t n, const std::function<double(std::size_t, std::size_t)>& of_range) {
  std::vector<double> parts((n + block - 1) / block);
  parallel_for(
    parts.size(), [&](const std::size_t b) { parts[b] = of_range(b * block, std::min(n, (b + 1) * block)); },
    worth_blocks);
  double sum = 0;
  for (const double part : parts)
    sum += part;
  return sum;
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

CgReport conjugate_gradients(const Product& A, const std::span<const double> b, const double tolerance,
                             const int max_iterations, const std::span<double> x) {
  const std::size_t n = b.size();
  std::vector<double> r(n), p(n), Ap(n);
  const bool from_zero = std::all_of(x.begin(), x.end(), [](const double value) { return value == 0; });
  if (!from_zero)
    A(x, Ap);
  for (std::size_t i = 0; i < n; ++i)
    p[i] = r[i] = b[i] - (from_zero ? 0 : Ap[i]);
  double rr = dot(r, r);
  CgReport report{0, std::sqrt(rr), std::sqrt(rr) <= tolerance};
  while (!report.converged && report.n_iterations < max_iterations) {
    A(p, Ap);
    const double pAp = dot(p, Ap);
    if (!(pAp > 0)) {
      report.indefinite = true;
      if (report.n_iterations == 0 && from_zero)
        std::copy(p.begin(), p.end(), x.begin());
      return report;
    }
    const double alpha = rr / pAp;
    const double rr_new = sum_of(n, [&](const std::size_t begin, const std::size_t end) {
      double sum = 0;
      for (std::size_t i = begin; i < end; ++i) {
        x[i] += alpha * p[i];
        r[i] -= alpha * Ap[i];
        sum += r[i] * r[i];
      }
      return sum;
    });
    const double beta = rr_new / rr;
    rr = rr_new;
    ++report.n_iterations;
    report.residual = std::sqrt(rr);
    report.converged = report.residual <= tolerance;
    parallel_ranges(n, worth_blocks * block, [&](const std::size_t begin, const std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        p[i] = r[i] + beta * p[i];
    });
  }
  return report;
}

} // namespace kerf::dynamics
