#include "texture/weights.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace kerf::texture {

namespace {

void normalise(Shares& shares, const std::size_t n) {
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i)
    sum += shares[i];
  for (std::size_t i = 0; i < n; ++i)
    shares[i] /= sum;
}

/// Adds one triangle's part; u are unit vectors to its corners, d their distances. False if p lies in the triangle,
/// where `shares` then are those in the plane.
bool add_triangle(const Triple& triangle, const std::array<Vec3, 3>& u, const std::array<double, 3>& d,
                  Shares& shares) {
  std::array<double, 3> theta, c, s;
  double half = 0;
  for (int i = 0; i < 3; ++i) {
    theta[i] = 2 * std::asin(std::min(1.0, 0.5 * (u[(i + 1) % 3] - u[(i + 2) % 3]).norm()));
    half += 0.5 * theta[i];
  }
  if (M_PI - half < 1e-9) {
    shares.fill(0);
    for (int i = 0; i < 3; ++i)
      shares[triangle[i]] = std::sin(theta[i]) * d[(i + 1) % 3] * d[(i + 2) % 3];
    return false;
  }
  const double sign = u[0].cross(u[1]).dot(u[2]) > 0 ? 1 : -1;
  for (int i = 0; i < 3; ++i) {
    const double a = std::sin(theta[(i + 1) % 3]), b = std::sin(theta[(i + 2) % 3]);
    c[i] = 2 * std::sin(half) * std::sin(half - theta[i]) / (a * b) - 1;
    s[i] = sign * std::sqrt(std::max(0.0, 1 - c[i] * c[i]));
    if (!(std::abs(s[i]) > 1e-9))
      return true; // p in the plane of the triangle, outside of it: no part
  }
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    shares[triangle[i]] += (theta[i] - c[j] * theta[k] - c[k] * theta[j]) / (d[i] * std::sin(theta[j]) * s[k]);
  }
  return true;
}

} // namespace

void shepard(const std::span<const double> distances, const double power, Shares& shares) {
  double largest = 0;
  for (const double d : distances)
    largest = std::max(largest, d);
  // A point in a face takes all of it, to eleven digits; relative, so that units do not matter.
  const double least = 1e-12 * largest + 1e-300;
  for (std::size_t i = 0; i < distances.size(); ++i)
    shares[i] = power == 1 ? 1 / (distances[i] + least) : std::pow(distances[i] + least, -power);
  normalise(shares, distances.size());
}

bool mean_value(const Vec3& p, const std::span<const Vec3> sources, const std::vector<Triple>& triangles,
                Shares& shares) {
  std::array<Vec3, max_sources> unit;
  std::array<double, max_sources> distance;
  double largest = 0;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    distance[i] = (sources[i] - p).norm();
    largest = std::max(largest, distance[i]);
  }
  Shares found = {};
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (distance[i] <= 1e-9 * largest) {
      shares = {};
      shares[i] = 1;
      return true;
    }
    unit[i] = (sources[i] - p) / distance[i];
  }
  for (const Triple& t : triangles)
    if (!add_triangle(t, {unit[t[0]], unit[t[1]], unit[t[2]]}, {distance[t[0]], distance[t[1]], distance[t[2]]}, found))
      break;
  for (std::size_t i = 0; i < sources.size(); ++i)
    if (!(found[i] >= -1e-12))
      return false;
  normalise(found, sources.size());
  shares = found;
  return true;
}

} // namespace kerf::texture
