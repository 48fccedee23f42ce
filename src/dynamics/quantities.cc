#include "dynamics/quantities.h"

#include "dynamics/forces.h"

#include <Eigen/Geometry>

namespace kerf::dynamics {

namespace {

/// M a less all forces, at each corner [N]: zero where nothing is held.
Points missing_force(ForceModel& model, const Loads& loads, const State& state, const Points& acceleration) {
  Points missing;
  total_force(model, loads, {state.time, state.x, state.v}, missing);
  const Points inertia = momenta(model, acceleration);
  for (std::size_t i = 0; i < missing.size(); ++i)
    missing[i] = inertia[i] - missing[i];
  return missing;
}

double power_of(const Load& load, const State& state) {
  Points forces(state.x.size(), Vec3::Zero());
  load.add_force({state.time, state.x, state.v}, forces);
  double sum = 0;
  for (std::size_t i = 0; i < forces.size(); ++i)
    sum += forces[i].dot(state.v[i]);
  return sum;
}

} // namespace

double damping_power(ForceModel& model, const Loads& loads, const State& state) {
  double sum = 2 * loads.mass_damping * kinetic_energy(model, state.v);
  if (auto* elastic = dynamic_cast<ElasticModel*>(&model); elastic && loads.stiffness_damping > 0) {
    elastic->linearise(state.x);
    Points Kv(state.v.size());
    elastic->apply_stiffness(flat(state.v), flat(Kv));
    for (std::size_t i = 0; i < Kv.size(); ++i)
      sum += loads.stiffness_damping * state.v[i].dot(Kv[i]);
  }
  return sum;
}

Points mean_acceleration(const State& before, const State& after) {
  Points a(after.v.size(), Vec3::Zero());
  const double dt = after.time - before.time;
  for (std::size_t i = 0; i < a.size() && dt != 0; ++i)
    a[i] = (after.v[i] - before.v[i]) / dt;
  return a;
}

std::vector<Reaction> reactions(ForceModel& model, const Loads& loads, const State& state, const Points& acceleration,
                                const Vec3& about) {
  const Points missing = missing_force(model, loads, state, acceleration);
  const Constraints constraints(loads, state.x.size());
  std::vector<Reaction> all(loads.supports.size());
  for (const auto& held : constraints.held())
    for (const auto& hold : constraints.holds(held)) {
      const Vec3 force =
        loads.supports[hold.support].held * (constraints.freedom(held.corner).inverse * missing[held.corner]);
      all[hold.support].force += force;
      all[hold.support].torque += (state.x[held.corner] - about).cross(force);
    }
  return all;
}

Vec3 external_force(const ForceModel& model, const Loads& loads, const State& state) {
  Points forces(state.x.size(), Vec3::Zero());
  add_load_forces(loads, {state.time, state.x, state.v}, forces);
  const auto mass = model.lumped_mass();
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < forces.size(); ++i)
    sum += forces[i] + mass[i] * (loads.gravity - loads.mass_damping * state.v[i]);
  return sum;
}

Vec3 load_force(const Load& load, const State& state) {
  Points forces(state.x.size(), Vec3::Zero());
  load.add_force({state.time, state.x, state.v}, forces);
  Vec3 sum = Vec3::Zero();
  for (const Vec3& force : forces)
    sum += force;
  return sum;
}

Power power(ForceModel& model, const Loads& loads, const State& state, const Points& acceleration) {
  Power power;
  for (const auto& load : loads.acting)
    if (load->nature() == Nature::dissipative)
      power.dissipated -= power_of(*load, state);
  const Constraints constraints(loads, state.x.size());
  if (constraints.held().empty())
    return power;
  const Points missing = missing_force(model, loads, state, acceleration);
  for (const auto& held : constraints.held()) {
    const Vec3& v = state.v[held.corner];
    power.supports += missing[held.corner].dot(v - constraints.freedom(held.corner).project * v);
  }
  return power;
}

double driving_power(const Loads& loads, const State& state) {
  double sum = 0;
  for (const auto& load : loads.acting)
    if (load->nature() == Nature::driving)
      sum += power_of(*load, state);
  return sum;
}

void book(const Power& at_begin, const Power& at_end, const double dt, State& after) {
  const auto add = [&](const std::string& name, const double a, const double b) {
    after.numbers[name] += 0.5 * dt * (a + b);
  };
  add(dissipated_energy, at_begin.dissipated, at_end.dissipated);
  add("work of supports [J]", at_begin.supports, at_end.supports);
  add("work of loads [J]", at_begin.loads, at_end.loads);
}

Vec3 momentum(const ForceModel& model, const State& state) {
  const auto mass = model.lumped_mass();
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < mass.size(); ++i)
    sum += mass[i] * state.v[i];
  return sum;
}

Vec3 angular_momentum(const ForceModel& model, const State& state, const Vec3& about) {
  const Points p = momenta(model, state.v);
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < p.size(); ++i)
    sum += (state.x[i] - about).cross(p[i]);
  return sum;
}

} // namespace kerf::dynamics
