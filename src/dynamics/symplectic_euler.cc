#include "dynamics/symplectic_euler.h"

#include "base/loan.h"
#include "dynamics/forces.h"

namespace kerf::dynamics {

namespace {

Eigen::Matrix2d of_symplectic_euler(const Mode& mode, const double dt) {
  const Eigen::RowVector2d x(1, 0), v(0, 1),
    v_1 = (v - dt * (mode.square * x + mode.other_damping * v)) / (1 + dt * mode.mass_damping), x_1 = x + dt * v_1;
  Eigen::Matrix2d A;
  A << x_1, v_1;
  return A;
}

} // namespace

ExplicitScheme SymplecticEuler::scheme() { return {"symplectic Euler", of_symplectic_euler, 1e-10}; }

SumsOfStep SymplecticEuler::move(const Step& step, Points& x, Points& v) {
  const auto& [before, loads, constraints, mass, dt] = step;
  const Points& force = this->force(loads, {before.time, before.x, before.v});
  const double damped = 1 / (1 + dt * loads.mass_damping);
  const Loan<Vec3> places = constraints.places(step.end());
  return pass(
    x.size(),
    [&](const std::size_t i) {
      v[i] = damped * (before.v[i] + dt * acceleration(force[i], mass[i], loads));
      x[i] = before.x[i] + dt * v[i];
    },
    [&](const std::size_t begin, const std::size_t end, SumsOfStep& sum) {
      const auto held = constraints.held(begin, end);
      constraints.impose(places, held, x);
      for (const auto& one : held)
        v[one.corner] = (x[one.corner] - before.x[one.corner]) / dt;
      sum.before += mass_sums(mass, before.x, before.v, begin, end);
      sum.after += mass_sums(mass, x, v, begin, end);
    });
}

} // namespace kerf::dynamics
