#include "lattice/relief.h"

#include "base/loan.h"
#include "dynamics/forces.h"

namespace kerf::lattice {

void Relief::settle(const std::span<const std::uint8_t> is_held, dynamics::State& state) const {
  Loan<Vec3> goals = Loan<Vec3>::with_room(state.x.size());
  model_.goals(state.x, goals);
  for (std::size_t c = 0; c < goals.size(); ++c)
    if (is_held[c] != 0)
      goals[c] = state.x[c];
  model_.riders().settle(goals, model_.lumped_mass(), state.x, state.v);
}

dynamics::StepReport Relief::step(dynamics::State& state, const dynamics::Loads& loads, double) {
  constexpr int most_rounds = 40;
  const auto is_held = dynamics::held_corners(loads, state.x.size());
  settle(is_held, state);
  double energy = model_.energy(state.x);
  if (energy <= excess_.most)
    return {};
  const double first = energy;
  const dynamics::State before = state;
  const dynamics::Pieces pieces(excess_.piece());
  const auto gravity = dynamics::gravity_on_held(pieces, loads, state.x.size());
  model_.spread_over_regions(excess_.touched);
  Loan<Vec3> goals = Loan<Vec3>::with_room(state.x.size());
  for (int round = 0; round < most_rounds && energy > excess_.most; ++round) {
    model_.goals(state.x, goals);
    const auto go = [&](const double part) {
      for (std::size_t c = 0; c < goals.size(); ++c)
        if (excess_.touched[c] != 0 && is_held[c] == 0)
          state.x[c] += part * (goals[c] - state.x[c]);
      energy = model_.energy(state.x);
    };
    const double had = energy;
    const Points start = state.x;
    go(1);
    if (energy + dynamics::lift(model_.lumped_mass(), gravity, start, state.x) >= had) { // what hangs would be lifted
      state.x = start;
      energy = had;
      break;
    }
    if (energy < excess_.most) { // no more than must be: along this way energy is convex
      state.x = start;
      go((had - excess_.most) / (had - energy));
    }
  }
  dynamics::keep_moments(pieces, model_.lumped_mass(), loads, before, state);
  if (kinetic_energy(model_, state.v) - kinetic_energy(model_, before.v) > first - energy) // see dynamics::Relief
    state = before;
  return {};
}

} // namespace kerf::lattice
