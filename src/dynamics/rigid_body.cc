#include "dynamics/rigid_body.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace kerf::dynamics {

namespace {

/// Pi of the midpoint rule, by Newton's method. As the residual is quadratic, a change of d leaves an error of less
/// than d^2 / |start| where the body turns by less than 1 rad.
Vec3 middle_momentum(const Mat3& inverse_inertia, const Vec3& start, const double dt) {
  constexpr int most = 30;
  constexpr double round_off = 1e-17;
  Vec3 middle = start + 0.5 * dt * start.cross(inverse_inertia * start);
  for (int i = 0; i < most; ++i) {
    const Vec3 xi = inverse_inertia * middle;
    const Vec3 residual = middle - start - 0.5 * dt * middle.cross(xi);
    const Mat3 J = Mat3::Identity() - 0.5 * dt * (cross_matrix(middle) * inverse_inertia - cross_matrix(xi));
    const Vec3 change = J.inverse() * residual;
    middle -= change;
    if (!(change.squaredNorm() > round_off * start.squaredNorm()))
      break;
  }
  return middle;
}

constexpr double most_turns = 1000; // in a step: beyond them the attitude is of no use

/// R times the Cayley map of an axial vector.
Mat3 times_cayley(const Mat3& R, const Vec3& a) {
  const Eigen::Quaterniond half(1, 0.5 * a[0], 0.5 * a[1], 0.5 * a[2]);
  return (Eigen::Quaterniond(R) * half).normalized().toRotationMatrix();
}

} // namespace

Vec3 angular_velocity(const RigidBody& body, const RigidMotion& motion) {
  return motion.R * (body.inertia.inverse() * (motion.R.transpose() * motion.spin));
}

Vec3 angular_velocity(const Mat3& inertia, const double about_origin, const Vec3& L) {
  constexpr double of_places = 1e-18, of_axes = 1e-9; // squares of lengths
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(inertia);
  const Vec3 I = eigen.eigenvalues(), c = eigen.eigenvectors().transpose() * L;
  Vec3 omega = Vec3::Zero();
  for (int k = 0; k < 3; ++k)
    if (I[k] > of_places * about_origin && I[k] > of_axes * I[2])
      omega += c[k] / I[k] * eigen.eigenvectors().col(k);
  return omega;
}

double kinetic_energy(const RigidBody& body, const RigidMotion& motion) {
  return 0.5 * body.mass * motion.v.squaredNorm() + 0.5 * motion.spin.dot(angular_velocity(body, motion));
}

Decay::Decay(const double alpha, const double dt) : alpha_(alpha), dt_(dt) {
  const double z = alpha * dt;
  if (std::abs(z) < 1e-3) { // without cancellation
    mean_ = 1 - z / 2 * (1 - z / 3 * (1 - z / 4));
    of_force_ = 0.5 - z / 6 * (1 - z / 4 * (1 - z / 5));
  } else {
    mean_ = -std::expm1(-z) / z;
    of_force_ = (1 - mean_) / z;
  }
}

double Decay::end() const { return std::exp(-alpha_ * dt_); }

void Decay::move(const Vec3& gravity, RigidMotion& motion) const {
  motion.x += dt_ * mean_ * motion.v + dt_ * dt_ * of_force_ * gravity;
  motion.v += dt_ * mean_ * (gravity - alpha_ * motion.v);
}

void turn(const RigidBody& body, const double mean, const double dt, RigidMotion& motion) {
  const Mat3 inverse = body.inertia.inverse();
  const double angle = dt * mean * (inverse * (motion.R.transpose() * motion.spin)).norm();
  const int n = static_cast<int>(std::clamp(std::ceil(angle), 1.0, most_turns));
  for (int i = 0; i < n; ++i) {
    const Vec3 start = mean * (motion.R.transpose() * motion.spin);
    motion.R = times_cayley(motion.R, dt / n * inverse * middle_momentum(inverse, start, dt / n));
  }
}

void fly(const RigidBody& body, const Vec3& gravity, const double alpha, const double dt, RigidMotion& motion) {
  const Decay decay(alpha, dt);
  decay.move(gravity, motion);
  if (motion.spin.isZero(0))
    return;
  turn(body, decay.mean(), dt, motion);
  motion.spin *= decay.end();
}

Mat3 turned(const Mat3& R, const Vec3& angle) {
  const double length = angle.norm();
  if (length == 0)
    return R;
  return (Eigen::AngleAxisd(length, angle / length) * Eigen::Quaterniond(R)).normalized().toRotationMatrix();
}

} // namespace kerf::dynamics
