#include "scene/accounts.h"

#include "dynamics/forces.h"
#include "physics/physics.h"

namespace kerf::scene {

namespace {

/// What supports spend on the kinetic energy of what they hold, exactly [W].
double power_of_inertia(const dynamics::ForceModel& model, const dynamics::Loads& loads, const dynamics::State& before,
                        const dynamics::State& after, const Points& acceleration) {
  const Points inertia = dynamics::momenta(model, acceleration);
  const dynamics::Constraints constraints(loads, after.x.size());
  double sum = 0;
  for (const auto& held : constraints.held()) {
    const Vec3 v = 0.5 * (before.v[held.corner] + after.v[held.corner]);
    sum += inertia[held.corner].dot(v - constraints.freedom(held.corner).project * v);
  }
  return sum;
}

} // namespace

double kinetic_energy(physics::Physics& physics, const dynamics::State& state) {
  return dynamics::kinetic_energy(physics.model(), state.v) + physics.crumbs().kinetic_energy(state);
}

double gravity_energy(physics::Physics& physics, const dynamics::Loads& loads, const dynamics::State& state) {
  return dynamics::gravity_energy(physics.model(), loads, state.x) + physics.crumbs().gravity_energy(loads, state);
}

double inner_energy(physics::Physics& physics, const dynamics::State& state) {
  return physics.model().energy(state.x) + kinetic_energy(physics, state);
}

double total_energy(physics::Physics& physics, const dynamics::Loads& loads, const dynamics::State& state) {
  return inner_energy(physics, state) + gravity_energy(physics, loads, state) +
         dynamics::load_energy(loads, state.time, state.x);
}

void Accounts::open(physics::Physics& physics, const dynamics::Loads& loads, const dynamics::State& state) {
  start_energy_ = total_energy(physics, loads, state);
  reactions_.assign(loads.supports.size(), {});
}

void Accounts::after_step(physics::Physics& physics, const dynamics::Loads& loads, const bool begins_anew,
                          dynamics::State& state) {
  const double dt = state.time - before_.time;
  const Points acceleration = dynamics::mean_acceleration(before_, state), none(state.x.size(), Vec3::Zero());
  reactions_ = dynamics::reactions(physics.model(), loads, state, acceleration, Vec3::Zero());
  const auto& of_crumbs = physics.crumbs().reactions();
  for (std::size_t s = 0; s < of_crumbs.size(); ++s) {
    reactions_[s].force += of_crumbs[s].force;
    reactions_[s].torque += of_crumbs[s].torque;
  }
  dynamics::State from = before_, to{state.x, {}, state.time};
  for (std::size_t i = 0; i < state.x.size(); ++i)
    from.v[i] = (state.x[i] - before_.x[i]) / dt;
  to.v = from.v;
  auto at_end = dynamics::power(physics.model(), loads, to, none),
       at_begin = begins_anew ? at_end : dynamics::power(physics.model(), loads, from, none);
  // Half-way, where the way of a step in which a body turns is one by a rotation; at its ends it is a strain as well.
  dynamics::State half_way{state.x, from.v, 0.5 * (before_.time + state.time)};
  for (std::size_t i = 0; i < state.x.size(); ++i)
    half_way.x[i] = 0.5 * (before_.x[i] + state.x[i]);
  const double by_damping = dynamics::damping_power(physics.model(), loads, half_way);
  at_begin.dissipated += by_damping;
  at_end.dissipated += by_damping;
  at_begin.loads = at_end.loads = dynamics::driving_power(loads, half_way);
  const double inertia = power_of_inertia(physics.model(), loads, before_, state, acceleration);
  at_begin.supports += inertia;
  at_end.supports += inertia;
  at_begin.dissipated += 2 * loads.mass_damping * kinetic_energy_of_crumbs_;
  kinetic_energy_of_crumbs_ = physics.crumbs().kinetic_energy(state);
  at_end.dissipated += 2 * loads.mass_damping * kinetic_energy_of_crumbs_;
  dynamics::book(at_begin, at_end, dt, state);
  state.numbers["work of supports [J]"] += physics.crumbs().work_of_supports();
  // What potentials that change with time add, with the body held still.
  const auto by_time = [&](const Points& x, const double from, const double to_time) {
    return dynamics::load_energy(loads, to_time, x) - dynamics::load_energy(loads, from, x);
  };
  constexpr double part = 0.01; // of the step
  state.numbers["work of loads [J]"] +=
    begins_anew ? by_time(state.x, state.time - part * dt, state.time + part * dt) / (2 * part)
                : 0.5 * (by_time(before_.x, before_.time, state.time) + by_time(state.x, before_.time, state.time));
}

} // namespace kerf::scene
