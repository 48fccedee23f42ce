#pragma once

/// A step among some corners alone (grid/corner_numbers.h): the integrator gets a state and loads of theirs, and the
/// body's state takes what comes out. The others stay where they are.

#include "dynamics/stepper.h"
#include "grid/corner_numbers.h"

namespace kerf::physics {

/// Throws as the stepper does; a dynamics::StepError names the corner.
dynamics::StepReport narrowed_step(dynamics::Stepper& stepper, const grid::CornerNumbers& numbers,
                                   dynamics::State& state, const dynamics::Loads& loads, double dt);

/// Of loads on all corners what acts on some. The loads, the state and the numbers must outlive it.
dynamics::Loads narrowed(const dynamics::Loads& loads, const dynamics::State& state,
                         const grid::CornerNumbers& numbers);

} // namespace kerf::physics
