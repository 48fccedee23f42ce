#include "dynamics/implicit_euler.h"
#include "dynamics/points.h"

#include "base/parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <utility>

namespace kerf::dynamics {

namespace {


/// Where supports have moved, they take all that is free with them, as nearly as a rigid motion can: else the first
/// linear system would know a body that is torn where it is held.
void ride(const Loads& loads, const Constraints& constraints, const Points& from, Points& to) {
  Loan<Vec3> before, after;
  for (const auto& held : constraints.held())
    if (constraints.freedom(held.corner).n_free == 0 && !is_carried(loads, held.corner)) {
      before->push_back(from[held.corner]);
      after->push_back(to[held.corner]);
    }
  if (before.empty())
    return;
  using Columns = Eigen::Map<const Eigen::Matrix3Xd>;
  const auto n = static_cast<Eigen::Index>(before.size());
  const Eigen::Matrix4d motion =
    Eigen::umeyama(Columns(before->data()->data(), 3, n), Columns(after->data()->data(), 3, n), false);
  parallel_for(
    from.size(),
    [&](const std::size_t i) {
      if (constraints.is_free(i))
        to[i] = motion.topLeftCorner<3, 3>() * from[i] + motion.topRightCorner<3, 1>();
    },
    many_corners);
}

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
  if (std::ranges::any_of(constraints.held(), has_moved)) {
    balance.velocity = Loan<Vec3>(n);
    ride(loads, constraints, state.x, balance.start);
  }
  const Points* const a = remembered(state, last_acceleration); // of the last step, which may have been another length
  balance.guess_is_free_motion = !a && balance.velocity.empty();
  parallel_for(
    n,
    [&](const std::size_t i) {
      const Vec3 v = (balance.start[i] - state.x[i]) / dt; // zero but where supports move it
      if (!balance.velocity.empty())
        balance.velocity[i] = v;
      balance.acceleration[i] = (v - state.v[i]) / dt;
      balance.guess[i] = dt * ((a ? Vec3(state.v[i] + dt * (*a)[i]) : state.v[i]) - v);
    },
    many_corners);
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
    many_corners);
  state.x.swap(x);
  state.time += dt;
  return report;
}

} // namespace kerf::dynamics
