#include "dynamics/bdf2.h"

#include "dynamics/followers.h"

#include <utility>

namespace kerf::dynamics {

namespace {

/// Values at the two ends of the step before, and the three coefficients.
struct Past {
  const Points &x_before, &v_before; // at the beginning of the step before
  double c_1, c_0, c_m;
};

Past past_of(const State& state, const double dt) {
  const Points* const x = remembered(state, "position before");
  const Points* const v = remembered(state, "velocity before");
  const auto step = state.numbers.find("step before [s]");
  constexpr double longest = 2.414; // times the step before: zero-stable up to 1 + sqrt 2
  if (!x || !v || step == state.numbers.end() || dt > longest * step->second)
    return {state.x, state.v, 1, -1, 0}; // implicit Euler
  const double r = dt / step->second;
  return {*x, *v, (1 + 2 * r) / (1 + r), -(1 + r), r * r / (1 + r)};
}

} // namespace

StepReport Bdf2::step(State& state, const Loads& loads, const double dt) {
  const std::size_t n = state.x.size();
  const Constraints constraints(loads, n);
  const Past past = past_of(state, dt);
  const double omega = past.c_1 / dt;
  Balance balance{.time = state.time + dt,
                  .mass_factor = omega * omega,
                  .velocity_factor = omega,
                  .start = Loan<Vec3>(state.x),
                  .velocity = Loan<Vec3>(n),
                  .acceleration = Loan<Vec3>(n),
                  .guess = Loan<Vec3>(n)};
  constraints.place(balance.time, balance.start);
  const auto velocity = [&](const std::size_t i, const Vec3& x) -> Vec3 {
    return (past.c_1 * x + past.c_0 * state.x[i] + past.c_m * past.x_before[i]) / dt;
  };
  for (std::size_t i = 0; i < n; ++i)
    balance.velocity[i] = velocity(i, balance.start[i]);
  constraints.place_velocity(balance.time, part_of_step * dt, balance.velocity);
  for (std::size_t i = 0; i < n; ++i) {
    balance.acceleration[i] =
      (past.c_1 * balance.velocity[i] + past.c_0 * state.v[i] + past.c_m * past.v_before[i]) / dt;
    balance.guess[i] = dt * state.v[i];
  }
  for (const Follower& follower : model_.followers()) {
    const auto i = follower.corner;
    balance.acceleration[i].setZero();
    balance.velocity[i] = state.v[i] - omega * balance.guess[i];
  }
  const double end = balance.time;
  Loan<Vec3> x = Loan<Vec3>::with_room(n);
  const StepReport report = accepted(solver_.solve(loads, constraints, std::move(balance), x));
  Loan<Vec3> v(n);
  for (std::size_t i = 0; i < n; ++i)
    v[i] = velocity(i, x[i]);
  lead_along(model_, x, v);
  constraints.place_velocity(end, part_of_step * dt, v);
  state.x.swap(x);
  state.v.swap(v);
  state.history["position before"].swap(x);
  state.history["velocity before"].swap(v);
  state.numbers["step before [s]"] = dt;
  state.time += dt;
  return report;
}

} // namespace kerf::dynamics
