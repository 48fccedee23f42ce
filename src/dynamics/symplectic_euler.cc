#include "dynamics/symplectic_euler.h"

#include "base/loan.h"
#include "base/parallel.h"
#include "dynamics/constraints.h"
#include "dynamics/explicit_steppers.h"
#include "dynamics/forces.h"
#include "dynamics/points.h"

namespace kerf::dynamics {

namespace {

Eigen::Matrix2d of_symplectic_euler(const Mode& mode, const double dt) {
  const Eigen::RowVector2d x(1, 0), v(0, 1),
    v_1 = (v - dt * (mode.square * x + mode.other_damping * v)) / (1 + dt * mode.mass_damping), x_1 = x + dt * v_1;
  Eigen::Matrix2d A;
  A << x_1, v_1;
  return A;
}

} // namespace

ExplicitScheme SymplecticEuler::scheme() { return {"symplectic Euler", of_symplectic_euler, 1e-10}; }

StepReport SymplecticEuler::step(State& state, const Loads& loads, const double dt) {
  limit_.require(state, loads, dt);
  const Constraints constraints(loads, state.x.size());
  const auto mass = model_.lumped_mass();
  applied_force(model_, loads, {state.time, state.x, state.v}, force_);
  const std::size_t n = state.x.size();
  const double damped = 1 / (1 + dt * loads.mass_damping);
  Loan<Vec3> x(n, AnyValues()), v(n, AnyValues());
  parallel_for(
    n,
    [&](const std::size_t i) {
      v[i] = damped * (state.v[i] + dt * acceleration(force_[i], mass[i], loads));
      x[i] = state.x[i] + dt * v[i];
    },
    many_corners);
  constraints.place(state.time + dt, x);
  for (const auto& held : constraints.held())
    v[held.corner] = (x[held.corner] - state.x[held.corner]) / dt;
  require_finite(v, "symplectic Euler");
  state.x.swap(x);
  state.v.swap(v);
  state.time += dt;
  return {.stable_step = limit_.last()};
}

} // namespace kerf::dynamics
