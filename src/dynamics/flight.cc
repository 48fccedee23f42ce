#include "dynamics/flight.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf::dynamics {

namespace {

constexpr int n_lanes = 8;
using Lane = double[n_lanes];

/// Of bodies side by side. Matrices row by row; of symmetric ones xx, xy, xz, yy, yz, zz.
struct Lanes {
  alignas(64) Lane inertia[6], R[9], spin[3];
  alignas(64) Lane inverse[6], momentum[3], omega[3]; // in the frame of the body; omega [rad/s]
};

void put(const RigidBody& body, const RigidMotion& motion, const int l, Lanes& lanes) {
  constexpr int rows[6] = {0, 0, 0, 1, 1, 2}, columns[6] = {0, 1, 2, 1, 2, 2};
  for (int k = 0; k < 6; ++k)
    lanes.inertia[k][l] = body.inertia(rows[k], columns[k]);
  for (int i = 0; i < 3; ++i) {
    lanes.spin[i][l] = motion.spin[i];
    for (int j = 0; j < 3; ++j)
      lanes.R[3 * i + j][l] = motion.R(i, j);
  }
}

/// Inverse, momentum, omega, by the spin times `factor`.
[[gnu::always_inline]] inline void find_omegas(const double factor, Lanes& lanes) {
  for (int l = 0; l < n_lanes; ++l) {
    const double a = lanes.inertia[0][l], b = lanes.inertia[1][l], c = lanes.inertia[2][l], d = lanes.inertia[3][l],
                 e = lanes.inertia[4][l], f = lanes.inertia[5][l];
    const double A = d * f - e * e, B = c * e - b * f, C = b * e - c * d;
    const double one = 1 / (a * A + b * B + c * C);
    lanes.inverse[0][l] = one * A;
    lanes.inverse[1][l] = one * B;
    lanes.inverse[2][l] = one * C;
    lanes.inverse[3][l] = one * (a * f - c * c);
    lanes.inverse[4][l] = one * (b * c - a * e);
    lanes.inverse[5][l] = one * (a * d - b * b);
    for (int i = 0; i < 3; ++i)
      lanes.momentum[i][l] = factor * (lanes.R[i][l] * lanes.spin[0][l] + lanes.R[3 + i][l] * lanes.spin[1][l] +
                                       lanes.R[6 + i][l] * lanes.spin[2][l]);
  }
  for (int l = 0; l < n_lanes; ++l) {
    const Lane* const J = lanes.inverse;
    const double x = lanes.momentum[0][l], y = lanes.momentum[1][l], z = lanes.momentum[2][l];
    lanes.omega[0][l] = J[0][l] * x + J[1][l] * y + J[2][l] * z;
    lanes.omega[1][l] = J[1][l] * x + J[3][l] * y + J[4][l] * z;
    lanes.omega[2][l] = J[2][l] * x + J[4][l] * y + J[5][l] * z;
  }
}

/// Puts omega in the world frame.
__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"))) void find_velocities(Lanes& lanes,
                                                                                                  Lane* const omega) {
  find_omegas(1, lanes);
  for (int l = 0; l < n_lanes; ++l)
    for (int i = 0; i < 3; ++i)
      omega[i][l] = lanes.R[3 * i][l] * lanes.omega[0][l] + lanes.R[3 * i + 1][l] * lanes.omega[1][l] +
                    lanes.R[3 * i + 2][l] * lanes.omega[2][l];
}

