#pragma once

/// The lowest frequency of a model at rest near a given shape, by inverse iteration.

#include "tests/pba/clouds.h"

#include <algorithm>
#include <cmath>

namespace kerf::pba {

using Vector = Eigen::VectorXd;

/// (K + shift M) p with held phyxels left out.
struct ShiftedStiffness {
  const PhyxelModel& model;
  const std::vector<std::uint8_t>& held;
  double shift; ///< [1/s^2]

  Vector operator*(const Vector& p) const {
    Vector y(p.size());
    model.apply_stiffness({p.data(), p.data() + p.size()}, {y.data(), y.data() + y.size()});
    y += shift * inertia(p);
    clear_held(y);
    return y;
  }
  Vector inertia(const Vector& p) const {
    Vector y = p;
    for (std::size_t i = 0; i < held.size(); ++i)
      y.segment<3>(3 * static_cast<Eigen::Index>(i)) *= model.lumped_mass()[i];
    return y;
  }
  void clear_held(Vector& y) const {
    for (std::size_t i = 0; i < held.size(); ++i)
      if (held[i])
        y.segment<3>(3 * static_cast<Eigen::Index>(i)).setZero();
  }
};

/// Takes rigid motions out of u.
inline void clear_rigid(const ShiftedStiffness& A, Vector& u) {
  const Points& rest = A.model.phyxels().rest;
  std::vector<Vector> modes;
  for (int k = 0; k < 6; ++k) {
    Vector mode(u.size());
    for (std::size_t i = 0; i < rest.size(); ++i)
      mode.segment<3>(3 * static_cast<Eigen::Index>(i)) =
        k < 3 ? Vec3(Vec3::Unit(k)) : Vec3(Vec3::Unit(k - 3).cross(rest[i]));
    for (const Vector& other : modes)
      mode -= mode.dot(A.inertia(other)) * other;
    modes.push_back(mode / std::sqrt(mode.dot(A.inertia(mode))));
    u -= u.dot(A.inertia(modes.back())) * modes.back();
  }
}

/// A x = b by conjugate gradients.
inline Vector solve(const ShiftedStiffness& A, const Vector& b) {
  Vector x = Vector::Zero(b.size()), r = b, p = b;
  double rr = r.squaredNorm();
  const double enough = 1e-12 * rr;
  for (int n = 0; n < 2000 && rr > enough; ++n) {
    const Vector Ap = A * p;
    const double alpha = rr / p.dot(Ap);
    x += alpha * p;
    r -= alpha * Ap;
    const double before = rr;
    rr = r.squaredNorm();
    p = r + rr / before * p;
  }
  return x;
}

/// [Hz], beyond rigid motions where nothing is held. `shape`: displacements to start from.
inline double lowest_frequency(const PhyxelModel& model, const std::vector<std::uint8_t>& held, const Points& shape) {
  const double shift = 1e-4 * std::pow(largest_frequency(model), 2);
  ShiftedStiffness A{model, held, shift};
  Vector u = Eigen::Map<const Vector>(shape[0].data(), 3 * static_cast<Eigen::Index>(shape.size()));
  A.clear_held(u);
  const bool is_free = std::find(held.begin(), held.end(), 1) == held.end();
  double squared = 0;
  for (int n = 0; n < 40; ++n) {
    if (is_free)
      clear_rigid(A, u);
    u /= std::sqrt(u.dot(A.inertia(u)));
    const double now = u.dot(A * u) - A.shift;
    if (std::abs(now - squared) < 1e-5 * now)
      break;
    squared = now;
    A.shift = 0.05 * now; // settles the modes that cost nothing, and is small beside the one that is sought
    u = solve(A, A.inertia(u));
  }
  return std::sqrt(squared) / (2 * M_PI);
}

} // namespace kerf::pba
