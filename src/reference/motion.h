#pragma once

/// Motion by deal.II on fitted meshes: M a + c M v + K u = f at small strain, with the matrices of equilibrium
/// (solution.h), in time by generalised alpha (Chung and Hulbert 1993, J. Appl. Mech. 60, 371-375), of order 2;
/// spectral radius 1 keeps the energy.

#include "reference/problem.h"

namespace kerf::reference {

struct TimeStepping {
  double time_step = 0; ///< [s]
  int n_steps = 1;
  double mass_damping = 0;    ///< c [1/s]
  double spectral_radius = 1; ///< of the highest modes, in [0, 1]
};

/// At time 0; none: at rest.
struct Beginning {
  Field displacement = nullptr; ///< [m]
  Field velocity = nullptr;     ///< [m/s]
};

/// Displacements [m] of the points at the times 0, dt, ..., n dt under loads that act from time 0 on and do not change.
/// The mesh is adapted for equilibrium under these loads. Throws as solve(), ParameterError where a support moves or
/// the steps cannot be, DataError for a point outside of the body.
std::vector<Points> motion(const Problem& problem, const Discretisation& discretisation, const TimeStepping& in_time,
                           const Points& points, const Beginning& beginning = {});

} // namespace kerf::reference
