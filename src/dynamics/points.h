#pragma once

/// What integrators do with a value at each corner.

#include "base/loan.h"
#include "base/parallel.h"
#include "dynamics/conjugate_gradients.h"
#include "dynamics/state.h"

#include <cmath>

namespace kerf::dynamics {

/// Three numbers of a corner, among all of them in a row.
inline Eigen::Map<const Vec3> at(const std::span<const double> values, const std::size_t i) {
  return Eigen::Map<const Vec3>(values.data() + 3 * i);
}
inline Eigen::Map<Vec3> at(const std::span<double> values, const std::size_t i) {
  return Eigen::Map<Vec3>(values.data() + 3 * i);
}

inline double norm(const Points& values) { return std::sqrt(dot(flat(values), flat(values))); }

inline double product(const Points& a, const Points& b) { return dot(flat(a), flat(b)); }

constexpr std::size_t many_corners = 4096; // from which on a second thread pays

inline Loan<Vec3> moved(const Points& x, const double length, const Points& d) {
  Loan<Vec3> end(x.size());
  parallel_for(
    x.size(), [&](const std::size_t i) { end[i] = x[i] + length * d[i]; }, many_corners);
  return end;
}

/// Values a corner, less their mean by mass.
inline Points without_mean(const std::span<const double> mass, const Points& values) {
  Vec3 sum = Vec3::Zero();
  double all = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += mass[i] * values[i];
    all += mass[i];
  }
  return moved(values, -1, Points(values.size(), sum / all));
}

} // namespace kerf::dynamics
