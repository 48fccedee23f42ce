#include "dynamics/adaptive.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace kerf::dynamics {

namespace {

void add(StepReport& sum, const StepReport& part) {
  sum.n_iterations += part.n_iterations;
  sum.n_newton += part.n_newton;
  sum.residual = std::max(sum.residual, part.residual);
}

double largest_difference(const std::span<const double> mass, const State& a, const State& b, const double dt) {
  double all = 0, n = 0; // of those that have mass
  for (const double m : mass) {
    all += m;
    n += m > 0 ? 1 : 0;
  }
  double largest = 0;
  for (std::size_t i = 0; i < a.x.size(); ++i) {
    const double weight = n * mass[i] < all ? n * mass[i] / all : 1;
    largest = std::max(largest, weight * ((a.x[i] - b.x[i]).norm() + dt * (a.v[i] - b.v[i]).norm()));
  }
  return largest;
}

} // namespace

double AdaptiveStepper::try_substep(State& state, const Loads& loads, const double h, const double dt,
                                    StepReport& report) {
  State whole = state;
  try {
    add(report, stepper_->step(whole, loads, h));
    add(report, stepper_->step(state, loads, 0.5 * h));
    add(report, stepper_->step(state, loads, 0.5 * h));
  } catch (const NumericalError&) { // too long for the solver, perhaps
    return std::numeric_limits<double>::infinity();
  }
  const double error = largest_difference(model_.lumped_mass(), whole, state, dt);
  return std::isfinite(error) ? error / (parameters_.tolerance * h) : std::numeric_limits<double>::infinity();
}

StepReport AdaptiveStepper::step(State& state, const Loads& loads, const double dt) {
  constexpr double safety = 0.9, least = 0.25, most = 1.2;
  const double end = state.time + dt;
  const auto known = state.numbers.find("substep [s]");
  double next = known == state.numbers.end() ? dt : known->second;
  State now = state;
  StepReport report;
  constexpr double nothing_tried = std::numeric_limits<double>::infinity();
  double error_before = nothing_tried; // of the substep thrown away just before
  while (end - now.time > 1e-9 * dt) {
    const double left = end - now.time, h = next >= left ? left : std::min(next, 0.5 * left); // no crumb at the end
    State trial = now;
    const double error = try_substep(trial, loads, h, dt, report);
    const double factor = std::clamp(safety * std::pow(error, -1.0 / order_), least, most);
    const bool jumps = h <= 1e-3 * dt && std::isfinite(error) && error > 0.6 * error_before;
    if (error <= 1 || jumps) {
      now = std::move(trial);
      ++report.n_substeps;
      error_before = nothing_tried;
      next = std::max(h == left ? next : 0.0, factor * h);
    } else {
      ++report.n_rejected;
      error_before = error;
      next = std::min(factor, safety) * h;
      if (next < parameters_.shortest)
        throw NumericalError("the error stays above " + to_text(parameters_.tolerance) + " m/s in substeps of " +
                             to_text(h) + " s. Use a larger error tolerance, or solve closer: a smaller CG tolerance, and a "
                             "smaller Newton tolerance where it is not 0. Supports that start with a jump of their "
                             "velocity ask for ever shorter steps");
    }
  }
  now.time = end;
  now.numbers["substep [s]"] = std::min(next, dt);
  state = std::move(now);
  return report;
}

} // namespace kerf::dynamics
