#include "dynamics/relief.h"

#include "base/error.h"
#include "dynamics/balance.h"
#include "dynamics/forces.h"
#include "dynamics/rigid_body.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace kerf::dynamics {

namespace {

/// Mass, its centre, what turns it: of one piece.
struct Moments {
  double mass = 0;
  Vec3 moment = Vec3::Zero(), angular = Vec3::Zero(); // sums of m x, of m x x v
};

Loan<Moments> moments(const Pieces& pieces, const std::span<const double> mass, const State& state) {
  Loan<Moments> all(pieces.n(), Moments());
  for (std::size_t i = 0; i < mass.size(); ++i) {
    Moments& of = all[pieces.of(i)];
    of.mass += mass[i];
    of.moment += mass[i] * state.x[i];
    of.angular += mass[i] * state.x[i].cross(state.v[i]);
  }
  return all;
}

double slope_squared(const std::span<const double> mass, const Constraints& constraints, const Points& forces,
                     const Points& gravity) {
  double sum = 0;
  for (std::size_t i = 0; i < forces.size(); ++i)
    if (constraints.is_free(i) && mass[i] > 0)
      sum += (forces[i] + mass[i] * gravity[i]).squaredNorm() / mass[i];
  return sum;
}

/// The loads with a potential, and supports under which nothing moves but what is marked (1), and neither held by
/// others nor carried by crumbs.
Loads held_but(const std::span<const std::uint8_t> is_marked, const State& state, const Loads& loads) {
  const auto is_held = held_corners(loads, state.x.size());
  Support rest{{}, {}, [](double) { return Vec3(Vec3::Zero()); }};
  for (std::uint32_t i = 0; i < state.x.size(); ++i)
    if (is_marked[i] == 0 || is_held[i] != 0) {
      rest.corners.push_back(i);
      rest.rest.push_back(state.x[i]);
    }
  Loads held = potentials_of(loads);
  held.supports.push_back(std::move(rest));
  return held;
}

} // namespace

Loan<Vec3> gravity_on_held(const Pieces& pieces, const Loads& loads, const std::size_t n_particles) {
  const auto is_free = free_pieces(pieces, loads, n_particles);
  Loan<Vec3> gravity(n_particles);
  for (std::size_t i = 0; i < n_particles; ++i)
    gravity[i] = is_free[pieces.of(i)] != 0 ? Vec3(Vec3::Zero()) : loads.gravity;
  return gravity;
}

double lift(const std::span<const double> mass, const Points& gravity, const Points& from, const Points& to) {
  double sum = 0;
  for (std::size_t i = 0; i < from.size(); ++i)
    sum -= mass[i] * gravity[i].dot(to[i] - from[i]);
  return sum;
}

double most_after_cut(const ForceModel& model, const double had, const Points& v) {
  constexpr double little = 1e-3;
  return had + little * (had + inner_kinetic_energy(model, Pieces(), v));
}

void keep_moments(const Pieces& pieces, const std::span<const double> mass, const Loads& loads, const State& before,
                  State& after) {
  const auto is_free = free_pieces(pieces, loads, after.x.size());
  const Loan<Moments> had = moments(pieces, mass, before);
  {
    const Loan<Moments> has = moments(pieces, mass, after);
    for (std::size_t i = 0; i < mass.size(); ++i)
      if (const auto p = pieces.of(i); is_free[p] != 0 && has[p].mass > 0 && !is_carried(loads, i))
        after.x[i] += (had[p].moment - has[p].moment) / has[p].mass;
  }
  const Loan<Moments> has = moments(pieces, mass, after);
  Loan<Mat3> inertia(pieces.n(), Mat3::Zero());
  const auto arm = [&](const std::size_t i) {
    const Moments& of = has[pieces.of(i)];
    return of.mass > 0 ? Vec3(after.x[i] - of.moment / of.mass) : Vec3(Vec3::Zero());
  };
  for (std::size_t i = 0; i < mass.size(); ++i) {
    const Vec3 r = arm(i);
    inertia[pieces.of(i)] += mass[i] * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
  }
  Loan<Vec3> spin(pieces.n());
  for (std::size_t p = 0; p < pieces.n(); ++p) {
    const double about_origin = has[p].mass > 0 ? has[p].moment.squaredNorm() / has[p].mass : 0;
    spin[p] = is_free[p] != 0 ? angular_velocity(inertia[p], about_origin, had[p].angular - has[p].angular)
                              : Vec3(Vec3::Zero());
  }
  for (std::size_t i = 0; i < mass.size(); ++i)
    if (!is_carried(loads, i))
      after.v[i] += spin[pieces.of(i)].cross(arm(i));
}

