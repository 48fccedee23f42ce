#include "dynamics/generalised_alpha.h"

#include "base/error.h"
#include "dynamics/conjugate_gradients.h"
#include "dynamics/followers.h"
#include "dynamics/forces.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kerf::dynamics {

namespace {

/// A corner with less than this part of the largest mass has none but for round-off: it takes no acceleration at first.
constexpr double massless = 1e-12;
const std::string under_way = "under way [1]"; // in State::numbers from the first step on

void require(const bool holds, const std::string& path, const double value, const std::string& rule) {
  if (!holds)
    throw ParameterError(Complaint{.path = path, .value = to_text(value), .rule = rule, .remedy = ""});
}

/// M a = f among the free directions, from an `a` that is near; B: what to divide by where M is lumped.
void solve_for_acceleration(const ForceModel& model, const Constraints& constraints, const Product& B, Points& f,
                            Points& a) {
  constexpr int most = 200;
  constexpr double part = 1e-12; // of the forces
  constraints.project(f);
  const Product M = [&](const auto p, const auto y) {
    Points v(p.size() / 3);
    std::copy(p.begin(), p.end(), flat(v).begin());
    Points product = momenta(model, v);
    constraints.project(product);
    std::copy(flat(product).begin(), flat(product).end(), y.begin());
  };
  Points scaled(f.size());
  B(flat(std::as_const(f)), flat(scaled));
  const double size = std::sqrt(dot(flat(std::as_const(f)), flat(std::as_const(scaled))));
  conjugate_gradients({M, B}, flat(std::as_const(f)), {.residual = part * size}, most, flat(a));
}

/// The balance lies between two times, and x there on the straight way between them: what loads lead along a curved way
/// is ahead of that by alpha_f (1 - alpha_f) dt^2 / 2 times its acceleration, which stiff ones, as where a skin is held,
/// resist with many times the force that moves the body. So they lead along the straight way too, as their forces are
/// linear in where they lead: this is what that adds, for positions and velocities of any kind.
Loan<Vec3> straightened(const Loads& loads, const State& state, const double dt, const double alpha_f) {
  if (loads.acting.empty() || alpha_f == 0)
    return Loan<Vec3>::none();
  const std::size_t n = state.x.size();
  Loan<Vec3> sum(n, Vec3::Zero()), forces(n);
  for (const auto& [part, weight] : {std::pair{0.0, alpha_f}, {1.0, 1 - alpha_f}, {1 - alpha_f, -1.0}}) {
    std::fill(forces->begin(), forces->end(), Vec3::Zero());
    add_load_forces(loads, {state.time + part * dt, state.x, state.v}, forces);
    for (std::size_t i = 0; i < n; ++i)
      sum[i] += weight * forces[i];
  }
  return sum;
}

} // namespace

AlphaCoefficients generalised_alpha(const double rho_inf) {
  require(rho_inf >= 0 && rho_inf <= 1, "Spectral radius [1]", rho_inf, "must be >= 0 and <= 1");
  AlphaCoefficients c{.alpha_m = (2 * rho_inf - 1) / (rho_inf + 1), .alpha_f = rho_inf / (rho_inf + 1)};
  const double difference = c.alpha_m - c.alpha_f;
  c.gamma = 0.5 - difference;
  c.beta = 0.25 * (1 - difference) * (1 - difference);
  return c;
}

AlphaCoefficients newmark(const double beta, const double gamma) {
  require(beta > 0, "Beta [1]", beta, "must be > 0");
  require(gamma >= 0.5, "Gamma [1]", gamma, "must be >= 0.5");
  return {0, 0, beta, gamma};
}

Points GeneralisedAlpha::first_acceleration(const State& state, const Loads& loads, const double dt) {
  const Constraints constraints(loads, state.x.size());
  Points v = state.v, a;
  constraints.place_velocity(state.time, part_of_step * dt, v);
  total_force(model_, loads, {state.time, state.x, v}, a);
  const auto mass = model_.lumped_mass();
  const double least = massless * *std::max_element(mass.begin(), mass.end());
  for (const Follower& follower : model_.followers())
    for (std::uint32_t k = 0; k < follower.n_leaders; ++k)
      a[follower.leaders[k]] += follower.weights[k] * a[follower.corner];
  const auto by_lumped = [&](const std::span<const double> f, const std::span<double> result) {
    for (std::size_t i = 0; i < f.size(); ++i)
      result[i] = mass[i / 3] > least ? f[i] / mass[i / 3] : 0;
  };
  Points forces = a;
  by_lumped(flat(std::as_const(forces)), flat(a));
  constraints.project(a);
  if (model_.mass_coupling())
    solve_for_acceleration(model_, constraints, by_lumped, forces, a);
  return a;
}

NewtonOptions GeneralisedAlpha::one_solution(NewtonOptions options) {
  options.max_iterations = 1;
  options.tolerance = 0;
  options.line_search = LineSearch::none;
  options.tangent = Tangent::positive;
  return options;
}

