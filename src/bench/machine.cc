#include "bench/machine.h"

#include "base/parallel.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>

namespace kerf::bench {

namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// As many numbers at once as hide the latency of fused operations, and fit into 14 registers of four.
constexpr int lanes = 56;

/// Multiplies and adds; returns what nobody needs.
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] double multiply_and_add(const std::size_t n) {
  double x[lanes];
  for (int i = 0; i < lanes; ++i)
    x[i] = 1 + 1e-3 * i;
  for (std::size_t k = 0; k < n; ++k)
    for (int i = 0; i < lanes; ++i)
      x[i] = x[i] * 0.999999 + 1e-6;
  double sum = 0;
  for (const double value : x)
    sum += value;
  return sum;
}

double measured_flops() {
  constexpr std::size_t n = 400000;
  constexpr double of_call = 2.0 * lanes * n;
  const auto threads = static_cast<std::size_t>(n_threads());
  std::vector<double> sums(threads);
  double best = 0;
  for (int sample = 0; sample < 5; ++sample) {
    const double start = now();
    parallel_for(threads, [&](const std::size_t i) { sums[i] = multiply_and_add(n); });
    best = std::max(best, double(threads) * of_call / (now() - start));
  }
  return std::isfinite(sums[0]) ? best : 0;
}

/// a = b + s c, in arrays that no cache holds (McCalpin 1995, the STREAM benchmark: triad).
double measured_bandwidth() {
  constexpr std::size_t n = std::size_t(1) << 23;
  std::vector<double> a(n, 0), b(n, 1), c(n, 2);
  double best = 0;
  for (int sample = 0; sample < 5; ++sample) {
    const double start = now();
    parallel_ranges(n, 1, [&](const std::size_t begin, const std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        a[i] = b[i] + 0.5 * c[i];
    });
    best = std::max(best, 3 * sizeof(double) * double(n) / (now() - start));
  }
  return best;
}

} // namespace

Machine measure_machine() { return {measured_flops(), measured_bandwidth()}; }

Sample sample_of(std::vector<double> seconds) {
  std::sort(seconds.begin(), seconds.end());
  const auto at = [&](const double part) {
    return seconds[static_cast<std::size_t>(std::lround(part * double(seconds.size() - 1)))];
  };
  const double median = at(0.5);
  return {median, median > 0 ? (at(0.75) - at(0.25)) / median : 0};
}

Sample timed(const std::function<void()>& call, const int n_samples, const double least) {
  const double first = now();
  call();
  const double once = now() - first;
  const auto n_calls = std::max(1, static_cast<int>(std::min(1e6, std::ceil(least / std::max(once, 1e-9)))));
  std::vector<double> seconds;
  for (int i = 0; i < n_samples; ++i) {
    const double start = now();
    for (int k = 0; k < n_calls; ++k)
      call();
    seconds.push_back((now() - start) / n_calls);
  }
  return sample_of(seconds);
}

} // namespace kerf::bench
