#include "dynamics/explicit_stepper.h"

#include "base/error.h"
#include "dynamics/forces.h"

#include <cmath>
#include <utility>

namespace kerf::dynamics {

StepReport ExplicitStepper::step(State& state, const Loads& loads, const double dt) {
  const Stepped stepped = step_from(state, loads, dt, next_);
  std::swap(state, next_);
  return stepped.report;
}

Stepped ExplicitStepper::step_from(const State& before, const Loads& loads, const double dt, State& after) {
  assign_but_motion(after, before);
  limit_.require(before, loads, dt, after.numbers);
  const std::size_t n = before.x.size();
  after.x.resize(n);
  after.v.resize(n);
  const Constraints constraints(loads, n);
  const SumsOfStep sums = move({before, loads, constraints, model_.lumped_mass(), dt}, after.x, after.v);
  if (!std::isfinite(sums.after.kinetic_energy))
    throw NumericalError("velocities are no longer finite: " + name_ +
                         " is unstable beyond a time step that the largest frequency sets. Use a smaller time step, "
                         "or implicit Euler");
  after.time = before.time + dt;
  return {{.stable_step = limit_.last()}, sums};
}

const Points& ExplicitStepper::force(const Loads& loads, const Moment& moment) {
  applied_force(model_, loads, moment, force_);
  return force_;
}

ExplicitStepper::Held::Held(const Step& step, const double time) : constraints_(step.constraints) {
  if (constraints_.held().empty())
    return;
  places_ = constraints_.places(time);
  velocities_ = constraints_.velocities(time, part_of_step * step.dt);
}

void ExplicitStepper::Held::put(const std::size_t begin, const std::size_t end, Points& x, Points& v) const {
  const auto held = constraints_.held(begin, end);
  constraints_.impose(places_, held, x);
  constraints_.impose(velocities_, held, v);
}

} // namespace kerf::dynamics
