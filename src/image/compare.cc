#include "image/compare.h"

#include "image/filters.h"

#include <cmath>

namespace kerf::image {

namespace {

bool inside(const Grey& mask, const std::size_t i) { return mask.values[i] >= 0.5f; }

Grey product(const Grey& a, const Grey& b) {
  Grey result = a;
  for (std::size_t i = 0; i < result.values.size(); ++i)
    result.values[i] *= b.values[i];
  return result;
}

/// The mean over the mask of f(i).
template <class Function>
double mean_inside(const Grey& mask, const Function& f) {
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t i = 0; i < mask.values.size(); ++i)
    if (inside(mask, i)) {
      sum += f(i);
      ++n;
    }
  return n > 0 ? sum / static_cast<double>(n) : 0;
}

} // namespace

std::vector<double> histogram(const Grey& grey, const Grey& mask, const int n_bins) {
  std::vector<double> bins(n_bins, 0.0);
  double n = 0;
  for (std::size_t i = 0; i < grey.values.size(); ++i)
    if (inside(mask, i)) {
      ++bins[std::clamp(static_cast<int>(grey.values[i] * static_cast<float>(n_bins)), 0, n_bins - 1)];
      ++n;
    }
  for (double& share : bins)
    share /= std::max(n, 1.0);
  return bins;
}

double histogram_distance(const std::vector<double>& a, const std::vector<double>& b) {
  double moved = 0, ahead = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ahead += a[i] - b[i];
    moved += std::abs(ahead);
  }
  return moved / static_cast<double>(a.size());
}

double psnr(const Colours& a, const Colours& b, const Grey& mask) {
  const double error = mean_inside(
    mask, [&](const std::size_t i) { return (a.values[i] - b.values[i]).square().cast<double>().sum() / 3; });
  return error > 1e-20 ? -10 * std::log10(error) : 200;
}

double ssim(const Grey& a, const Grey& b, const Grey& mask) {
  constexpr double sigma = 1.5, c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
  const auto mean = [&](const Grey& grey) { return blurred_inside(grey, mask, sigma); };
  const Grey ma = mean(a), mb = mean(b), aa = mean(product(a, a)), bb = mean(product(b, b)), ab = mean(product(a, b));
  return mean_inside(mask, [&](const std::size_t i) {
    const double x = ma.values[i], y = mb.values[i];
    const double xx = aa.values[i] - x * x, yy = bb.values[i] - y * y, xy = ab.values[i] - x * y;
    return (2 * x * y + c1) * (2 * xy + c2) / ((x * x + y * y + c1) * (xx + yy + c2));
  });
}

std::vector<double> band_power(const Grey& grey, const Grey& mask, const int n_bands) {
  std::vector<double> power;
  Grey finer = grey;
  for (int k = 0; k < n_bands; ++k) {
    const Grey coarser = blurred_inside(grey, mask, std::ldexp(1.0, k));
    power.push_back(mean_inside(mask, [&](const std::size_t i) {
      const double d = finer.values[i] - coarser.values[i];
      return d * d;
    }));
    finer = coarser;
  }
  return power;
}

} // namespace kerf::image
