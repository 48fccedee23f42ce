#include "dynamics/explicit_steppers.h"

#include "base/loan.h"
#include "dynamics/forces.h"

namespace kerf::dynamics {

namespace {

/// (x, v)' = A (x, v).
Eigen::Matrix2d derivative(const Mode& mode) {
  Eigen::Matrix2d A;
  A << 0, 1, -mode.square, -(mode.mass_damping + mode.other_damping);
  return A;
}

Eigen::Matrix2d of_explicit_euler(const Mode& mode, const double dt) {
  return Eigen::Matrix2d::Identity() + dt * derivative(mode);
}

Eigen::Matrix2d of_midpoint(const Mode& mode, const double dt) {
  const Eigen::Matrix2d A = dt * derivative(mode);
  return Eigen::Matrix2d::Identity() + A + 0.5 * A * A;
}

Eigen::Matrix2d of_verlet(const Mode& mode, const double dt) {
  const double alpha = mode.mass_damping, d = mode.other_damping;
  const Eigen::RowVector2d x(1, 0), v(0, 1),
    force = -mode.square * x - d * v, half = (1 - 0.5 * dt * alpha) * v + 0.5 * dt * force, x_1 = x + dt * half,
    predicted = half + 0.5 * dt * (force - alpha * v), force_1 = -mode.square * x_1 - d * predicted;
  Eigen::Matrix2d A;
  A << x_1, (half + 0.5 * dt * force_1) / (1 + 0.5 * dt * alpha);
  return A;
}

/// With mass damping; zero without a mass.
Vec3 damped_acceleration(const Vec3& force, const double mass, const Vec3& v, const Loads& loads) {
  return mass > 0 ? Vec3(1 / mass * force + loads.gravity - loads.mass_damping * v) : Vec3(Vec3::Zero());
}

} // namespace

ExplicitScheme ExplicitEuler::scheme() { return {"explicit Euler", of_explicit_euler, 1e-3}; }
ExplicitScheme MidpointRungeKutta::scheme() { return {"midpoint Runge-Kutta", of_midpoint, 1e-3}; }
ExplicitScheme VelocityVerlet::scheme() { return {"velocity Verlet", of_verlet, 1e-10}; }

SumsOfStep ExplicitEuler::move(const Step& step, Points& x, Points& v) {
  const auto& [before, loads, constraints, mass, dt] = step;
  const Points& force = this->force(loads, {before.time, before.x, before.v});
  const Held held(step, step.end());
  return pass(
    x.size(),
    [&](const std::size_t i) {
      x[i] = before.x[i] + dt * before.v[i];
      v[i] = before.v[i] + dt * damped_acceleration(force[i], mass[i], before.v[i], loads);
    },
    [&](const std::size_t begin, const std::size_t end, SumsOfStep& sum) {
      held.put(begin, end, x, v);
      sum.before += mass_sums(mass, before.x, before.v, begin, end);
      sum.after += mass_sums(mass, x, v, begin, end);
    });
}

SumsOfStep MidpointRungeKutta::move(const Step& step, Points& x, Points& v) {
  const auto& [before, loads, constraints, mass, dt] = step;
  const double half = 0.5 * dt;
  const Points& force = this->force(loads, {before.time, before.x, before.v});
  const Held held_half_way(step, before.time + half), held(step, step.end());
  SumsOfStep sums = pass(
    x.size(),
    [&](const std::size_t i) {
      x[i] = before.x[i] + half * before.v[i];
      v[i] = before.v[i] + half * damped_acceleration(force[i], mass[i], before.v[i], loads);
    },
    [&](const std::size_t begin, const std::size_t end, SumsOfStep& sum) {
      held_half_way.put(begin, end, x, v);
      sum.before += mass_sums(mass, before.x, before.v, begin, end);
    });
  this->force(loads, {before.time + half, x, v});
  sums += pass(
    x.size(),
    [&](const std::size_t i) {
      const Vec3 a = damped_acceleration(force[i], mass[i], v[i], loads);
      x[i] = before.x[i] + dt * v[i];
      v[i] = before.v[i] + dt * a;
    },
    [&](const std::size_t begin, const std::size_t end, SumsOfStep& sum) {
      held.put(begin, end, x, v);
      sum.after += mass_sums(mass, x, v, begin, end);
    });
  return sums;
}

SumsOfStep VelocityVerlet::move(const Step& step, Points& x, Points& v) {
  const auto& [before, loads, constraints, mass, dt] = step;
  const double half = 0.5 * dt, alpha = loads.mass_damping, damped = 1 / (1 + half * alpha);
  const Points& force = this->force(loads, {before.time, before.x, before.v});
  const Held held(step, step.end());
  Loan<Vec3> predicted(x.size(), AnyValues());
  SumsOfStep sums = pass(
    x.size(),
    [&](const std::size_t i) {
      const Vec3 a = acceleration(force[i], mass[i], loads) - alpha * before.v[i];
      v[i] = before.v[i] + half * a;
      x[i] = before.x[i] + dt * v[i];
      predicted[i] = v[i] + half * a;
    },
    [&](const std::size_t begin, const std::size_t end, SumsOfStep& sum) {
      held.put(begin, end, x, predicted);
      sum.before += mass_sums(mass, before.x, before.v, begin, end);
    });
  this->force(loads, {step.end(), x, predicted});
  sums += pass(
    x.size(), [&](const std::size_t i) { v[i] = damped * (v[i] + half * acceleration(force[i], mass[i], loads)); },
    [&](const std::size_t begin, const std::size_t end, SumsOfStep& sum) {
      held.put(begin, end, x, v);
      sum.after += mass_sums(mass, x, v, begin, end);
    });
  return sums;
}

} // namespace kerf::dynamics
