#pragma once

/// Integrators by name.

#include "fem/hexahedra.h"
#include "physics/physics.h"
#include "scene/composing.h"

namespace kerf::scene {

/// An integrator, and what mass it needs of elements.
struct Integrator {
  physics::StepperMaker make;
  fem::Inertia inertia = fem::Inertia::lumped;
};

/// The integrator `name` with the settings of its section and of `Adaptive step` inside the body's section.
Integrator compose_integrator(const Section& body, const std::string& name);

} // namespace kerf::scene
