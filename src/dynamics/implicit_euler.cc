#include "dynamics/implicit_euler.h"

#include "base/parallel.h"

#include <algorithm>
#include <utility>

namespace kerf::dynamics {

namespace {

constexpr std::size_t worth = 4096; // corners from which on a second thread pays

} // namespace

ImplicitEulerOptions implicit_euler_options(const NewtonParameters& parameters) {
  const NewtonOptions o = parameters.options();
  constexpr double of_step = 1e3; // what is left of forces over what is left of the step's own error
  return {.n_newton = o.max_iterations,
          .cg_tolerance = o.cg_tolerance,
          .max_cg_iterations = o.max_cg_iterations,
          .newton_tolerance = o.tolerance,
          .line_search = o.line_search,
          .solver = o.solver,
          .tangent = o.tangent,
          .step_tolerance = of_step * o.cg_tolerance,
          .trust = Trust::tested};
}

ImplicitEuler::ImplicitEuler(ElasticModel& model, const ImplicitEulerOptions& o)
  : solver_(model, NewtonOptions{.max_iterations = o.n_newton,
                                 .tolerance = o.newton_tolerance,
                                 .line_search = o.line_search,
                                 .solver = o.solver,
                                 .tangent = o.tangent,
                                 .cg_tolerance = o.cg_tolerance,
                                 .max_cg_iterations = o.max_cg_iterations,
                                 .step_tolerance = o.step_tolerance,
                                 .trust = o.trust,
                                 .piece = o.piece}) {}

StepReport ImplicitEuler::step(State& state, const Loads& loads, const double dt) {
  const std::size_t n = state.x.size();
  const Constraints constraints(loads, n);
  Balance balance{.time = state.time + dt,
                  .mass_factor = 1 / (dt * dt),
                  .velocity_factor = 1 / dt,
                  .start = Loan<Vec3>(state.x),
                  .acceleration = Loan<Vec3>(n),
                  .guess = Loan<Vec3>(n)};
  constraints.place(balance.time, balance.start);
  const auto has_moved = [&](const Constraints::Held& held) {
    return balance.start[held.corner] != state.x[held.corner];
  };
  if (std::ranges::any_of(constraints.held(), has_moved))
    balance.velocity = Loan<Vec3>(n);
  const Points* const a = remembered(state, last_acceleration); // of the last step, which may have been another length
  balance.guess_is_free_motion = !a && balance.velocity.empty();
  parallel_for(
    n,
    [&](const std::size_t i) {
      const Vec3 v = (balance.start[i] - state.x[i]) / dt; // zero but where supports move
      if (!balance.velocity.empty())
        balance.velocity[i] = v;
      balance.acceleration[i] = (v - state.v[i]) / dt;
      balance.guess[i] = dt * (a ? Vec3(state.v[i] + dt * (*a)[i]) : state.v[i]);
    },
    worth);
  Loan<Vec3> x = Loan<Vec3>::with_room(n);
  const StepReport report = accepted(solver_.solve(loads, constraints, std::move(balance), x));
  Points& accelerations = state.history[last_acceleration];
  accelerations.resize(n);
  parallel_for(
    n,
    [&](const std::size_t i) {
      const Vec3 v = (x[i] - state.x[i]) / dt;
      accelerations[i] = (v - state.v[i]) / dt;
      state.v[i] = v;
    },
    worth);
  state.x.swap(x);
  state.time += dt;
  return report;
}

} // namespace kerf::dynamics
