#include "dynamics/explicit_steppers.h"

#include "base/error.h"
#include "base/loan.h"
#include "base/parallel.h"
#include "dynamics/constraints.h"
#include "dynamics/forces.h"
#include "dynamics/points.h"

#include <cmath>

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

void obey(const Constraints& constraints, const double time, const double dt, Points& x, Points& v) {
  constraints.place(time, x);
  constraints.place_velocity(time, part_of_step * dt, v);
}

void take_over(State& state, Points& x, Points& v, const double dt, const char* const name) {
  require_finite(v, name);
  state.x.swap(x);
  state.v.swap(v);
  state.time += dt;
}

} // namespace

void require_finite(const Points& v, const char* name) {
  if (!std::isfinite(product(v, v))) // a sum, not a maximum: it keeps NaN
    throw NumericalError("velocities are no longer finite: " + std::string(name) +
                         " is unstable beyond a time step that the largest frequency sets. Use a smaller time step, "
                         "or implicit Euler");
}

ExplicitScheme ExplicitEuler::scheme() { return {"explicit Euler", of_explicit_euler, 1e-3}; }
ExplicitScheme MidpointRungeKutta::scheme() { return {"midpoint Runge-Kutta", of_midpoint, 1e-3}; }
ExplicitScheme VelocityVerlet::scheme() { return {"velocity Verlet", of_verlet, 1e-10}; }

StepReport ExplicitEuler::step(State& state, const Loads& loads, const double dt) {
  limit_.require(state, loads, dt);
  const Constraints constraints(loads, state.x.size());
  const auto mass = model_.lumped_mass();
  total_force(model_, loads, {state.time, state.x, state.v}, force_);
  const std::size_t n = state.x.size();
  Loan<Vec3> x(n, AnyValues()), v(n, AnyValues());
  parallel_for(
    n,
    [&](const std::size_t i) {
      x[i] = state.x[i] + dt * state.v[i];
      v[i] = state.v[i] + per_mass(dt, mass[i]) * force_[i];
    },
    many_corners);
  obey(constraints, state.time + dt, dt, x, v);
  take_over(state, x, v, dt, "explicit Euler");
  return {.stable_step = limit_.last()};
}

StepReport MidpointRungeKutta::step(State& state, const Loads& loads, const double dt) {
  limit_.require(state, loads, dt);
  const Constraints constraints(loads, state.x.size());
  const auto mass = model_.lumped_mass();
  const double half = 0.5 * dt;
  total_force(model_, loads, {state.time, state.x, state.v}, force_);
  const std::size_t n = state.x.size();
  Loan<Vec3> x(n, AnyValues()), v(n, AnyValues());
  parallel_for(
    n,
    [&](const std::size_t i) {
      x[i] = state.x[i] + half * state.v[i];
      v[i] = state.v[i] + per_mass(half, mass[i]) * force_[i];
    },
    many_corners);
  obey(constraints, state.time + half, dt, x, v);
  total_force(model_, loads, {state.time + half, x, v}, force_);
  parallel_for(
    n,
    [&](const std::size_t i) {
      x[i] = state.x[i] + dt * v[i];
      v[i] = state.v[i] + per_mass(dt, mass[i]) * force_[i];
    },
    many_corners);
  obey(constraints, state.time + dt, dt, x, v);
  take_over(state, x, v, dt, "midpoint Runge-Kutta");
  return {.stable_step = limit_.last()};
}

StepReport VelocityVerlet::step(State& state, const Loads& loads, const double dt) {
  limit_.require(state, loads, dt);
  const Constraints constraints(loads, state.x.size());
  const auto mass = model_.lumped_mass();
  const double half = 0.5 * dt, alpha = loads.mass_damping;
  applied_force(model_, loads, {state.time, state.x, state.v}, force_);
  const std::size_t n = state.x.size();
  Loan<Vec3> x(n, AnyValues()), v(n, AnyValues()), predicted(n, AnyValues());
  parallel_for(
    n,
    [&](const std::size_t i) {
      const Vec3 a = acceleration(force_[i], mass[i], loads) - alpha * state.v[i];
      v[i] = state.v[i] + half * a;
      x[i] = state.x[i] + dt * v[i];
      predicted[i] = v[i] + half * a;
    },
    many_corners);
  obey(constraints, state.time + dt, dt, x, predicted);
  applied_force(model_, loads, {state.time + dt, x, predicted}, force_);
  const double damped = 1 / (1 + half * alpha);
  parallel_for(
    n, [&](const std::size_t i) { v[i] = damped * (v[i] + half * acceleration(force_[i], mass[i], loads)); },
    many_corners);
  obey(constraints, state.time + dt, dt, x, v);
  take_over(state, x, v, dt, "velocity Verlet");
  return {.stable_step = limit_.last()};
}

} // namespace kerf::dynamics