Loan<Vec3> GeneralisedAlpha::resolved_acceleration(const State& state, const Loads& loads, const double dt,
                                                   StepReport& report) {
  const Constraints constraints(loads, state.x.size());
  const auto& c = after_jump_;
  const double kappa = 1 / (c.beta * dt * dt);
  Balance b{.time = state.time,
            .mass_factor = kappa,
            .velocity_factor = c.gamma / (c.beta * dt),
            .start = Loan<Vec3>(state.x),
            .velocity = Loan<Vec3>(state.v)};
  constraints.place_velocity(state.time, part_of_step * dt, b.velocity);
  Loan<Vec3> a = Loan<Vec3>::with_room(state.x.size());
  report.n_iterations += first_.solve(loads, constraints, std::move(b), a).n_linear;
  for (std::size_t i = 0; i < a.size(); ++i)
    a[i] = kappa * (a[i] - state.x[i]);
  constraints.project(a);
  for (const Follower& follower : model_.followers())
    a[follower.corner].setZero();
  return a;
}

Balance GeneralisedAlpha::balance(const AlphaCoefficients& c, const State& state, const Points& a,
                                  const Constraints& constraints, const double dt) const {
  const auto [alpha_m, alpha_f, beta, gamma] = c;
  const std::size_t n = state.x.size();
  Balance b{.time = state.time + (1 - alpha_f) * dt,
            .mass_factor = (1 - alpha_m) / ((1 - alpha_f) * beta * dt * dt),
            .velocity_factor = gamma / (beta * dt),
            .start = Loan<Vec3>(state.x),
            .velocity = Loan<Vec3>(n),
            .acceleration = Loan<Vec3>(n),
            .guess = Loan<Vec3>(n)};
  for (std::size_t i = 0; i < n; ++i) { // what x_1 = x_0 makes of them
    const Vec3 a_1 = -state.v[i] / (beta * dt) - (0.5 / beta - 1) * a[i];
    b.acceleration[i] = (1 - alpha_m) * a_1 + alpha_m * a[i];
    b.velocity[i] = state.v[i] + (1 - alpha_f) * dt * ((1 - gamma) * a[i] + gamma * a_1);
    b.guess[i] = (1 - alpha_f) * (dt * state.v[i] + 0.5 * dt * dt * a[i]);
  }
  for (const Follower& follower : model_.followers()) {
    const auto i = follower.corner;
    b.acceleration[i].setZero();
    b.guess[i] = (1 - alpha_f) * dt * state.v[i];
    b.velocity[i] = state.v[i] - b.velocity_factor * b.guess[i];
    b.guess[i] += 0.5 * (1 - alpha_f) * dt * dt * follower.led(a);
  }
  if (constraints.held().empty())
    return b;
  Loan<Vec3> end(state.x);
  constraints.place(state.time + dt, end);
  Loan<Vec3> first(*b.velocity), last(*b.velocity); // as everywhere, velocities lie between those at both ends
  constraints.place_velocity(state.time, part_of_step * dt, first);
  constraints.place_velocity(state.time + dt, part_of_step * dt, last);
  for (const auto& held : constraints.held()) {
    b.start[held.corner] += (1 - alpha_f) * (end[held.corner] - state.x[held.corner]);
    b.velocity[held.corner] = (1 - alpha_f) * last[held.corner] + alpha_f * first[held.corner];
  }
  return b;
}

StepReport GeneralisedAlpha::step(State& state, const Loads& loads, const double dt) {
  const Constraints constraints(loads, state.x.size());
  const Points* const known = remembered(state, "acceleration");
  const bool has_jumped = !known && state.numbers.count(under_way) > 0;
  const AlphaCoefficients& c = has_jumped ? after_jump_ : c_;
  Loan<Vec3> a = Loan<Vec3>::with_room(state.x.size()), x = Loan<Vec3>::with_room(state.x.size());
  StepReport begun;
  if (known)
    *a = *known;
  else if (has_jumped)
    a = resolved_acceleration(state, loads, dt, begun);
  else
    *a = first_acceleration(state, loads, dt);
  Balance balance = this->balance(c, state, a, constraints, dt);
  balance.offset = straightened(loads, state, dt, c.alpha_f);
  StepReport report = accepted(solver_.solve(loads, constraints, std::move(balance), x));
  report.n_iterations += begun.n_iterations;
  report.begins_anew = has_jumped;
  const Loan<Vec3> start(state.x);
  Loan<Vec3> way(x.size());
  const auto [alpha_m, alpha_f, beta, gamma] = c;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 moved = (x[i] - state.x[i]) / (1 - alpha_f);
    const Vec3 a_1 = (moved - dt * state.v[i]) / (beta * dt * dt) - (0.5 / beta - 1) * a[i];
    way[i] = x[i] - start[i];
    state.x[i] += moved;
    state.v[i] += dt * ((1 - gamma) * a[i] + gamma * a_1);
    a[i] = a_1;
  }
  for (const Follower& follower : model_.followers()) {
    const auto i = follower.corner;
    state.x[i] = x[i] + alpha_f / (1 - alpha_f) * led_along(follower, model_.lumped_mass(), start, way);
    a[i].setZero();
  }
  lead_along(model_, state.x, state.v);
  state.time += dt;
  constraints.place(state.time, state.x);
  constraints.place_velocity(state.time, part_of_step * dt, state.v);
  constraints.project(a);
  state.history["acceleration"].swap(a);
  state.numbers[under_way] = 1;
  return report;
}

} // namespace kerf::dynamics
