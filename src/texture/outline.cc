#include "texture/outline.h"

#include "image/distance.h"
#include "image/filters.h"
#include "texture/mask.h"

#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace kerf::texture {

namespace {

using image::Grey;

/// An edge between two pixels by number: each pixel has one to the right and one down.
struct GridEdge {
  int column, row;
  bool is_down;
  std::size_t number(const Grey& grey) const { return 2 * grey.index(column, row) + (is_down ? 1 : 0); }
};

/// Where a border crosses an edge it goes to another edge of the cell ahead: marching squares, in which pixels of the
/// mask that touch at a corner hang together. Indexed by edge, of which `none` are not crossed.
constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
std::vector<std::size_t> next_edges(const Grey& grey) {
  std::vector<std::size_t> next(2 * grey.values.size(), none);
  for (int r = 0; r + 1 < grey.height; ++r)
    for (int c = 0; c + 1 < grey.width; ++c) {
      const std::array<bool, 4> in = {grey(c, r) > 0.5f, grey(c + 1, r) > 0.5f, grey(c + 1, r + 1) > 0.5f,
                                      grey(c, r + 1) > 0.5f};
      const std::array<GridEdge, 4> edges = {{{c, r, false}, {c + 1, r, true}, {c, r + 1, false}, {c, r, true}}};
      for (int k = 0; k < 4; ++k) {
        if (!in[k] || in[(k + 1) % 4])
          continue;
        int entry = (k + 1) % 4;
        while (!in[(entry + 1) % 4])
          entry = (entry + 1) % 4;
        next[edges[k].number(grey)] = edges[entry].number(grey);
      }
    }
  return next;
}

/// Where the values pass a half on an edge.
Vec2 crossing(const Grey& grey, const std::size_t edge) {
  const std::size_t pixel = edge / 2, other = pixel + (edge % 2 == 0 ? 1 : grey.width);
  const double t = (0.5 - grey.values[pixel]) / (grey.values[other] - grey.values[pixel]);
  const Vec2 p(static_cast<double>(pixel % grey.width), static_cast<double>(pixel / grey.width));
  return p + (edge % 2 == 0 ? Vec2(t, 0) : Vec2(0, t));
}

double sum_of(const Grey& mask) { return std::accumulate(mask.values.begin(), mask.values.end(), 0.0); }

/// The longer side of a mask's box [pixels].
double size_of(const Grey& mask) {
  int left = mask.width, right = 0, top = mask.height, bottom = 0;
  for (int r = 0; r < mask.height; ++r)
    for (int c = 0; c < mask.width; ++c)
      if (mask(c, r) > 0.5f) {
        left = std::min(left, c);
        right = std::max(right, c);
        top = std::min(top, r);
        bottom = std::max(bottom, r);
      }
  return std::max(right - left, bottom - top);
}

/// A mask without bays narrower than a part of its size, and of what it then is the largest component.
struct Whole {
  Grey mask;
  double share; ///< of its pixels
};

Whole whole(const Grey& mask, const double part) {
  const Grey closed = image::closed(mask, 0.5 * part * size_of(mask));
  Grey largest = largest_component(closed);
  const double share = sum_of(largest) / sum_of(closed);
  return {std::move(largest), share};
}

} // namespace

warp::Curve outline_of(const Grey& mask) {
  constexpr int margin = 4;
  const Grey grey = image::blurred(image::padded(largest_component(mask), margin), 1);
  std::vector<std::size_t> next = next_edges(grey);
  warp::Curve result;
  for (std::size_t start = 0; start < next.size(); ++start) {
    warp::Curve outline;
    for (std::size_t edge = start; next[edge] != none;) {
      outline.push_back(crossing(grey, edge) - Vec2::Constant(margin));
      edge = std::exchange(next[edge], none);
    }
    if (!outline.empty() && std::abs(warp::area_of(outline)) > std::abs(warp::area_of(result)))
      result = std::move(outline);
  }
  return result;
}

Outlines outlines_of(const Grey& section, const Grey& picture) {
  constexpr double least = 0.05, most = 0.2, enough = 0.9;
  for (double part = least; part <= most; part *= 1.5) {
    Whole a = whole(section, part);
    const Whole b = whole(picture, part);
    if (std::min(a.share, b.share) >= enough)
      return {outline_of(a.mask), outline_of(b.mask), std::move(a.mask)};
  }
  Whole a = whole(section, least);
  return {outline_of(a.mask), outline_of(whole(picture, least).mask), std::move(a.mask)};
}

} // namespace kerf::texture
