#include "dynamics/implicit_euler.h"

#include "base/error.h"
#include "base/parallel.h"

#include <Eigen/Cholesky>

#include <deal.II/lac/precondition.h>
#include <deal.II/lac/solver_cg.h>
#include <deal.II/lac/vector.h>

#include <cmath>

namespace kerf::dynamics {

namespace {

using Vector = dealii::Vector<double>;

constexpr std::size_t worth = 4096; // corners from which on a second thread pays

/// L^-1 A L^-T for A = a M + b K with the Cholesky factors L of A's diagonal 3 x 3 blocks, zero where corners are held. What conjugate gradients see is then scaled corner by corner:
/// they stop when each is solved in its own measure, a corner of hardly any mass like every other.
struct Operator {
  const ElasticModel& model;
  const std::vector<std::uint8_t>& held;
  const std::vector<Mat3>& inverse_factors; ///< L^-1 of each corner
  double mass_factor, stiffness_factor;

  void vmult(Vector& y, const Vector& p) const {
    const auto mass = model.lumped_mass();
    Vector& q = scratch;
    q.reinit(p.size(), true);
    parallel_for(
      mass.size(), [&](const std::size_t i) { at(q, i) = held[i] ? Vec3(Vec3::Zero()) : unscaled(i, at(p, i)); },
      worth);
    model.apply_stiffness({q.begin(), q.size()}, {y.begin(), y.size()});
    parallel_for(
      mass.size(),
      [&](const std::size_t i) {
        const Vec3 Aq = mass_factor * mass[i] * at(q, i) + stiffness_factor * at(y, i);
        at(y, i) = held[i] ? Vec3(Vec3::Zero()) : scaled(i, Aq);
      },
      worth);
  }

  /// L^-1 f of a corner.
  Vec3 scaled(const std::size_t i, const Vec3& f) const { return inverse_factors[i] * f; }
  /// L^-T p of a corner.
  Vec3 unscaled(const std::size_t i, const Vec3& p) const { return inverse_factors[i].transpose() * p; }
  /// L^T x of a corner.
  Vec3 rescaled(const std::size_t i, const Vec3& x) const {
    return inverse_factors[i].transpose().triangularView<Eigen::Upper>().solve(x);
  }

  static Eigen::Map<Vec3> at(Vector& v, const std::size_t i) { return Eigen::Map<Vec3>(v.begin() + 3 * i); }
  static Eigen::Map<const Vec3> at(const Vector& v, const std::size_t i) {
    return Eigen::Map<const Vec3>(v.begin() + 3 * i);
  }

  mutable Vector scratch = {};
};

/// `scale`: norm of the scaled forces that balance in the right-hand side.
int solve(const Operator& A, Vector& x, const Vector& rhs, const double scale, const ImplicitEulerOptions& options) {
  const double norm = rhs.l2_norm();
  if (!std::isfinite(norm) || !std::isfinite(scale))
    throw NumericalError("forces are not finite");
  constexpr double nothing = 1e-100; // squares of less underflow, and conjugate gradients divide by them
  dealii::SolverControl control(options.max_cg_iterations, std::max(nothing, options.cg_tolerance * scale), false,
                                false);
  try {
    dealii::SolverCG<Vector>(control).solve(A, x, rhs, dealii::PreconditionIdentity());
  } catch (const dealii::SolverControl::NoConvergence& failure) {
    throw NumericalError("conjugate gradients left a relative residual of " +
                         std::to_string(failure.last_residual / scale) + " after " + std::to_string(failure.last_step) +
                         " iterations. Use a smaller time step, a larger sliver floor or more iterations");
  }
  return static_cast<int>(control.last_step());
}

} // namespace

void ImplicitEuler::factorise(const std::vector<std::uint8_t>& held, const double mass_factor,
                              const double stiffness_factor) {
  model_.stiffness_diagonal(blocks_);
  inverse_factors_.resize(blocks_.size());
  const auto mass = model_.lumped_mass();
  parallel_for(
    blocks_.size(),
    [&](const std::size_t i) {
      if (!held[i])
        inverse_factors_[i] = Eigen::LLT<Mat3>(stiffness_factor * blocks_[i] + mass_factor * mass[i] * Mat3::Identity())
                                .matrixL()
                                .solve(Mat3::Identity());
    },
    worth);
}

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
    factorise(held, mass_factor, stiffness_factor);
    const Operator A{model_, held, inverse_factors_, mass_factor, stiffness_factor};
    for (std::size_t i = 0; i < n; ++i)
      A.at(moved, i) = x[i] - state.x[i];
    if (loads.stiffness_damping > 0)
      model_.apply_stiffness({moved.begin(), moved.size()}, {damping.begin(), damping.size()});
    double square_of_scale = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (held[i]) {
        A.at(rhs, i).setZero();
        A.at(dx, i).setZero();
        continue;
      }
      const Vec3 elastic = A.scaled(i, force[i]), weight = A.scaled(i, mass[i] * loads.gravity),
                 inertia = A.scaled(i, mass[i] * state.v[i] / dt);
      square_of_scale += elastic.squaredNorm() + weight.squaredNorm() + inertia.squaredNorm();
      A.at(rhs, i) =
        elastic + weight + inertia -
        A.scaled(i, mass_factor * mass[i] * A.at(moved, i) + loads.stiffness_damping / dt * A.at(damping, i));
      A.at(dx, i) = newton > 0 ? Vec3(Vec3::Zero()) : A.rescaled(i, dt * state.v[i]); // first guess: free motion
    }
    report.n_iterations += solve(A, dx, rhs, std::sqrt(square_of_scale), options_);
    for (std::size_t i = 0; i < n; ++i)
      if (!held[i])
        x[i] += A.unscaled(i, A.at(dx, i));
  }
  for (std::size_t i = 0; i < n; ++i)
    state.v[i] = (x[i] - state.x[i]) / dt;
  state.x = std::move(x);
  state.time += dt;
  return report;
}

} // namespace kerf::dynamics
