#include "scene/accounts.h"

#include "dynamics/forces.h"
#include "physics/physics.h"

namespace kerf::scene {

double total_energy(physics::Physics& physics, const dynamics::Loads& loads, const dynamics::State& state) {
  const dynamics::ForceModel& model = physics.model();
  return model.energy(state.x) + dynamics::kinetic_energy(model, state.v) +
         dynamics::gravity_energy(model, loads, state.x) + dynamics::load_energy(loads, state.time, state.x);
}

void Accounts::open(physics::Physics& physics, const dynamics::Loads& loads, const dynamics::State& state) {
  start_energy_ = total_energy(physics, loads, state);
  reactions_.assign(loads.supports.size(), {});
}

void Accounts::after_step(physics::Physics& physics, const dynamics::Loads& loads, dynamics::State& state) {
  const double dt = state.time - before_.time;
  const Points acceleration = dynamics::mean_acceleration(before_, state);
  reactions_ = dynamics::reactions(physics.model(), loads, state, acceleration, Vec3::Zero());
  dynamics::State from = before_, to{state.x, {}, state.time};
  for (std::size_t i = 0; i < state.x.size(); ++i)
    from.v[i] = (state.x[i] - before_.x[i]) / dt;
  to.v = from.v;
  const bool is_known = acceleration_.size() == acceleration.size(); // not in the first step, nor after a cut
  const auto at_begin = dynamics::power(physics.model(), loads, from, is_known ? acceleration_ : acceleration);
  const auto at_end = dynamics::power(physics.model(), loads, to, acceleration);
  dynamics::book(at_begin, at_end, dt, state);
  acceleration_ = acceleration;
}

} // namespace kerf::scene
