#include "texture/outline.h"

#include "image/filters.h"
#include "texture/mask.h"
#include "texture/slice.h"

#include <cmath>
#include <limits>
#include <utility>

namespace kerf::texture {

namespace {

using image::Grey;

constexpr int n_pairs = 256;

double cross(const Vec2& a, const Vec2& b) { return a[0] * b[1] - a[1] * b[0]; }

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

/// With n pixels of nothing around it.
Grey padded(const Grey& mask, const int n) {
  Grey result(mask.width + 2 * n, mask.height + 2 * n, 0);
  for (int r = 0; r < mask.height; ++r)
    for (int c = 0; c < mask.width; ++c)
      result(c + n, r + n) = mask(c, r);
  return result;
}

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

/// Positive where the outline turns from the first axis to the second.
double area_of(const Outline& outline) {
  double twice = 0;
  for (std::size_t i = 0; i < outline.size(); ++i)
    twice += cross(outline[i], outline[(i + 1) % outline.size()]);
  return 0.5 * twice;
}

double length_of(const Outline& outline) {
  double length = 0;
  for (std::size_t i = 0; i < outline.size(); ++i)
    length += (outline[(i + 1) % outline.size()] - outline[i]).norm();
  return length;
}

/// Around its mean, divided by its length.
Outline normalised(const Outline& outline, const double length) {
  Vec2 mean = Vec2::Zero();
  for (const Vec2& p : outline)
    mean += p / static_cast<double>(outline.size());
  Outline result;
  for (const Vec2& p : outline)
    result.push_back((p - mean) / length);
  return result;
}

/// Pairs in the same direction from two middles, blurred masks given.
std::vector<warp::Pin> pairs_around(const Grey& section, const Vec2& offset, const Grey& shown) {
  const Vec2 from = middle(section), to = middle(shown);
  std::vector<warp::Pin> pairs = {{from + offset, to}};
  for (int k = 0; k < n_pairs; ++k) {
    const Vec2 along = direction(k, n_pairs);
    pairs.push_back({from + offset + reach(section, from, along) * along, to + reach(shown, to, along) * along});
  }
  return pairs;
}

} // namespace

Outline outline_of(const Grey& mask) {
  constexpr int margin = 4;
  const Grey grey = image::blurred(padded(largest_component(mask), margin), 1);
  std::vector<std::size_t> next = next_edges(grey);
  Outline result;
  for (std::size_t start = 0; start < next.size(); ++start) {
    Outline outline;
    for (std::size_t edge = start; next[edge] != none;) {
      outline.push_back(crossing(grey, edge) - Vec2::Constant(margin));
      edge = std::exchange(next[edge], none);
    }
    if (std::abs(area_of(outline)) > std::abs(area_of(result)))
      result = std::move(outline);
  }
  return result;
}

bool is_star(const Outline& outline, const Vec2& centre, const double least) {
  const std::size_t n = outline.size();
  const double sense = std::copysign(1.0, area_of(outline));
  double angle = 0, furthest = 0;
  for (std::size_t i = 0; i < 2 * n; ++i) { // twice around: it may begin within an undercut
    const Vec2 a = outline[i % n] - centre, b = outline[(i + 1) % n] - centre;
    angle += sense * std::atan2(cross(a, b), a.dot(b));
    furthest = std::max(furthest, angle);
    if ((furthest - angle) * b.norm() > least)
      return false;
  }
  return angle > 3 * M_PI; // the centre lies inside
}

Outline equally_spaced(const Outline& outline, const int n) {
  const double step = length_of(outline) / n;
  Outline result;
  double passed = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2 &a = outline[i], &b = outline[(i + 1) % outline.size()];
    const double length = (b - a).norm();
    for (; static_cast<int>(result.size()) < n && step * static_cast<double>(result.size()) < passed + length;)
      result.push_back(a + (step * static_cast<double>(result.size()) - passed) / length * (b - a));
    passed += length;
  }
  return result;
}

std::vector<warp::Pin> pairs_along(const Outline& from, const Outline& to) {
  constexpr int finer = 8; // starts are tried between the points, too
  const Outline a = equally_spaced(from, n_pairs), b = equally_spaced(to, finer * n_pairs);
  const Outline unit_a = normalised(a, length_of(from)), unit_b = normalised(b, length_of(to));
  const auto other = [&](const int start, const int i) { return (start + finer * i) % (finer * n_pairs); };
  int best = 0;
  double least = 1e300;
  for (int start = 0; start < finer * n_pairs; ++start) {
    double sum = 0;
    for (int i = 0; i < n_pairs; ++i)
      sum += (unit_a[i] - unit_b[other(start, i)]).squaredNorm();
    if (sum < least) {
      least = sum;
      best = start;
    }
  }
  std::vector<warp::Pin> pairs;
  for (int i = 0; i < n_pairs; ++i)
    pairs.push_back({a[i], b[other(best, i)]});
  return pairs;
}

std::vector<warp::Pin> boundary_pairs(const Grey& section, const Vec2& offset, const Grey& mask) {
  // A blur takes the steps of the pixels away.
  const Grey inside = image::blurred(largest_component(section), 1), shown = image::blurred(largest_component(mask), 1);
  const Outline from = outline_of(section), to = outline_of(mask);
  if (is_star(from, middle(inside)) && is_star(to, middle(shown)))
    return pairs_around(inside, offset, shown);
  std::vector<warp::Pin> pairs = pairs_along(from, to);
  for (warp::Pin& pair : pairs)
    pair.from += offset;
  return pairs;
}

} // namespace kerf::texture
