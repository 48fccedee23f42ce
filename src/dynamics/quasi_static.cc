#include "dynamics/quasi_static.h"

#include "base/error.h"
#include "dynamics/forces.h"

#include <Eigen/Geometry>

#include <cmath>

namespace kerf::dynamics {

namespace {

/// The balance on the part `s` of the way; positions so far in x.
Balance on_the_way(const double s, const double time, const Points& start, const Points& end, const Points& x,
                   const Points& out_of_balance, const Constraints& constraints, const FreeMotions& free) {
  const std::size_t n = x.size();
  Balance balance{.time = time, .start = Loan<Vec3>(x), .offset = Loan<Vec3>(n), .free = free};
  for (const auto& held : constraints.held()) {
    const auto c = held.corner;
    const Vec3 wanted = start[c] + s * (end[c] - start[c]); // differs from x only along held directions
    const Mat3& free = constraints.freedom(c).project;
    balance.start[c] = free * x[c] + wanted - free * wanted;
  }
  for (std::size_t i = 0; i < n; ++i)
    balance.offset[i] = -(1 - s) * out_of_balance[i];
  return balance;
}

} // namespace

void QuasiStaticParameters::describe(Parameters& p) {
  p.integer("Newton iterations [1]", n_newton, {.min = 1}, "At most, a load step.");
  p.number("Newton tolerance [1]", newton_tolerance, positive,
           "Forces out of balance over the forces that balance, at equilibrium.");
  p.choice("Solver", solver, {"conjugate gradients", "direct"}, "Of the linear equations.");
  p.choice("Tangent", tangent, {"positive", "exact"}, "What the direct solver factorises.");
  p.number("CG tolerance [1]", cg_tolerance, {.min = 0, .max = 1, .min_excluded = true, .max_excluded = true},
           "Residual over the forces that balance.");
  p.integer("CG iterations [1]", max_cg_iterations, {.min = 1}, "At most, a linear equation.");
}

QuasiStaticOptions QuasiStaticParameters::options() const {
  QuasiStaticOptions o;
  o.newton.max_iterations = n_newton;
  o.newton.tolerance = newton_tolerance;
  o.newton.solver = solver == "direct" ? LinearSolver::direct : LinearSolver::conjugate_gradients;
  o.newton.tangent = tangent == "exact" ? Tangent::exact : Tangent::positive;
  o.newton.cg_tolerance = cg_tolerance;
  o.newton.max_cg_iterations = max_cg_iterations;
  if (o.newton.tangent == Tangent::exact)
    o.newton.n_mixed = 0;
  return o;
}

NewtonOptions QuasiStatic::newton(const QuasiStaticOptions& options) {
  NewtonOptions newton = options.newton;
  newton.equation = options.free_modes == FreeModes::allow ? Equation::singular : Equation::regular;
  return newton;
}

Points QuasiStatic::out_of_balance(const Loads& loads, const double time, const Points& x) {
  Points forces;
  model_.force(x, forces);
  const auto mass = model_.lumped_mass();
  for (std::size_t i = 0; i < forces.size(); ++i)
    forces[i] += mass[i] * loads.gravity;
  const Points at_rest(x.size(), Vec3::Zero());
  add_load_forces(loads, {time, x, at_rest}, forces);
  return forces;
}

bool QuasiStatic::sees_rotations(const Points& rest) const {
  constexpr double little = 1e-6; // of what there is, and of what it takes to double the body's size
  Points turned = rest, grown = rest;
  const Mat3 R = Eigen::AngleAxisd(1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (std::size_t i = 0; i < turned.size(); ++i) {
    turned[i] = R * turned[i];
    grown[i] *= 2;
  }
  const double energy = model_.energy(rest);
  return std::abs(model_.energy(turned) - energy) > little * (energy + model_.energy(grown));
}

FreeMotions QuasiStatic::balanced_motions(const Loads& loads, const double time, State& state) {
  constexpr double most = 0.1;
  const Points& rest = state.history.try_emplace("before statics", state.x).first->second;
  std::vector<FreeMode> modes = free_rigid_modes(model_, loads, time, rest, options_.piece);
  if (!sees_rotations(rest))
    std::erase_if(modes, [](const FreeMode& mode) { return !mode.rotation.isZero(0); });
  const FreeMotions motions(modes, options_.piece, model_.lumped_mass(), rest);
  const Points at_rest(rest.size(), Vec3::Zero());
  Points forces = at_rest;
  add_load_forces(loads, {time, state.x, at_rest}, forces);
  for (std::size_t i = 0; i < forces.size(); ++i)
    forces[i] += model_.lumped_mass()[i] * loads.gravity;
  for (std::size_t k = 0; k < motions.size(); ++k)
    if (const double part = motions.part_out_of_balance(k, forces); part > most)
      throw NumericalError("no equilibrium: nothing resists the " + modes[k].name + " of piece " +
                           std::to_string(modes[k].piece) + ", along which " + to_text(100 * part) +
                           " % of the loads are not in balance. Balance them, or add supports or handles");
  return motions;
}

StepReport QuasiStatic::step(State& state, const Loads& loads, const double dt) {
  const double time = state.time + dt;
  const Constraints constraints(loads, state.x.size());
  Points end = state.x, x = state.x, tried;
  constraints.place(time, end);
  if (options_.free_modes == FreeModes::refuse)
    require_supported(free_rigid_modes(model_, loads, time, end, options_.piece));
  const FreeMotions free =
    options_.free_modes == FreeModes::allow ? balanced_motions(loads, time, state) : FreeMotions();
  Points r_0 = out_of_balance(loads, time, x);
  free.relieve_forces(flat(r_0));
  StepReport report;
  double s = 0, part = 1;
  while (s < 1) {
    NewtonReport newton{.converged = false};
    try {
      newton = solver_.solve(loads, constraints,
                             on_the_way(std::min(1.0, s + part), time, state.x, end, x, r_0, constraints, free), tried);
    } catch (const NumericalError& error) {
      newton.failure = error.what();
    }
    report.n_newton += newton.n_newton;
    report.n_iterations += newton.n_linear;
    report.residual = newton.residual;
    if (newton.converged) {
      x = tried;
      s = std::min(1.0, s + part);
      part *= 2;
      ++report.n_substeps;
    } else {
      part *= 0.5;
      ++report.n_rejected;
      if (part < 1.0 / 1024)
        throw NumericalError("no equilibrium found at " + to_text(100 * s) + " % of the load" +
                             (newton.residual > 0 ? ": Newton's method left " + to_text(newton.residual) +
                                                      " of the forces out of balance"
                                                  : "") +
                             (newton.failure.empty() ? "" : ": " + newton.failure));
    }
  }
  state.x = std::move(x);
  state.v.assign(state.x.size(), Vec3::Zero());
  state.time = time;
  return report;
}

} // namespace kerf::dynamics
