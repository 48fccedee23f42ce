#pragma once

/// Where a body's energy goes, and what holds it: kept only when an observable asks.
///
/// Work is force times displacement, so statics has work too. Of supports, and of loads that dissipate, the force is
/// the mean of those at the step's ends; in a step that begins anew after a cut, where forces of stiff loads may have
/// been ringing, that at its end. Of loads that drive, as a pressure, it is that half-way: at the ends of its chord a
/// body that turns is swollen. What supports spend on inertia is mass times mean acceleration times mean velocity,
/// which is the kinetic energy's growth: a held corner's velocity is that of the step that led there, and lags.
/// Reactions are those at the end of the step.
/// Everything that happens to the energy at an instant of cutting is the work of the cut.
/// energy + dissipated - works of supports, loads and cut stays what it was at the start, up to the integrator's error;
/// in statics what is missing is what the body gave away on its way from one equilibrium to the next: for a cut that
/// grows under load, the energy released.

#include "dynamics/quantities.h"

namespace kerf::physics {
class Physics;
}

namespace kerf::scene {

/// With those of crumbs [J].
double kinetic_energy(physics::Physics& physics, const dynamics::State& state);
double gravity_energy(physics::Physics& physics, const dynamics::Loads& loads, const dynamics::State& state);
/// Kinetic and elastic energies [J].
double inner_energy(physics::Physics& physics, const dynamics::State& state);
/// Kinetic, elastic and potential energies together [J].
double total_energy(physics::Physics& physics, const dynamics::Loads& loads, const dynamics::State& state);

class Accounts {
 public:
  /// Opens the books at a state.
  void open(physics::Physics& physics, const dynamics::Loads& loads, const dynamics::State& state);

  /// Around each step.
  void before_step(const dynamics::State& state) { before_ = state; }
  void after_step(physics::Physics& physics, const dynamics::Loads& loads, bool begins_anew, dynamics::State& state);

  /// What a cut did to the energy [J].
  void add_work_of_cut(const double work) { work_of_cut_ += work; }

  void archive(Archive& a) {
    a.name("accounts");
    a(start_energy_, work_of_cut_, kinetic_energy_of_crumbs_, reactions_);
  }

  double start_energy() const { return start_energy_; }
  double work_of_cut() const { return work_of_cut_; }
  /// Of each support, in the order of the loads; torques about the origin.
  const std::vector<dynamics::Reaction>& reactions() const { return reactions_; }

 private:
  double start_energy_ = 0, work_of_cut_ = 0, kinetic_energy_of_crumbs_ = 0; // [J]
  dynamics::State before_;
  std::vector<dynamics::Reaction> reactions_;
};

} // namespace kerf::scene
