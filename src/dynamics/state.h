#pragma once

/// What a body's past amounts to. A stepper may be thrown away and made again from it, after a cut or a restart.

#include "base/parallel.h"
#include "dynamics/rigid_body.h"

#include <map>
#include <span>
#include <string>

namespace kerf::dynamics {

struct State {
  Points x;        ///< current corner positions [m]
  Points v;        ///< corner velocities [m/s]
  double time = 0; ///< [s]

  /// What an integrator remembers beside it, by name, one value a corner: new corners inherit it like x and v. Those
  /// that follow from forces do not survive a cut: forget_forces().
  std::map<std::string, Points> history = {};
  /// What it remembers of the whole body: "time step [s]", "dissipated energy [J]".
  std::map<std::string, double> numbers = {};
  /// Of the body's crumbs, in the order of grid::Crumbs::all.
  std::vector<RigidMotion> crumbs = {};

  void archive(Archive& a) {
    a.name("state");
    a(x, v, time, history, numbers, crumbs);
  }
};

/// Names that are looked for in every step: longer than what a string holds in itself.
inline const std::string last_acceleration = "acceleration of the last step", energy_gained = "energy gained [J]",
                         dissipated_energy = "dissipated energy [J]";

/// Makes one state the other but for positions and velocities, in the memory that it has.
inline void assign_but_motion(State& to, const State& from) {
  to.time = from.time;
  to.crumbs = from.crumbs;
  std::erase_if(to.history, [&](const auto& known) { return from.history.count(known.first) == 0; });
  for (const auto& [name, values] : from.history)
    to.history[name] = values;
  std::erase_if(to.numbers, [&](const auto& known) { return from.numbers.count(known.first) == 0; });
  for (const auto& [name, value] : from.numbers)
    to.numbers[name] = value;
}

/// All of it.
inline void assign(State& to, const State& from) {
  copy(from.x, to.x);
  copy(from.v, to.v);
  assign_but_motion(to, from);
}

/// The 3 n numbers of n points.
inline std::span<double> flat(Points& p) { return {p.empty() ? nullptr : p[0].data(), 3 * p.size()}; }
inline std::span<const double> flat(const Points& p) { return {p.empty() ? nullptr : p[0].data(), 3 * p.size()}; }

/// A remembered value a corner; null when there is none, or not for these corners.
inline const Points* remembered(const State& state, const std::string& name) {
  const auto it = state.history.find(name);
  return it == state.history.end() || it->second.size() != state.x.size() ? nullptr : &it->second;
}

/// To be called when forces have changed at once, by a cut for one: what was remembered of them is no longer true. The
/// mean acceleration of the last step stays: it is where the next step begins to look.
inline void forget_forces(State& state) { state.history.erase("acceleration"); }

/// Of what integrators remember beside x and v, nothing: the next step starts anew.
inline void forget_past(State& state) {
  state.history.clear();
  state.numbers.erase("step before [s]");
}

} // namespace kerf::dynamics
