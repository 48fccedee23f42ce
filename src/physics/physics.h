#pragma once

/// The contract of a backend: one kind of physics of a cut body, and what a scene needs of it. Behind it a backend has
/// particles, which are the unknowns of its State: the corners of the copies, or samples of its own. Blades, surface
/// and images see corners only, so every backend moves the very same cut.

#include "base/interpolation.h"
#include "dynamics/stepper.h"
#include "grid/solid.h"
#include "physics/crumbs.h"
#include "surface/surface.h"

#include <functional>
#include <memory>

namespace kerf::physics {

/// The body that a backend lives in. Refers to what must outlive it.
struct CutBody {
  const grid::Solid& solid;
  const surface::Surface& surface;
  double density; ///< of its material [kg/m^3]
  const grid::Pieces* pieces = nullptr; ///< of its copies; null: not known
};

/// The piece of each particle, 0, 1, ...: asked for by those who need it.
using PiecesOfParticles = std::function<std::vector<std::uint32_t>()>;

/// An integrator for a model; made again after every cut.
using StepperMaker =
  std::function<std::unique_ptr<dynamics::Stepper>(dynamics::ElasticModel&, const PiecesOfParticles&)>;

/// Before a cut [J].
struct EnergyBefore {
  double elastic, of_loads;
};

class Physics {
 public:
  virtual ~Physics() = default;

  /// The model whose unknowns are the particles.
  virtual dynamics::ForceModel& model() = 0;
  /// Rest positions of the particles [m].
  virtual const Points& rest() const = 0;
  /// Whether the particles are the corners of the copies, and not samples of its own.
  virtual bool particles_are_corners() const = 0;
  /// What the model does not know: pieces that move as rigid bodies. Loads must carry what they carry.
  virtual const Crumbs& crumbs() const = 0;
  /// What its steps make of inertia.
  virtual dynamics::MotionKind motion() const = 0;

  /// Advances the particles by dt [s]. Throws as dynamics::Stepper.
  virtual dynamics::StepReport step(dynamics::State& state, const dynamics::Loads& loads, double dt) = 0;

  /// Follows a cut of the body, and so does the state: new particles take what their parents have.
  virtual void follow_cut(const CutBody& body, const grid::CutChange& change, dynamics::State& state) = 0;
  /// After follow_cut(), with the loads that there are now: lets out of what it has touched the elastic energy that it
  /// gave (dynamics/relief.h), and what became crumbs that of loads with a potential.
  virtual void let_out(const CutBody& body, const grid::CutChange& change, const EnergyBefore& had,
                       const dynamics::Loads& loads, dynamics::State& state) = 0;
  /// Does a step's share of what cuts have left to do. Says whether carry() is another one now.
  virtual bool catch_up(const CutBody&) { return false; }
  /// What it knows beside the state and the body; into one that was made of the same body before its first cut.
  virtual void archive(Archive& a, const CutBody& body) = 0;

  /// Moves what depends on the particles to where they are.
  virtual void follow(const dynamics::State&) {}
  /// Positions of the corners when follow() was called last with this state [m].
  virtual const Points& corners(const dynamics::State& state) const = 0;
  /// Points that follow corners, as points that follow particles: for forces on them. Sums of weights, and of weights
  /// times rest positions, stay what they are.
  virtual Interpolation carry(const Interpolation& of_corners) const = 0;
  /// The same of points on which loads act that do not yield: to particles with enough material to bear them.
  virtual Interpolation bear(const CutBody&, const Interpolation& of_corners) const { return carry(of_corners); }
};

/// A body at rest: all particles where they are at rest, at time 0.
dynamics::State state_at_rest(const Physics& physics);

/// A rest point [m] as a point that follows corners; no point where the body has no material.
Interpolation body_point(const CutBody& body, const Vec3& rest);

} // namespace kerf::physics
