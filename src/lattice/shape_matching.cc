#include "lattice/shape_matching.h"

#include "base/error.h"
#include "base/loan.h"
#include "base/parallel.h"
#include "dynamics/forces.h"

#include <cmath>

namespace kerf::lattice {

namespace {

constexpr std::size_t worth_corners = 16384; // from which on a second thread pays
constexpr double rounding = 1e-9;            // alpha is 1 also when dt is 1/60 of a rounded 3600

void require_allowed(const double alpha, const double dt) {
  if (!(alpha <= 1 + rounding))
    throw ParameterError(
      {.path = "Alpha [1]",
       .value = to_text(alpha),
       .rule = "must be > 0 and <= 1, and is the stiffness times the square of the time step, " + to_text(dt) + " s",
       .remedy = "Use a smaller time step, or wider regions with less stiffness"});
}

void require_finite(const Points& x) {
  double total = 0; // sum, not maximum: it keeps NaN
  for (const Vec3& p : x)
    total += p.squaredNorm();
  if (!std::isfinite(total))
    throw NumericalError(
      "positions are no longer finite: shape matching was given some that were not, or a load that "
      "is too large");
}

} // namespace

void ShapeMatchingParameters::describe(Parameters& p) {
  p.integer("Half width [cells]", half_width, {.min = 1, .max = 1e6},
            "Of the regions that are matched; wider ones are stiffer and cost the same.");
  p.number("Alpha [1]", alpha, {.min = 0, .max = 1, .min_excluded = true},
           "Part of the way to its goal that a corner is sent in a step.");
  p.number("Region damping [1/s]", region_damping, non_negative,
           "Rate at which velocities turn to the regions' rigid motions.");
}

void check(const ShapeMatchingParameters& parameters) {
  ShapeMatchingParameters copy = parameters;
  Parameters keys;
  copy.describe(keys);
  for (const Parameter& key : keys.list()) // its fallback is the value at hand
    if (!key.check(key.fallback).empty())
      throw ParameterError({.path = key.name, .value = key.fallback, .rule = key.rule});
}

MatchingOptions matching_options(const ShapeMatchingParameters& parameters, const double density, const double dt) {
  check(parameters);
  return {density, parameters.half_width, parameters.alpha / (dt * dt)};
}

ShapeMatching::ShapeMatching(const Matching& model, const double region_damping)
  : model_(model), region_damping_(region_damping) {
  check({.region_damping = region_damping});
}

void ShapeMatching::add_loads(const dynamics::Moment& now, const dynamics::Loads& loads, const double dt, Points& v) {
  if (loads.acting.empty())
    return;
  Loan<Vec3> accelerations(v.size(), Vec3::Zero()); // forces, at first
  dynamics::add_load_forces(loads, now, accelerations);
  const auto mass = model_.lumped_mass();
  for (std::size_t c = 0; c < v.size(); ++c)
    accelerations[c] = dynamics::per_mass(accelerations[c], mass[c]);
  model_.rigid_velocities(now.x, accelerations, rigid_);
  for (std::size_t c = 0; c < v.size(); ++c)
    v[c] += dt * rigid_[c];
}

void ShapeMatching::damp(const Points& x, const dynamics::Loads& loads, const double dt, Points& v) {
  const double rate = region_damping_ + loads.stiffness_damping * model_.stiffness();
  if (rate == 0)
    return;
  model_.rigid_velocities(x, v, rigid_);
  const double kappa = rate * dt / (1 + rate * dt);
  parallel_for(
    v.size(), [&](const std::size_t c) { v[c] += kappa * (rigid_[c] - v[c]); }, worth_corners);
}

dynamics::StepReport ShapeMatching::step(dynamics::State& state, const dynamics::Loads& loads, const double dt) {
  const double alpha = model_.stiffness() * dt * dt;
  require_allowed(alpha, dt);
  const dynamics::Constraints constraints(loads, state.x.size());
  Loan<Vec3> lent_x(state.x), lent_v(state.v);
  Points &x = lent_x, &v = lent_v;
  model_.goals(x, goals_);
  model_.riders().damp(x, model_.lumped_mass(), alpha, v);
  parallel_for(
    x.size(), [&](const std::size_t c) { v[c] += alpha / dt * (goals_[c] - x[c]) + dt * loads.gravity; },
    worth_corners);
  add_loads({state.time, x, state.v}, loads, dt, v);
  parallel_for(
    x.size(), [&](const std::size_t c) { v[c] /= 1 + dt * loads.mass_damping; }, worth_corners);
  damp(x, loads, dt, v);
  parallel_for(
    x.size(), [&](const std::size_t c) { x[c] += dt * v[c]; }, worth_corners);
  constraints.place(state.time + dt, x);
  for (const auto& held : constraints.held())
    v[held.corner] = (x[held.corner] - state.x[held.corner]) / dt;
  require_finite(x);
  state.x.swap(x);
  state.v.swap(v);
  state.time += dt;
  return {};
}

} // namespace kerf::lattice
