#pragma once

/// A body that is cut again and again, with all that a backend sees of it.

#include "cut/cutter.h"
#include "dynamics/explicit_steppers.h"
#include "physics/physics.h"
#include "tests/support/placed.h"

namespace kerf::physics {

struct GrowingCut {
  support::Body body;
  surface::SurfaceIndex index = {};
  surface::Surface surface;
  cut::Cutter cutter;

  explicit GrowingCut(const support::Body& whole, const cut::Fronts fronts = cut::Fronts::at_faces)
    : body(support::with_placed_skin(whole)), cutter(9, cut::Release::queued, fronts) {
    body.complex = grid::build_complex(body);
    surface = surface::build_surface(body, index);
    cutter.begin(body, rest());
  }

  CutBody seen() const { return {body, surface, 1000}; }
  Points rest() const { return grid::rest_positions(body); }

  /// Cuts, and lets physics and state follow. Returns what has changed.
  grid::CutChange cut(const cut::SweepCuts& cuts, Physics& physics, dynamics::State& state) {
    return follow(cutter.cut(body, cuts), physics, state);
  }
  grid::CutChange cut(const cut::Shape& shape, Physics& physics, dynamics::State& state) {
    return follow(cutter.at_once(body, {"cut", shape, 1}, rest()), physics, state);
  }
  /// A blade's step, past corners that rest.
  grid::CutChange step(const cut::Blade& blade, const double t0, const double t1, Physics& physics,
                       dynamics::State& state) {
    return follow(cutter.step(body, std::span(&blade, 1), t0, t1, rest()), physics, state);
  }

 private:
  grid::CutChange follow(grid::CutChange change, Physics& physics, dynamics::State& state) {
    surface::place(body, change, {});
    surface::update_surface(body, change, surface, index);
    physics.follow_cut(seen(), change, state);
    return change;
  }
};

inline Points random_points(const std::size_t n, support::Random& random) {
  Points points(n);
  for (Vec3& p : points)
    p = support::random_vector(random);
  return points;
}

/// Any stepper will do where nothing steps.
inline std::unique_ptr<dynamics::Stepper> verlet(dynamics::ElasticModel& model, const PiecesOfParticles&) {
  return std::make_unique<dynamics::VelocityVerlet>(model, dynamics::ExplicitOptions{});
}

} // namespace kerf::physics
