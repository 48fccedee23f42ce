#include "texture/slice.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <optional>

namespace kerf::texture {

std::vector<Segment> slice(const geometry::TriangleMesh& mesh, const Frame& frame) {
  const Vec3 normal = frame.normal();
  std::vector<double> heights;
  heights.reserve(mesh.vertices.size());
  for (const Vec3& v : mesh.vertices)
    heights.push_back(normal.dot(v - frame.origin));
  std::vector<Segment> segments;
  const auto crossing = [&](std::uint32_t a, std::uint32_t b) {
    if (a > b)
      std::swap(a, b); // the same bits from both triangles
    const double s = heights[a] / (heights[a] - heights[b]);
    const Vec3 p = mesh.vertices[a] + s * (mesh.vertices[b] - mesh.vertices[a]) - frame.origin;
    return Vec2(frame.x.dot(p), frame.y.dot(p));
  };
  for (const Triangle& t : mesh.triangles) {
    const std::array<bool, 3> above = {heights[t[0]] >= 0, heights[t[1]] >= 0, heights[t[2]] >= 0};
    if (above[0] == above[1] && above[1] == above[2])
      continue;
    const int lone = above[1] == above[2] ? 0 : above[0] == above[2] ? 1 : 2;
    segments.push_back({crossing(t[lone], t[(lone + 1) % 3]), crossing(t[lone], t[(lone + 2) % 3])});
  }
  return segments;
}

Vec2 direction(const int number, const int n_directions) {
  const double quarters = 4.0 * number / n_directions;
  const int quarter = static_cast<int>(quarters);
  const double u = quarters - quarter;
  const std::array<Vec2, 4> corners = {Vec2(1 - u, u), Vec2(-u, 1 - u), Vec2(u - 1, -u), Vec2(u, u - 1)};
  return corners[quarter % 4].normalized();
}

namespace {

double cross(const Vec2& a, const Vec2& b) { return a[0] * b[1] - a[1] * b[0]; }

/// How far along a direction the half spaces allow [m]: from, to.
std::array<double, 2> allowed(const Frame& frame, const std::vector<HalfSpace>& halves, const Vec2& centre,
                              const Vec2& along) {
  const Vec3 p = frame.origin + centre[0] * frame.x + centre[1] * frame.y;
  const Vec3 d = along[0] * frame.x + along[1] * frame.y;
  std::array<double, 2> range = {0, 1e300};
  for (const HalfSpace& half : halves) {
    const double rate = half.normal.dot(d), gap = half.offset - half.normal.dot(p);
    if (rate > 0)
      range[1] = std::min(range[1], gap / rate);
    else if (rate < 0)
      range[0] = std::max(range[0], gap / rate);
    else if (gap < 0)
      range[1] = -1;
  }
  return range;
}

/// Where a ray leaves the inside, in the range: of several places the one next to `guess`, of equally near ones the
/// outermost. `crossings` are where it crosses the curves.
double way_out(std::vector<double>& crossings, const std::array<double, 2>& range, const double guess) {
  if (!(range[1] > range[0]))
    return 0;
  std::sort(crossings.begin(), crossings.end());
  double best = 0, gap = 1e301;
  const auto consider = [&](const double place) {
    if (std::abs(place - guess) <= gap) {
      best = place;
      gap = std::abs(place - guess);
    }
  };
  std::size_t n_beyond = crossings.size();
  for (const double place : crossings) {
    if (place > range[1])
      break;
    if (n_beyond-- % 2 == 1 && place > range[0])
      consider(place);
  }
  if (n_beyond % 2 == 1)
    consider(range[1]);
  return best;
}

} // namespace

std::vector<double> radii(const std::vector<Segment>& slice, const Frame& frame, const std::vector<HalfSpace>& halves,
                          const Vec2& centre, const int n_directions, const std::vector<double>& guess) {
  std::vector<std::vector<double>> crossings(n_directions);
  std::vector<Vec2> directions;
  for (int k = 0; k < n_directions; ++k)
    directions.push_back(direction(k, n_directions));
  for (const Segment& segment : slice) {
    Vec2 a = segment[0] - centre, b = segment[1] - centre;
    if (cross(a, b) < 0)
      std::swap(a, b);
    // Counter-clockwise from a to b, by less than half a turn.
    const double first = direction_number(a[0], a[1], n_directions), last = direction_number(b[0], b[1], n_directions);
    const int begin = static_cast<int>(std::ceil(first));
    const int n = static_cast<int>(std::ceil(last < first ? last + n_directions : last)) - begin;
    for (int i = 0; i < n; ++i) {
      const int k = (begin + i) % n_directions;
      const double rate = cross(directions[k], b - a);
      if (rate != 0)
        crossings[k].push_back(cross(a, b - a) / rate);
    }
  }
  std::vector<double> result;
  for (int k = 0; k < n_directions; ++k)
    result.push_back(
      way_out(crossings[k], allowed(frame, halves, centre, directions[k]), guess.empty() ? 1e300 : guess[k]));
  return result;
}

Vec2 star_middle(const Vec2& centre, const std::vector<double>& radii) {
  const int n = static_cast<int>(radii.size());
  Vec2 sum = Vec2::Zero();
  double area = 0;
  for (int k = 0; k < n; ++k) {
    const Vec2 a = radii[k] * direction(k, n), b = radii[(k + 1) % n] * direction((k + 1) % n, n);
    area += cross(a, b);
    sum += cross(a, b) / 3 * (a + b);
  }
  return area > 0 ? Vec2(centre + sum / area) : centre;
}

image::Grey inside_of(const std::vector<Segment>& curves, const int width, const int height) {
  std::vector<std::vector<double>> crossings(height);
  for (const Segment& segment : curves) {
    const auto& [a, b] = segment[0][1] <= segment[1][1] ? segment : Segment{segment[1], segment[0]};
    const int first = std::max(0, static_cast<int>(std::ceil(a[1])));
    const int last = std::min(height - 1, static_cast<int>(std::ceil(b[1])) - 1);
    for (int r = first; r <= last; ++r)
      crossings[r].push_back(a[0] + (r - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
  }
  image::Grey inside(width, height, 0);
  for (int r = 0; r < height; ++r) {
    std::sort(crossings[r].begin(), crossings[r].end());
    for (std::size_t i = 0; i + 1 < crossings[r].size(); i += 2) {
      const int first = std::max(0, static_cast<int>(std::ceil(crossings[r][i])));
      const int last = std::min(width - 1, static_cast<int>(std::floor(crossings[r][i + 1])));
      for (int c = first; c <= last; ++c)
        inside(c, r) = 1;
    }
  }
  return inside;
}

} // namespace kerf::texture
