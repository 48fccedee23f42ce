#include "warp/curve.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace kerf::warp {

namespace {

constexpr double turn_weight = 0.005; ///< of directions that differ, against squared distances over the area
constexpr double pace_weight = 0.008; ///< of steps that differ from the mean one
constexpr int longest_step = 4;       ///< of mean ones
constexpr float never = std::numeric_limits<float>::infinity();

double length_of(const Curve& curve) {
  double length = 0;
  for (std::size_t i = 0; i < curve.size(); ++i)
    length += (curve[(i + 1) % curve.size()] - curve[i]).norm();
  return length;
}

/// Unit vectors along a curve at its points, over a part of its length that the steps of pixels do not turn.
Curve directions(const Curve& curve) {
  Curve result;
  const std::size_t n = curve.size(), reach = std::max<std::size_t>(1, n / 32);
  for (std::size_t i = 0; i < n; ++i)
    result.push_back((curve[(i + reach) % n] - curve[(i + n - reach) % n]).normalized());
  return result;
}

double distance(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  const double squared = along.squaredNorm();
  const double t = squared > 0 ? std::clamp((p - a).dot(along) / squared, 0.0, 1.0) : 0.0;
  return (p - a - t * along).norm();
}

/// What pairs and steps between them cost.
struct Costs {
  int n, m;                 ///< points of the two curves
  std::vector<float> pairs; ///< n x m
  std::vector<float> steps; ///< by how many points of the second curve
  float pair(const int i, const int j) const { return pairs[static_cast<std::size_t>(i % n) * m + j % m]; }
};

Costs costs(const Curve& from, const Curve& to) {
  Costs result{static_cast<int>(from.size()), static_cast<int>(to.size()), {}, {}};
  const double unit = std::abs(area_of(to));
  const Curve along_from = directions(from), along_to = directions(to);
  for (std::size_t i = 0; i < from.size(); ++i)
    for (std::size_t j = 0; j < to.size(); ++j)
      result.pairs.push_back(static_cast<float>((from[i] - to[j]).squaredNorm() / unit +
                                                turn_weight * (1 - along_from[i].dot(along_to[j]))));
  const double mean = static_cast<double>(result.m) / result.n;
  for (int k = 0; k <= longest_step * mean; ++k)
    result.steps.push_back(static_cast<float>(pace_weight * std::pow(k / mean - 1, 2)));
  return result;
}

/// The cheapest way from row 0 to row n_rows - 1 of a table, forwards only: its column in each row. `best` holds what
/// the columns of row 0 cost. It ends in column `end`, or wherever is cheapest if that is negative.
std::vector<int> cheapest_way(const Costs& costs, const int n_rows, std::vector<float> best, const int end) {
  const int width = static_cast<int>(best.size()), n_steps = static_cast<int>(costs.steps.size());
  std::vector<std::uint8_t> taken(static_cast<std::size_t>(n_rows) * width);
  std::vector<float> next(width);
  for (int i = 1; i < n_rows; ++i) {
    for (int j = 0; j < width; ++j) {
      next[j] = never;
      for (int k = 0; k < std::min(n_steps, j + 1); ++k)
        if (const float value = best[j - k] + costs.steps[k]; value < next[j]) {
          next[j] = value;
          taken[static_cast<std::size_t>(i) * width + j] = static_cast<std::uint8_t>(k);
        }
      next[j] += costs.pair(i, j);
    }
    best.swap(next);
  }
  std::vector<int> way(n_rows);
  int j = end >= 0 ? end : static_cast<int>(std::min_element(best.begin(), best.end()) - best.begin());
  for (int i = n_rows - 1; i >= 0; --i) {
    way[i] = j;
    j -= taken[static_cast<std::size_t>(i) * width + j];
  }
  return way;
}

/// The partner of the first point: after one time around of two, beginning anywhere, neither end counts much.
int first_partner(const Costs& costs) {
  std::vector<float> start(3 * costs.m, never);
  for (int j = 0; j < costs.m; ++j)
    start[j] = costs.pair(0, j);
  return cheapest_way(costs, 2 * costs.n, start, -1)[costs.n] % costs.m;
}

} // namespace

double area_of(const Curve& curve) {
  double twice = 0;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const Vec2 &a = curve[i], &b = curve[(i + 1) % curve.size()];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return 0.5 * twice;
}

Moments moments_of(const Curve& curve) {
  // Sums over the triangles from the first point to each side.
  const Vec2 origin = curve.front();
  double twice = 0;
  Vec2 first = Vec2::Zero();
  Mat2 second = Mat2::Zero();
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const Vec2 a = curve[i] - origin, b = curve[(i + 1) % curve.size()] - origin, c = a + b;
    const double cross = a[0] * b[1] - a[1] * b[0];
    twice += cross;
    first += cross / 3 * c;
    second += cross / 12 * (a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  const Vec2 mean = first / twice;
  return {origin + mean, second / twice - mean * mean.transpose()};
}

Curve equally_spaced(const Curve& curve, const int n) {
  const double step = length_of(curve) / n;
  Curve result;
  double passed = 0;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const Vec2 &a = curve[i], &b = curve[(i + 1) % curve.size()];
    const double length = (b - a).norm();
    for (; static_cast<int>(result.size()) < n && step * static_cast<double>(result.size()) < passed + length;)
      result.push_back(a + (step * static_cast<double>(result.size()) - passed) / length * (b - a));
    passed += length;
  }
  result.resize(n, curve.front()); // where rounding has lost the last
  return result;
}

Gap gap(const Curve& from, const Curve& to) {
  Gap result;
  for (const Vec2& p : from) {
    double least = 1e300;
    for (std::size_t i = 0; i < to.size(); ++i)
      least = std::min(least, distance(p, to[i], to[(i + 1) % to.size()]));
    result.mean += least / static_cast<double>(from.size());
    result.largest = std::max(result.largest, least);
  }
  return result;
}

std::vector<int> partners(const Curve& from, const Curve& to) {
  const int m = static_cast<int>(to.size());
  const int first = first_partner(costs(from, to));
  Curve turned = to;
  std::rotate(turned.begin(), turned.begin() + first, turned.end());
  std::vector<float> start(m + 1, never);
  start[0] = 0;
  std::vector<int> result = cheapest_way(costs(from, turned), static_cast<int>(from.size()) + 1, start, m);
  result.pop_back();
  for (int& j : result)
    j = (j + first) % m;
  return result;
}

} // namespace kerf::warp
