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
  const double scale = 1 / sum;
  for (std::size_t i = 0; i < n; ++i)
    shares[i] *= scale;
}

/// How far below zero a coordinate may be before the point counts as not enclosed at all.
constexpr double margin_of_weights = 0.1;

/// Adds one triangle's part: the mean of the directions in which it is seen, divided among its corners. u are unit
/// vectors to these, d their distances. False if p lies in the triangle, where `shares` then are those in the plane.
bool add_triangle(const Triple& triangle, const std::array<Vec3, 3>& u, const std::array<double, 3>& d,
                  Shares& shares) {
  constexpr double flat = 1e-8; // of the determinant: below, what is left out is as small
  std::array<Vec3, 3> across;
  Vec3 mean = Vec3::Zero();
  double around = 0;
  for (int i = 0; i < 3; ++i) {
    across[i] = u[(i + 1) % 3].cross(u[(i + 2) % 3]);
    const double sine = across[i].norm(), angle = std::atan2(sine, u[(i + 1) % 3].dot(u[(i + 2) % 3]));
    around += angle;
    if (sine > 0)
      mean += 0.5 * angle / sine * across[i];
  }
  const double determinant = u[0].dot(across[0]);
  if (std::abs(determinant) < flat) {
    if (around < 2 * M_PI - 1e-6)
      return true; // p in the plane of the triangle, outside of it: no part
    shares.fill(0);
    for (int i = 0; i < 3; ++i)
      shares[triangle[i]] = across[i].norm() * d[(i + 1) % 3] * d[(i + 2) % 3];
    return false;
  }
  for (int i = 0; i < 3; ++i)
    shares[triangle[i]] += across[i].dot(mean) / (d[i] * determinant);
  return true;
}

/// Makes coordinates sum to 1 and takes what is below zero away. Returns how far they enclosed the point.
double enclosed_part(Shares& shares, const std::size_t n) {
  double sum = 0, least = 0;
  for (std::size_t i = 0; i < n; ++i)
    sum += shares[i];
  for (std::size_t i = 0; i < n; ++i) {
    shares[i] /= sum;
    if (!std::isfinite(shares[i]))
      return 0;
    least = std::min(least, shares[i]);
    shares[i] = std::max(shares[i], 0.0);
  }
  normalise(shares, n);
  return std::max(0.0, 1 + least / margin_of_weights);
}

} // namespace

void shepard(const std::span<const double> distances, const double power, Shares& shares) {
  double largest = 0;
  for (const double d : distances)
    largest = std::max(largest, d);
  // A point in a face takes all of it, to eleven digits; relative, so that units do not matter.
  const double least = 1e-12 * largest + 1e-300;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const double d = distances[i] + least;
    shares[i] = power == 1 ? 1 / d : power == 2 ? 1 / (d * d) : std::pow(d, -power); // a power takes long
  }
  normalise(shares, distances.size());
}

double mean_value(const Vec3& p, const std::span<const Vec3> sources, const std::vector<Triple>& triangles,
                  Shares& shares) {
  std::array<Vec3, max_sources> unit;
  std::array<double, max_sources> distance;
  double largest = 0;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    distance[i] = (sources[i] - p).norm();
    largest = std::max(largest, distance[i]);
  }
  shares = {};
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (distance[i] <= 1e-12 * largest) {
      shares[i] = 1;
      return 1;
    }
    unit[i] = (sources[i] - p) / distance[i];
  }
  for (const Triple& t : triangles)
    if (!add_triangle(t, {unit[t[0]], unit[t[1]], unit[t[2]]}, {distance[t[0]], distance[t[1]], distance[t[2]]},
                      shares))
      break;
  return enclosed_part(shares, sources.size());
}

void enclose(const Vec3& p, const std::span<const Vec3> sources, const std::vector<Triple>& triangles, Shares& shares) {
  Shares inner;
  double part = mean_value(p, sources, triangles, inner);
  for (std::size_t i = 0; i < sources.size(); ++i)
    if (inner[i] < 1)
      part = std::min(part, 2 * (1 - shares[i]) / (1 - inner[i]));
  for (std::size_t i = 0; part > 0 && i < sources.size(); ++i)
    shares[i] += part * (inner[i] - shares[i]);
}

} // namespace kerf::texture
