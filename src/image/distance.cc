#include "image/distance.h"

#include "image/filters.h"

#include <cmath>
#include <vector>

namespace kerf::image {

namespace {

/// A parabola of the envelope: its lowest place, and from where on it is the lowest of all.
struct Parabola {
  int place;
  double begin;
};

/// Where the parabola over `b` falls below that over `a` < b.
double meeting(const std::vector<double>& heights, const int a, const int b) {
  return (heights[b] + double(b) * b - heights[a] - double(a) * a) / (2.0 * (b - a));
}

/// heights[i] becomes the least of heights[j] + (i - j)^2.
void spread(std::vector<double>& heights, std::vector<Parabola>& envelope) {
  const int n = static_cast<int>(heights.size());
  envelope.assign(1, {0, -1e300});
  for (int i = 1; i < n; ++i) {
    while (envelope.size() > 1 && meeting(heights, envelope.back().place, i) <= envelope.back().begin)
      envelope.pop_back();
    envelope.push_back({i, meeting(heights, envelope.back().place, i)});
  }
  const std::vector<double> before = heights;
  std::size_t k = 0;
  for (int i = 0; i < n; ++i) {
    while (k + 1 < envelope.size() && envelope[k + 1].begin <= i)
      ++k;
    const double away = i - envelope[k].place;
    heights[i] = before[envelope[k].place] + away * away;
  }
}

Grey complement(const Grey& mask) {
  Grey result = mask;
  for (float& value : result.values)
    value = value > 0.5f ? 0.0f : 1.0f;
  return result;
}

/// 1 within a radius of a mask.
Grey grown(const Grey& mask, const double radius) {
  const Raster<double> distances = squared_distances(mask);
  Grey result = mask;
  for (std::size_t i = 0; i < result.values.size(); ++i)
    result.values[i] = distances.values[i] <= radius * radius ? 1.0f : 0.0f;
  return result;
}

} // namespace

Raster<double> squared_distances(const Grey& mask) {
  Raster<double> result(mask.width, mask.height, 0);
  for (std::size_t i = 0; i < mask.values.size(); ++i)
    result.values[i] = mask.values[i] > 0.5f ? 0 : 1e12;
  std::vector<Parabola> envelope;
  std::vector<double> line(mask.height);
  for (int c = 0; c < mask.width; ++c) {
    for (int r = 0; r < mask.height; ++r)
      line[r] = result(c, r);
    spread(line, envelope);
    for (int r = 0; r < mask.height; ++r)
      result(c, r) = line[r];
  }
  line.resize(mask.width);
  for (int r = 0; r < mask.height; ++r) {
    for (int c = 0; c < mask.width; ++c)
      line[c] = result(c, r);
    spread(line, envelope);
    for (int c = 0; c < mask.width; ++c)
      result(c, r) = line[c];
  }
  return result;
}

Grey closed(const Grey& mask, const double radius) {
  const int margin = static_cast<int>(std::ceil(radius)) + 1; // what is outside of the picture is outside of the mask
  const Grey wide = padded(mask, margin);
  const Grey outside = grown(complement(grown(wide, radius)), radius);
  Grey result = mask;
  for (int r = 0; r < mask.height; ++r)
    for (int c = 0; c < mask.width; ++c)
      result(c, r) = mask(c, r) > 0.5f || outside(c + margin, r + margin) < 0.5f ? 1.0f : 0.0f;
  return result;
}

} // namespace kerf::image