double Relief::flow(const std::span<const std::uint8_t> is_marked, const Loads& loads, const Points& gravity,
                    double excess, State& state, StepReport& report) const {
  constexpr int most_steps = 8;
  constexpr double worth_a_step = 1e-3; // of the excess
  const Loads held = held_but(is_marked, state, loads);
  const Constraints constraints(held, state.x.size());
  Loan<Vec3> forces = Loan<Vec3>::with_room(state.x.size());
  model_.force(state.x, forces);
  add_load_forces(held, {state.time, state.x, Points(state.x.size(), Vec3::Zero())}, forces);
  const auto mass = model_.lumped_mass();
  const double slope = slope_squared(mass, constraints, forces, gravity);
  if (!(slope > 0))
    return excess;
  BalanceSolver solver(model_, {.max_iterations = 10,
                                .tolerance = 1e-2,
                                .line_search = LineSearch::backtracking,
                                .cg_tolerance = 1e-3});
  Loan<Vec3> away(gravity); // inertia's acceleration where gravity alone acts
  for (Vec3& a : *away)
    a = -a;
  double tau = std::sqrt(excess / slope);
  for (int k = 0; k < most_steps && excess > 0; ++k, tau *= 4) {
    Loan<Vec3> x(state.x.size());
    try {
      Balance flow{.time = state.time,
                   .mass_factor = 1 / (tau * tau),
                   .start = Loan<Vec3>(state.x),
                   .acceleration = Loan<Vec3>(*away)};
      report.n_iterations += solver.solve(held, constraints, std::move(flow), x).n_linear;
    } catch (const NumericalError&) { // no further
      break;
    }
    const double had = excess, left = model_.energy(x) - excess_.most;
    const double asked =
      lift(mass, gravity, state.x, x) + load_energy(held, state.time, x) - load_energy(held, state.time, state.x);
    if (!(left + std::max(0.0, asked) < had))
      break;
    excess = left;
    state.x.swap(x);
    if (had - left < worth_a_step * had)
      break;
  }
  return excess;
}

StepReport Relief::step(State& state, const Loads& loads, double) {
  StepReport report;
  const double first = model_.energy_ahead(state.x) - excess_.most; // the next step asks for forces here
  if (!(first > 0))
    return report;
  State after = state;
  const Pieces pieces(excess_.piece());
  const Loan<Vec3> gravity = gravity_on_held(pieces, loads, state.x.size());
  double excess = flow(excess_.touched, loads, gravity, first, after, report);
  if (excess > 0)
    excess = flow(std::vector<std::uint8_t>(state.x.size(), 1), loads, gravity, excess, after, report);
  keep_moments(pieces, model_.lumped_mass(), loads, state, after);
  const double taken = first - excess, turned = kinetic_energy(model_, after.v) - kinetic_energy(model_, state.v),
               pulled = load_energy(loads, state.time, after.x) - load_energy(loads, state.time, state.x);
  if (turned + std::max(0.0, pulled) <= taken) // else it has hardly any inertia, and turns by more than was let out, or
    state = std::move(after);                  // has been shifted away from a handle
  return report;
}

} // namespace kerf::dynamics
