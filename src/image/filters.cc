#include "image/filters.h"

#include <cmath>

namespace kerf::image {

namespace {

std::vector<float> gaussian(const double sigma) {
  const int radius = static_cast<int>(std::ceil(3 * sigma));
  std::vector<float> weights(2 * radius + 1);
  double sum = 0;
  for (int i = -radius; i <= radius; ++i)
    sum += std::exp(-0.5 * i * i / (sigma * sigma));
  for (int i = -radius; i <= radius; ++i)
    weights[i + radius] = static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma)) / sum);
  return weights;
}

template <class Value>
Raster<Value> convolved(const Raster<Value>& in, const std::vector<float>& weights, const Value& zero) {
  const int radius = static_cast<int>(weights.size()) / 2;
  Raster<Value> rows(in.width, in.height, zero), result = rows;
  for (int r = 0; r < in.height; ++r)
    for (int c = 0; c < in.width; ++c) {
      Value sum = zero;
      for (int i = -radius; i <= radius; ++i)
        sum += weights[i + radius] * in.clamped(c + i, r);
      rows(c, r) = sum;
    }
  for (int r = 0; r < in.height; ++r)
    for (int c = 0; c < in.width; ++c) {
      Value sum = zero;
      for (int i = -radius; i <= radius; ++i)
        sum += weights[i + radius] * rows.clamped(c, r + i);
      result(c, r) = sum;
    }
  return result;
}

/// Colours times coverage, and coverage.
using Covered = Eigen::Array4f;

Raster<Covered> halved(const Raster<Covered>& fine) {
  Raster<Covered> coarse((fine.width + 1) / 2, (fine.height + 1) / 2, Covered::Zero());
  for (int r = 0; r < fine.height; ++r)
    for (int c = 0; c < fine.width; ++c)
      coarse(c / 2, r / 2) += fine(c, r);
  for (Covered& value : coarse.values)
    if (value[3] > 1)
      value /= value[3];
  return coarse;
}

/// What the finer level lacks of full coverage comes from the coarser one, between its pixels.
void pull(const Raster<Covered>& coarse, Raster<Covered>& fine) {
  const bool thin = coarse.width < 2 || coarse.height < 2;
  for (int r = 0; r < fine.height; ++r)
    for (int c = 0; c < fine.width; ++c) {
      Covered& value = fine(c, r);
      if (value[3] >= 1)
        continue;
      const Covered below =
        thin ? coarse.clamped(c / 2, r / 2)
             : sample(coarse, 0.5f * static_cast<float>(c) - 0.25f, 0.5f * static_cast<float>(r) - 0.25f);
      if (below[3] > 0)
        value += (1 - value[3]) * (below / below[3]);
    }
}

} // namespace

Grey blurred(const Grey& grey, const double sigma) { return sigma > 0 ? convolved(grey, gaussian(sigma), 0.0f) : grey; }

Colours blurred(const Colours& colours, const double sigma) {
  return sigma > 0 ? convolved(colours, gaussian(sigma), Rgb(Rgb::Zero())) : colours;
}

Grey blurred_inside(const Grey& grey, const Grey& mask, const double sigma) {
  Grey masked = grey;
  for (std::size_t i = 0; i < masked.values.size(); ++i)
    masked.values[i] *= mask.values[i];
  masked = blurred(masked, sigma);
  const Grey share = blurred(mask, sigma);
  for (std::size_t i = 0; i < masked.values.size(); ++i)
    masked.values[i] = share.values[i] > 1e-6f ? masked.values[i] / share.values[i] : 0;
  return masked;
}

std::vector<Colours> gaussian_stack(const Colours& colours, const int n_levels) {
  std::vector<Colours> stack = {colours};
  for (int k = 1; k < n_levels; ++k)
    stack.push_back(blurred(colours, std::ldexp(1.0, k - 1)));
  return stack;
}

std::vector<Grey> pyramid(const Grey& grey, const int n_levels) {
  std::vector<Grey> levels = {grey};
  while (static_cast<int>(levels.size()) < n_levels && std::min(levels.back().width, levels.back().height) >= 4) {
    const Grey fine = blurred(levels.back(), 1.0);
    Grey coarse((fine.width + 1) / 2, (fine.height + 1) / 2, 0);
    for (int r = 0; r < coarse.height; ++r)
      for (int c = 0; c < coarse.width; ++c)
        coarse(c, r) = fine(2 * c, 2 * r);
    levels.push_back(std::move(coarse));
  }
  return levels;
}

Grey resized(const Grey& grey, const int width, const int height) {
  Grey result(width, height, 0);
  const auto scale = [](const int from, const int to) {
    return to > 1 ? static_cast<float>(from - 1) / static_cast<float>(to - 1) : 0.0f;
  };
  const float sx = scale(grey.width, width), sy = scale(grey.height, height);
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c)
      result(c, r) = sample(grey, sx * static_cast<float>(c), sy * static_cast<float>(r));
  return result;
}

Grey padded(const Grey& grey, const int n) {
  Grey result(grey.width + 2 * n, grey.height + 2 * n, 0);
  for (int r = 0; r < grey.height; ++r)
    for (int c = 0; c < grey.width; ++c)
      result(c + n, r + n) = grey(c, r);
  return result;
}

Grey edge_strength(const Colours& colours) {
  Grey edges(colours.width, colours.height, 0);
  for (int r = 0; r < colours.height; ++r)
    for (int c = 0; c < colours.width; ++c) {
      const Rgb x = 0.5f * (colours.clamped(c + 1, r) - colours.clamped(c - 1, r));
      const Rgb y = 0.5f * (colours.clamped(c, r + 1) - colours.clamped(c, r - 1));
      const float xx = x.square().sum(), yy = y.square().sum(), xy = (x * y).sum();
      edges(c, r) = std::sqrt(0.5f * (xx + yy + std::sqrt((xx - yy) * (xx - yy) + 4 * xy * xy)));
    }
  return edges;
}

Colours filled(const Colours& colours, const Grey& mask) {
  std::vector<Raster<Covered>> levels = {Raster<Covered>(colours.width, colours.height, Covered::Zero())};
  for (std::size_t i = 0; i < colours.values.size(); ++i)
    if (mask.values[i] >= 0.5f)
      levels[0].values[i] = Covered(colours.values[i][0], colours.values[i][1], colours.values[i][2], 1);
  while (levels.back().width > 1 || levels.back().height > 1)
    levels.push_back(halved(levels.back()));
  for (std::size_t k = levels.size() - 1; k > 0; --k)
    pull(levels[k], levels[k - 1]);
  Colours result = colours;
  for (std::size_t i = 0; i < result.values.size(); ++i)
    result.values[i] = levels[0].values[i].head<3>();
  return result;
}

} // namespace kerf::image
