#pragma once

/// A body that is cut again and again, with all that a backend sees of it.

#include "cut/add_cuts.h"
#include "dynamics/explicit_steppers.h"
#include "physics/physics.h"
#include "tests/support/placed.h"

namespace kerf::physics {

struct GrowingCut {
  support::Body body;
  grid::CellComplex complex = grid::build_complex(body.grid, body.cuts);
  surface::SurfaceIndex index = {};
  surface::Surface surface = surface::build_surface(body.grid, body.cuts, complex, index);

  explicit GrowingCut(const support::Body& whole) : body(support::with_placed_skin(whole)) {}

  CutBody seen() const { return {body.grid, body.cuts, complex, surface}; }

  /// Cuts edges, and lets physics and state follow. Returns what has changed.
  grid::ComplexChange cut(const std::vector<grid::EdgeCut>& cuts, Physics& physics, dynamics::State& state) {
    const auto edges =
      cut::add_cuts(body.grid, body.cuts, complex, grid::rest_positions(body.grid, complex), cuts, cut::Front::possible)
        .edges;
    surface::place(body.grid, body.cuts, {});
    const auto change = grid::update_complex(body.grid, body.cuts, edges, complex);
    surface::update_surface(body.grid, body.cuts, complex, edges, change, surface, index);
    physics.follow_cut(seen(), {edges, change}, state);
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
