#pragma once

/// What can be asked of a moving body: reactions of its supports, power, and how its energy comes and goes.
///
/// The reaction at a held corner is what the balance of forces lacks there: R = M a + alpha M v + beta K v - f(x) - M
/// g - loads, along its held directions; where several supports hold, each has its share H S^+ R (constraints.h).
/// Then the momentum changes by gravity, loads, mass damping and reactions, exactly.
///
/// Along a motion, kinetic + elastic + gravity + energy of loads = that at the start + work of supports + work of
/// loads - dissipated energy, up to the integrator's error.

#include "dynamics/constraints.h"
#include "dynamics/state.h"

namespace kerf::dynamics {

/// Mean accelerations between two states [m/s^2]; zero between states of one time.
Points mean_acceleration(const State& before, const State& after);

struct Reaction {
  Vec3 force = Vec3::Zero();  ///< of the support on the body [N]
  Vec3 torque = Vec3::Zero(); ///< of it about a point [N m]

  void archive(Archive& a) { a(force, torque); }
};

/// One for each of loads.supports; torques about `about` [m]. acceleration [m/s^2] a corner.
std::vector<Reaction> reactions(ForceModel& model, const Loads& loads, const State& state, const Points& acceleration,
                                const Vec3& about);

/// Gravity, loads and mass damping together, reactions left out [N].
Vec3 external_force(const ForceModel& model, const Loads& loads, const State& state);
/// Force of one load on the body [N].
Vec3 load_force(const Load& load, const State& state);

/// What Rayleigh damping takes a second [W].
double damping_power(ForceModel& model, const Loads& loads, const State& state);

/// Energy a second [W].
struct Power {
  double dissipated = 0; ///< by dissipative loads
  double supports = 0;   ///< work of the reactions
  double loads = 0;      ///< work of driving loads
};
/// Damping (damping_power) and driving loads (driving_power) are left out.
Power power(ForceModel& model, const Loads& loads, const State& state, const Points& acceleration);

/// Of driving loads [W].
double driving_power(const Loads& loads, const State& state);

/// Adds what flowed during a step, by the trapezoidal rule, to State::numbers "dissipated energy [J]", "work of
/// supports [J]" and "work of loads [J]" of `after`. Potentials that change with time do work that is not booked.
void book(const Power& at_begin, const Power& at_end, double dt, State& after);

Vec3 momentum(const ForceModel& model, const State& state);
/// About `about` [m]; [kg m^2/s].
Vec3 angular_momentum(const ForceModel& model, const State& state, const Vec3& about);

} // namespace kerf::dynamics
