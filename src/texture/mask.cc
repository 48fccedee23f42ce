#include "texture/mask.h"

#include "base/error.h"

#include <cmath>
#include <numeric>
#include <string>

namespace kerf::texture {

namespace {

using image::Grey;

/// Calls visit(index) for each pixel connected to `start` through pixels that `is_in` admits and that are marked by it.
template <class IsIn, class Visit>
void flood(const int width, const int height, const int start_column, const int start_row, const IsIn& is_in,
           const Visit& visit) {
  std::vector<std::array<int, 2>> stack = {{start_column, start_row}};
  while (!stack.empty()) {
    const auto [c, r] = stack.back();
    stack.pop_back();
    if (c < 0 || r < 0 || c >= width || r >= height || !is_in(c, r))
      continue;
    visit(c, r);
    for (int dr = -1; dr <= 1; ++dr)
      for (int dc = -1; dc <= 1; ++dc)
        if (dr != 0 || dc != 0)
          stack.push_back({c + dc, r + dr});
  }
}

Grey without_black_border(const image::Colours& colours) {
  constexpr float nearly_black = 8.5f / 255;
  Grey mask(colours.width, colours.height, 1);
  const auto is_in = [&](const int c, const int r) {
    return mask(c, r) > 0 && colours(c, r).maxCoeff() < nearly_black;
  };
  const auto visit = [&](const int c, const int r) { mask(c, r) = 0; };
  for (int c = 0; c < mask.width; ++c)
    for (const int r : {0, mask.height - 1})
      flood(mask.width, mask.height, c, r, is_in, visit);
  for (int r = 0; r < mask.height; ++r)
    for (const int c : {0, mask.width - 1})
      flood(mask.width, mask.height, c, r, is_in, visit);
  return mask;
}

ParameterError refusal(const image::Image& picture, const std::string& rule, const std::string& remedy) {
  return ParameterError(
    Complaint{.path = "Image",
              .value = std::to_string(picture.width()) + " x " + std::to_string(picture.height()) + " pixels",
              .rule = rule,
              .remedy = remedy});
}

} // namespace

Grey mask_of(const image::Image& picture, const Background background) {
  if (std::min(picture.width(), picture.height()) < 8)
    throw refusal(picture, "a section needs at least 8 x 8 pixels", "Take a larger picture");
  Grey mask(picture.width(), picture.height(), 1);
  if (background == Background::black)
    mask = without_black_border(picture.colours);
  else if (background == Background::alpha && picture.has_alpha())
    for (std::size_t i = 0; i < mask.values.size(); ++i)
      mask.values[i] = picture.alpha.values[i] >= 0.5f ? 1.0f : 0.0f;
  if (std::accumulate(mask.values.begin(), mask.values.end(), 0.0) < 16)
    throw refusal(picture, "no part of it is section: its mask is empty", "Check its alpha, or the key Background");
  return mask;
}

image::Raster<int> components(const Grey& mask, const std::size_t least, int& n_components) {
  image::Raster<int> number(mask.width, mask.height, 0);
  std::vector<std::vector<std::size_t>> sets;
  for (int r = 0; r < mask.height; ++r)
    for (int c = 0; c < mask.width; ++c) {
      if (mask(c, r) <= 0.5f || number(c, r) != 0)
        continue;
      sets.emplace_back();
      flood(
        mask.width, mask.height, c, r, [&](const int i, const int j) { return mask(i, j) > 0.5f && number(i, j) == 0; },
        [&](const int i, const int j) {
          number(i, j) = 1;
          sets.back().push_back(mask.index(i, j));
        });
    }
  std::stable_sort(sets.begin(), sets.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  n_components = 0;
  for (const auto& set : sets) {
    const bool counts = set.size() >= least;
    n_components += counts ? 1 : 0;
    for (const std::size_t i : set)
      number.values[i] = counts ? n_components : 0;
  }
  return number;
}

double reach(const Grey& mask, const Vec2& centre, const Vec2& along) {
  const auto is_in = [&](const double s) {
    const Vec2 p = centre + s * along;
    return p[0] >= -0.5 && p[1] >= -0.5 && p[0] <= mask.width - 0.5 && p[1] <= mask.height - 0.5 &&
           image::sample(mask, static_cast<float>(p[0]), static_cast<float>(p[1])) > 0.5f;
  };
  constexpr double step = 0.25;
  double in = std::ceil(std::hypot(mask.width, mask.height) / step) * step, out = in;
  for (; in > 0 && !is_in(in); in -= step)
    out = in;
  for (int i = 0; i < 8 && in > 0; ++i)
    (is_in(0.5 * (in + out)) ? in : out) = 0.5 * (in + out);
  return in;
}

Grey largest_component(const Grey& mask) {
  int n = 0;
  const auto number = components(mask, 1, n);
  Grey result = mask;
  for (std::size_t i = 0; i < result.values.size(); ++i)
    result.values[i] = number.values[i] == 1 ? 1.0f : 0.0f;
  return result;
}

} // namespace kerf::texture
