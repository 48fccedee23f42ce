#include "dynamics/implicit_euler.h"

#include "base/error.h"
#include "base/parallel.h"

#include <Eigen/LU>

#include <deal.II/lac/solver_cg.h>
#include <deal.II/lac/vector.h>

#include <cmath>

namespace kerf::dynamics {

namespace {

using Vector = dealii::Vector<double>;

constexpr std::size_t worth = 4096; // corners from which on a second thread pays

/// a M + b K with held corners as identity rows and columns.
struct Operator {
  const ElasticModel& model;
  const std::vector<std::uint8_t>& held;
  double mass_factor, stiffness_factor;

  void vmult(Vector& y, const Vector& p) const {
    const auto mass = model.lumped_mass();
    model.apply_stiffness({p.begin(), p.size()}, {y.begin(), y.size()});
    parallel_for(
      mass.size(),
      [&](const std::size_t i) {
        for (std::size_t k = 3 * i; k < 3 * i + 3; ++k)
          y[k] = held[i] ? 0 : mass_factor * mass[i] * p[k] + stiffness_factor * y[k];
      },
      worth);
  }
};

struct BlockJacobi {
  const std::vector<Mat3>& inverse_blocks;

  void vmult(Vector& y, const Vector& p) const {
    parallel_for(
      inverse_blocks.size(),
      [&](const std::size_t i) {
        Eigen::Map<Vec3>(y.begin() + 3 * i).noalias() = inverse_blocks[i] * Eigen::Map<const Vec3>(p.begin() + 3 * i);
      },
      worth);
  }
};

/// `scale` [N]: norm of the forces that balance in the right-hand side.
int solve(const Operator& A, const BlockJacobi& P, Vector& dx, const Vector& rhs, const double scale,
          const ImplicitEulerOptions& options) {
  const double norm = rhs.l2_norm();
  if (!std::isfinite(norm))
    throw NumericalError("forces are not finite");
  constexpr double nothing = 1e-100; // [N]: squares of less underflow, and conjugate gradients divide by them
  const double tolerance = options.cg_tolerance * scale;
  if (norm < std::max(nothing, tolerance))
    return 0;
  dealii::SolverControl control(options.max_cg_iterations, tolerance, false, false);
  try {
    dealii::SolverCG<Vector>(control).solve(A, dx, rhs, P);
  } catch (const dealii::SolverControl::NoConvergence& failure) {
    throw NumericalError("conjugate gradients left a relative residual of " +
                         std::to_string(failure.last_residual / scale) + " after " + std::to_string(failure.last_step) +
                         " iterations. Use a smaller time step, a larger sliver floor or more iterations");
  }
  return static_cast<int>(control.last_step());
}

} // namespace

StepReport ImplicitEuler::step(State& state, const Loads& loads, const double dt) {
  const std::size_t n = state.x.size();
  const auto mass = model_.lumped_mass();
  const auto held = held_corners(loads, n);
  const double mass_factor = 1 / (dt * dt) + loads.mass_damping / dt;
  const double stiffness_factor = 1 + loads.stiffness_damping / dt;

  Points x = state.x, v = state.v, force;
  move_held(loads, state.time + dt, dt, x, v);
  Vector rhs(3 * n), dx(3 * n), damping(3 * n), moved(3 * n);
  StepReport report;
  for (int newton = 0; newton < options_.n_newton; ++newton) {
    model_.linearise(x);
    model_.force(x, force);
    for (std::size_t i = 0; i < 3 * n; ++i)
      moved[i] = flat(x)[i] - flat(state.x)[i];
    if (loads.stiffness_damping > 0)
      model_.apply_stiffness({moved.begin(), moved.size()}, {damping.begin(), damping.size()});
    double square_of_scale = 0;
    for (std::size_t i = 0; i < n; ++i) {
      Eigen::Map<Vec3> r(rhs.begin() + 3 * i);
      const double magnitude = force[i].norm() + mass[i] * (loads.gravity.norm() + state.v[i].norm() / dt);
      square_of_scale += held[i] ? 0 : magnitude * magnitude;
      r = force[i] + mass[i] * (loads.gravity + state.v[i] / dt) -
          mass_factor * mass[i] * Eigen::Map<const Vec3>(moved.begin() + 3 * i);
      r -= loads.stiffness_damping / dt * Eigen::Map<const Vec3>(damping.begin() + 3 * i);
      if (held[i])
        r.setZero();
    }
    model_.stiffness_diagonal(inverse_blocks_);
    for (std::size_t i = 0; i < n; ++i)
      inverse_blocks_[i] =
        held[i] ? Mat3::Identity()
                : Mat3((stiffness_factor * inverse_blocks_[i] + mass_factor * mass[i] * Mat3::Identity()).inverse());
    for (std::size_t i = 0; i < n; ++i) // the first guess: each corner goes on as before
      Eigen::Map<Vec3>(dx.begin() + 3 * i) = newton > 0 || held[i] ? Vec3(Vec3::Zero()) : Vec3(dt * state.v[i]);
    report.n_iterations += solve({model_, held, mass_factor, stiffness_factor}, {inverse_blocks_}, dx, rhs,
                                 std::sqrt(square_of_scale), options_);
    for (std::size_t i = 0; i < 3 * n; ++i)
      flat(x)[i] += dx[i];
  }
  for (std::size_t i = 0; i < n; ++i)
    state.v[i] = (x[i] - state.x[i]) / dt;
  state.x = std::move(x);
  state.time += dt;
  return report;
}

} // namespace kerf::dynamics
