#pragma once

/// Clouds of phyxels that tests make themselves, with fixed seeds.

#include "dynamics/state.h"
#include "pba/model.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

namespace kerf::pba {

/// A figure for the test's report.
inline void record(const std::string& name, const double value) { testing::Test::RecordProperty(name, to_text(value)); }

/// Random numbers with a fixed seed, the same everywhere.
class Draw {
 public:
  explicit Draw(const unsigned seed) : engine_(seed) {}

  double operator()(const double lower, const double upper) {
    return lower + (upper - lower) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  std::size_t below(const std::size_t n) { return engine_() % n; }
  Vec3 vector() {
    Vec3 v;
    for (int axis = 0; axis < 3; ++axis)
      v[axis] = (*this)(-1, 1);
    return v;
  }
  Mat3 matrix() {
    Mat3 A;
    A << vector(), vector(), vector();
    return A;
  }
  Mat3 rotation() {
    const Vec3 axis = vector().normalized();
    return Eigen::AngleAxisd((*this)(0, 3), axis).toRotationMatrix();
  }

 private:
  std::mt19937_64 engine_;
};

/// Equal volumes, supports by neighbours.
inline Phyxels make_phyxels(Points rest, const double volume, const int n_neighbours) {
  Phyxels phyxels{std::move(rest), {}, {}};
  phyxels.volume.assign(phyxels.size(), volume / static_cast<double>(phyxels.size()));
  phyxels.support = make_supports(phyxels.rest, {.n_neighbours = n_neighbours});
  return phyxels;
}

/// n[0] x n[1] x n[2] cubes of edge s from the origin, a point in each, shifted by up to jitter s / 2 along each axis.
inline Points grid_points(const Index3& n, const double s, const double jitter, Draw& draw) {
  Points points;
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i)
        points.push_back(s * (Vec3(i + 0.5, j + 0.5, k + 0.5) + 0.5 * jitter * draw.vector()));
  return points;
}

inline Points random_points(const std::size_t n, Draw& draw) {
  Points points(n);
  for (Vec3& p : points)
    p = draw.vector();
  return points;
}

inline Points mapped(const Points& points, const Mat3& F, const Vec3& shift) {
  Points x;
  for (const Vec3& p : points)
    x.push_back(F * p + shift);
  return x;
}

inline Points disturbed(Points x, const double size, Draw& draw) {
  for (Vec3& p : x)
    p += size * draw.vector();
  return x;
}

inline Vec3 total(const Points& forces) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& f : forces)
    sum += f;
  return sum;
}

inline Vec3 torque(const Points& x, const Points& forces) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < x.size(); ++i)
    sum += x[i].cross(forces[i]);
  return sum;
}

inline double greatest(const Points& forces) {
  double most = 0;
  for (const Vec3& f : forces)
    most = std::max(most, f.norm());
  return most;
}

/// Largest frequency of M^-1 K at the last linearisation [rad/s], by power iteration from a random start.
inline double largest_frequency(const PhyxelModel& model, const int n_iterations = 60) {
  Draw draw(9);
  const auto mass = model.lumped_mass();
  Points p = random_points(mass.size(), draw), y(p.size());
  double value = 0;
  for (int n = 0; n < n_iterations; ++n) {
    model.apply_stiffness(dynamics::flat(p), dynamics::flat(y));
    double energy = 0, inertia = 0, norm = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      energy += p[i].dot(y[i]);
      inertia += mass[i] * p[i].squaredNorm();
      p[i] = y[i] / mass[i];
      norm += p[i].squaredNorm();
    }
    if (!(norm > 0))
      return 0;
    value = energy / inertia;
    for (Vec3& v : p)
      v /= std::sqrt(norm);
  }
  return std::sqrt(value);
}

} // namespace kerf::pba
