#pragma once

/// Where a body is at the start of a run, and how it moves, when it is not at rest.

#include "scene/body.h"
#include "scene/composing.h"

namespace kerf::scene {

struct InitialStateParameters {
  std::string displacement = "0; 0; 0"; ///< [m]
  std::string velocity = "0; 0; 0";     ///< [m/s]
  void describe(Parameters& p);
};

/// Reads the section and checks that it is finite everywhere in the body.
InitialState compose_initial_state(const Section& section);

/// Puts every particle that no support holds where body.initial has it, and crumbs with the mean rotation of their
/// corners there; what supports hold moves as they begin to, in a thousandth of a time step [s]; what integrators
/// remember is forgotten. Nothing for a body without an initial state.
void put_in_initial_state(Body& body, double time_step);

/// Surfaces that cut at time 0 cut a body at rest: before them, and with the initial state after them.
void put_at_rest(Body& body);

} // namespace kerf::scene
