#include "texture/outline.h"

#include "image/distance.h"
#include "image/filters.h"
#include "texture/mask.h"
#include "texture/slice.h"

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

/// The mean of a mask's pixels.
Vec2 middle(const Grey& mask) {
  Vec2 sum = Vec2::Zero();
  double n = 0;
  for (int r = 0; r < mask.height; ++r)
    for (int c = 0; c < mask.width; ++c)
      if (mask(c, r) > 0.5f) {
        sum += Vec2(c, r);
        ++n;
      }
  return sum / std::max(n, 1.0);
}

/// How far a mask reaches in each direction.
struct Star {
  Vec2 middle;
  warp::Curve ends;
  double other; ///< what lies between and is not section, or is section and lies elsewhere, over the area [1]
};

/// Rays leave the middle in directions that `linear` has turned.
Star star_of(const Grey& mask, const warp::Curve& outline, const Mat2& linear) {
  constexpr int n_directions = 256;
  const Grey largest = largest_component(mask);
  const Grey smooth = image::blurred(largest, 1); // takes the steps of the pixels away
  Star star{middle(largest), {}, 0};
  for (int k = 0; k < n_directions; ++k) {
    const Vec2 along = (linear * direction(k, n_directions)).normalized();
    star.ends.push_back(star.middle + reach(smooth, star.middle, along) * along);
  }
  const double area = std::abs(warp::area_of(outline));
  star.other = (std::abs(warp::area_of(star.ends)) - area + sum_of(mask) - sum_of(largest)) / area;
  return star;
}

/// Empty if one is no star.
std::vector<warp::Pin> by_rays(const Star& from, const Star& to) {
  constexpr double most = 0.005;
  if (std::max(from.other, to.other) > most)
    return {};
  std::vector<warp::Pin> pairs = {{from.middle, to.middle}};
  for (std::size_t k = 0; k < from.ends.size(); ++k)
    pairs.push_back({from.ends[k], to.ends[k]});
  return pairs;
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
  const warp::Curve from = outline_of(section), to = outline_of(picture);
  const Mat2 linear = warp::affine_between(from, to).linear;
  const auto around = [&](const Grey& within, const Grey& shown, std::vector<warp::Pin> rays) {
    return Outlines{outline_of(within), outline_of(shown), within, size_of(section) / size_of(within), std::move(rays)};
  };
  std::vector<warp::Pin> rays = by_rays(star_of(section, from, Mat2::Identity()), star_of(picture, to, linear));
  if (!rays.empty())
    return around(largest_component(section), picture, std::move(rays));
  constexpr double least = 0.05, most = 0.2, enough = 0.9;
  for (double part = least; part <= most; part *= 1.5) {
    const Whole a = whole(section, part), b = whole(picture, part);
    if (std::min(a.share, b.share) >= enough)
      return around(a.mask, b.mask, {});
  }
  return around(whole(section, least).mask, whole(picture, least).mask, {});
}

warp::Gap gap_after(const warp::LatticeMap& map, const Outlines& outlines) {
  warp::Curve there;
  for (const Vec2& p : outlines.section)
    there.push_back(map(p));
  const warp::Gap a = warp::gap(there, outlines.picture), b = warp::gap(outlines.picture, there);
  return {std::max(a.mean, b.mean), std::max(a.largest, b.largest)};
}

warp::LatticeMap fitted(const Outlines& outlines, warp::FitOptions options) {
  const Vec2 lower = Vec2::Zero(), upper(outlines.within.width - 1, outlines.within.height - 1);
  // As fine as on a section of one part, where others widen the box.
  options.n_cells *= std::max(1.0, 0.25 * std::lround(4 * outlines.wider)); // closing may widen it
  return outlines.by_rays.empty()
           ? warp::fit(outlines.section, outlines.picture, outlines.within, lower, upper, options)
           : warp::fit(outlines.by_rays, warp::affine_between(outlines.section, outlines.picture), lower, upper,
                       options);
}

} // namespace kerf::texture
