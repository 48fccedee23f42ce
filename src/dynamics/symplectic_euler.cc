#include "dynamics/symplectic_euler.h"

#include "base/error.h"

#include <cmath>

namespace kerf::dynamics {

StepReport SymplecticEuler::step(State& state, const Loads& loads, const double dt) {
  const auto mass = model_.lumped_mass();
  model_.force(state.x, force_);
  if (loads.stiffness_damping > 0) {
    model_.linearise(state.x);
    damping_.resize(state.x.size());
    model_.apply_stiffness(flat(state.v), flat(damping_));
    for (std::size_t i = 0; i < force_.size(); ++i)
      force_[i] -= loads.stiffness_damping * damping_[i];
  }
  const auto held = held_corners(loads, state.x.size());
  double total = 0; // sum, not maximum: it keeps NaN
  for (std::size_t i = 0; i < state.x.size(); ++i)
    if (!held[i]) {
      state.v[i] += dt * (force_[i] / mass[i] + loads.gravity);
      state.v[i] /= 1 + dt * loads.mass_damping;
      state.x[i] += dt * state.v[i];
      total += state.v[i].squaredNorm();
    }
  state.time += dt;
  move_held(loads, state.time, dt, state.x, state.v);
  if (!std::isfinite(total))
    throw NumericalError(
      "velocities are no longer finite: symplectic Euler is unstable beyond a time step of 2 / (largest "
      "frequency). Use a smaller time step, or implicit Euler");
  return {};
}

} // namespace kerf::dynamics