/// Turns R by a step of the midpoint rule, whose momentum Newton's method finds as in rigid_body.cc. Puts into `angle`
/// by how much [rad].
__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"))) void turn_all(
  const double dt, const double factor, Lanes& lanes, double* const angle) {
  constexpr int most = 30;
  constexpr double round_off = 1e-17;
  find_omegas(factor, lanes);
  alignas(64) Lane middle[3], keep, change[3], left;
  const double half = 0.5 * dt;
  const Lane* const J = lanes.inverse;
  const Lane* const start = lanes.momentum;
  const Lane* const omega = lanes.omega;
  for (int l = 0; l < n_lanes; ++l) {
    angle[l] = dt * std::sqrt(omega[0][l] * omega[0][l] + omega[1][l] * omega[1][l] + omega[2][l] * omega[2][l]);
    middle[0][l] = start[0][l] + half * (start[1][l] * omega[2][l] - start[2][l] * omega[1][l]);
    middle[1][l] = start[1][l] + half * (start[2][l] * omega[0][l] - start[0][l] * omega[2][l]);
    middle[2][l] = start[2][l] + half * (start[0][l] * omega[1][l] - start[1][l] * omega[0][l]);
    keep[l] = 1;
  }
  for (int i = 0; i < most; ++i) {
    for (int l = 0; l < n_lanes; ++l) {
      const double x = middle[0][l], y = middle[1][l], z = middle[2][l];
      const double xi0 = J[0][l] * x + J[1][l] * y + J[2][l] * z, xi1 = J[1][l] * x + J[3][l] * y + J[4][l] * z,
                   xi2 = J[2][l] * x + J[4][l] * y + J[5][l] * z;
      const double r0 = x - start[0][l] - half * (y * xi2 - z * xi1), r1 = y - start[1][l] - half * (z * xi0 - x * xi2),
                   r2 = z - start[2][l] - half * (x * xi1 - y * xi0);
      // 1 - half ([middle] J - [xi]), row by row
      const double a = 1 - half * (y * J[2][l] - z * J[1][l]), b = -half * (y * J[4][l] - z * J[3][l] + xi2),
                   c = -half * (y * J[5][l] - z * J[4][l] - xi1), d = -half * (z * J[0][l] - x * J[2][l] - xi2),
                   e = 1 - half * (z * J[1][l] - x * J[4][l]), f = -half * (z * J[2][l] - x * J[5][l] + xi0),
                   g = -half * (x * J[1][l] - y * J[0][l] + xi1), h = -half * (x * J[3][l] - y * J[1][l] - xi0),
                   k = 1 - half * (x * J[4][l] - y * J[2][l]);
      const double A = e * k - f * h, B = f * g - d * k, C = d * h - e * g;
      const double one = keep[l] / (a * A + b * B + c * C);
      change[0][l] = one * (A * r0 + (c * h - b * k) * r1 + (b * f - c * e) * r2);
      change[1][l] = one * (B * r0 + (a * k - c * g) * r1 + (c * d - a * f) * r2);
      change[2][l] = one * (C * r0 + (b * g - a * h) * r1 + (a * e - b * d) * r2);
      left[l] = change[0][l] * change[0][l] + change[1][l] * change[1][l] + change[2][l] * change[2][l] -
                round_off * (start[0][l] * start[0][l] + start[1][l] * start[1][l] + start[2][l] * start[2][l]);
    }
    double n_left = 0;
    for (int l = 0; l < n_lanes; ++l) {
      for (int j = 0; j < 3; ++j)
        middle[j][l] -= change[j][l];
      keep[l] = left[l] > 0 ? keep[l] : 0;
      n_left += keep[l];
    }
    if (n_left == 0)
      break;
  }
  for (int l = 0; l < n_lanes; ++l) {
    const double x = middle[0][l], y = middle[1][l], z = middle[2][l];
    const double a = half * (J[0][l] * x + J[1][l] * y + J[2][l] * z),
                 b = half * (J[1][l] * x + J[3][l] * y + J[4][l] * z),
                 c = half * (J[2][l] * x + J[4][l] * y + J[5][l] * z);
    const double aa = a * a, bb = b * b, cc = c * c, one = 1 / (1 + aa + bb + cc), two = 2 * one;
    const double C[9] = {one * (1 + aa - bb - cc), two * (a * b - c),        two * (a * c + b),
                         two * (a * b + c),        one * (1 - aa + bb - cc), two * (b * c - a),
                         two * (a * c - b),        two * (b * c + a),        one * (1 - aa - bb + cc)};
    double T[9]; // R C
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        T[3 * i + j] = lanes.R[3 * i][l] * C[j] + lanes.R[3 * i + 1][l] * C[3 + j] + lanes.R[3 * i + 2][l] * C[6 + j];
    // Nearer to a rotation by a step of Newton's method: T (3 - T^T T) / 2.
    double S[9];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        S[3 * i + j] = (i == j ? 1.5 : 0) - 0.5 * (T[i] * T[j] + T[3 + i] * T[3 + j] + T[6 + i] * T[6 + j]);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        lanes.R[3 * i + j][l] = T[3 * i] * S[j] + T[3 * i + 1] * S[3 + j] + T[3 * i + 2] * S[6 + j];
  }
}

/// Calls f(numbers of up to eight bodies) for all that `is_asked` says.
template <class Asked, class Function>
void for_each_eight(const std::size_t n, const Asked& is_asked, const Function& f) {
  std::array<std::size_t, n_lanes> eight;
  std::size_t k = 0;
  for (std::size_t b = 0; b < n; ++b) {
    if (!is_asked(b))
      continue;
    eight[k++] = b;
    if (k == n_lanes) {
      f(std::span<const std::size_t>(eight));
      k = 0;
    }
  }
  if (k > 0)
    f(std::span<const std::size_t>(eight.data(), k));
}

