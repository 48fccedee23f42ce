#pragma once

/// Integrators by name.

#include "physics/physics.h"
#include "scene/composing.h"

namespace kerf::scene {

/// An integrator, and what it needs of elements.
struct Integrator {
  physics::StepperMaker make;
  double sliver_floor = 0; ///< [1]
  double mass_spread = 0;  ///< [1]
};

/// The integrator `name` with the settings of its section and of `Adaptive step` inside the body's section.
Integrator compose_integrator(const Section& body, const std::string& name);

} // namespace kerf::scene
