#pragma once

/// Sums of all that acts on a body.

#include "dynamics/loads.h"
#include "dynamics/mass_sums.h"
#include "dynamics/pieces.h"
#include "dynamics/state.h"

namespace kerf::dynamics {

/// Adds the forces of loads.acting [N].
void add_load_forces(const Loads& loads, const Moment& moment, Points& forces);
/// Their potentials [J]: of the conservative ones.
double load_energy(const Loads& loads, double time, const Points& x);
/// Sum of their tangents, see Load::add_tangent.
LoadTangent load_tangent(const Loads& loads, Tangent kind, const Moment& moment, double velocity_factor);

/// Elastic forces, gravity, damping and loads, together [N]. Linearises the model at moment.x if stiffness is damped; a
/// model that has no stiffness to offer damps it in a way of its own, which is left out.
void total_force(ForceModel& model, const Loads& loads, const Moment& moment, Points& forces);
/// The same but for gravity and mass damping, which are accelerations: a stepper may take damping implicitly.
void applied_force(ForceModel& model, const Loads& loads, const Moment& moment, Points& forces);

/// A value over a mass; zero where there is none, as at corners that a rigid body carries (Loads::carried).
inline double per_mass(const double value, const double mass) { return mass > 0 ? value / mass : 0; }
inline Vec3 per_mass(const Vec3& value, const double mass) {
  return mass > 0 ? Vec3(value / mass) : Vec3(Vec3::Zero());
}

/// Of a corner under a force beside gravity; zero without a mass [m/s^2].
inline Vec3 acceleration(const Vec3& force, const double mass, const Loads& loads) {
  return mass > 0 ? Vec3(1 / mass * force + loads.gravity) : Vec3(Vec3::Zero());
}

/// (M - diag m) v; nothing where the mass is lumped.
Loan<Vec3> coupled(const ForceModel& model, const Points& v);
/// M v, by corner [kg m/s]; of accelerations, the forces of inertia [N].
Loan<Vec3> momenta(const ForceModel& model, const Points& v);
/// Kinetic energy [J].
double kinetic_energy(const ForceModel& model, const Points& v);
/// Of it, what a mass matrix has beside its lumped masses [J].
double kinetic_energy_of_coupling(const ForceModel& model, const Points& v);
/// By the lumped masses.
MassAndMomentum mass_and_momentum(const ForceModel& model, const Points& v);
/// All in one pass.
MassSums mass_sums(const ForceModel& model, const State& state);
/// Kinetic energy of the motion beside the mean one of each piece [J].
double inner_kinetic_energy(const ForceModel& model, const Pieces& pieces, const Points& v);
/// The same of a `kinetic` energy that is known; `all`: of all pieces.
double inner_kinetic_energy(const ForceModel& model, const Pieces& pieces, const Points& v, double kinetic,
                            const MassAndMomentum& all);
/// -sum of m g.x [J].
double gravity_energy(const ForceModel& model, const Loads& loads, const Points& x);

} // namespace kerf::dynamics