/// A body's motion as put_points() reads it: columns of R, of what turns with it (omega x R), and where its centre is
/// and how it moves, a zero after each three.
struct Carrier {
  alignas(32) double R[3][4] = {}, W[3][4] = {}, x[4] = {}, v[4] = {};
};

__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"))) void put_points(
  const Carrier& carrier, const double* const centre, const std::size_t n, const double* const rest,
  const std::uint32_t* const places, double* const x, double* const v) {
  typedef double Four __attribute__((vector_size(32), may_alias));
  typedef double Two __attribute__((vector_size(16), aligned(8), may_alias));
  const Four* const numbers = reinterpret_cast<const Four*>(&carrier);
  const Four R0 = numbers[0], R1 = numbers[1], R2 = numbers[2], W0 = numbers[3], W1 = numbers[4], W2 = numbers[5],
             x0 = numbers[6], v0 = numbers[7];
  const double a = centre[0], b = centre[1], c = centre[2];
  for (std::size_t i = 0; i < n; ++i) {
    const double r0 = rest[3 * i] - a, r1 = rest[3 * i + 1] - b, r2 = rest[3 * i + 2] - c;
    const Four to_x = x0 + R0 * r0 + R1 * r1 + R2 * r2, to_v = v0 + W0 * r0 + W1 * r1 + W2 * r2;
    double* const at_x = x + 3 * std::size_t(places[i]);
    double* const at_v = v + 3 * std::size_t(places[i]);
    *reinterpret_cast<Two*>(at_x) = Two{to_x[0], to_x[1]};
    at_x[2] = to_x[2];
    *reinterpret_cast<Two*>(at_v) = Two{to_v[0], to_v[1]};
    at_v[2] = to_v[2];
  }
}

} // namespace

void fly(const BodyOf body, const Vec3& gravity, const double alpha, const double dt,
         const std::span<RigidMotion> motions) {
  const Decay decay(alpha, dt);
  for (RigidMotion& motion : motions)
    decay.move(gravity, motion);
  Lanes lanes;
  for_each_eight(
    motions.size(), [&](const std::size_t b) { return !motions[b].spin.isZero(0); },
    [&](const std::span<const std::size_t> eight) {
      for (int l = 0; l < n_lanes; ++l) {
        const std::size_t b = eight[std::min<std::size_t>(l, eight.size() - 1)];
        put(body(b), motions[b], l, lanes);
      }
      alignas(64) Lane angle;
      turn_all(dt, decay.mean(), lanes, angle);
      for (std::size_t l = 0; l < eight.size(); ++l) {
        RigidMotion& motion = motions[eight[l]];
        if (!(angle[l] <= 1))
          turn(body(eight[l]), decay.mean(), dt, motion);
        else
          for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
              motion.R(i, j) = lanes.R[3 * i + j][l];
      }
    });
  const double end = decay.end();
  for (RigidMotion& motion : motions)
    motion.spin *= end;
}

void put_angular_velocities(const BodyOf body, const std::span<const RigidMotion> motions,
                            const std::span<Vec3> omegas) {
  Lanes lanes;
  for_each_eight(
    motions.size(), [](std::size_t) { return true; },
    [&](const std::span<const std::size_t> eight) {
      for (int l = 0; l < n_lanes; ++l) {
        const std::size_t b = eight[std::min<std::size_t>(l, eight.size() - 1)];
        put(body(b), motions[b], l, lanes);
      }
      alignas(64) Lane omega[3];
      find_velocities(lanes, omega);
      for (std::size_t l = 0; l < eight.size(); ++l)
        omegas[eight[l]] = {omega[0][l], omega[1][l], omega[2][l]};
    });
}

void carry(const RigidBody& body, const RigidMotion& motion, const Vec3& omega, const std::span<const Vec3> rest,
           const std::uint32_t* const places, Points& x, Points& v) {
  if (rest.empty())
    return;
  Carrier carrier;
  for (int j = 0; j < 3; ++j) {
    const Vec3 r = motion.R.col(j);
    const double turning[3] = {omega[1] * r[2] - omega[2] * r[1], omega[2] * r[0] - omega[0] * r[2],
                               omega[0] * r[1] - omega[1] * r[0]};
    std::copy_n(r.data(), 3, carrier.R[j]);
    std::copy_n(turning, 3, carrier.W[j]);
  }
  std::copy_n(motion.x.data(), 3, carrier.x);
  std::copy_n(motion.v.data(), 3, carrier.v);
  put_points(carrier, body.centre.data(), rest.size(), rest.front().data(), places, x.front().data(), v.front().data());
}

} // namespace kerf::dynamics
