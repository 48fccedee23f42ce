#include "lattice/relief.h"

#include "base/loan.h"
#include "dynamics/forces.h"

#include <algorithm>

namespace kerf::lattice {

void Relief::settle(const std::span<const std::uint8_t> is_held, dynamics::State& state) const {
  Loan<Vec3> goals = Loan<Vec3>::with_room(state.x.size());
  model_.goals(state.x, goals);
  for (std::size_t c = 0; c < goals.size(); ++c)
    if (is_held[c] != 0 || excess_.touched[c] == 0)
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
    const double asked = dynamics::lift(model_.lumped_mass(), gravity, start, state.x) +
                         dynamics::load_energy(loads, state.time, state.x) -
                         dynamics::load_energy(loads, state.time, start);
    if (energy + asked >= had) { // what hangs would be lifted, or torn from what it hangs on
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
  const double turned = kinetic_energy(model_, state.v) - kinetic_energy(model_, before.v),
               pulled = load_energy(loads, state.time, state.x) - load_energy(loads, state.time, before.x);
  if (turned + std::max(0.0, pulled) > first - energy) // see dynamics::Relief
    state = before;
  return {};
}

} // namespace kerf::lattice
