#pragma once

/// Crumbs (grid/crumbs.h) as rigid bodies of their own mass and inertia, beside the particles of any backend.
///
/// The backend knows nothing of their material: to it, their particles are carried (dynamics::Loads::carried), points
/// without mass that stay where they are in its step. After it the crumbs move, and their particles and corners with
/// them. Their flight is exact in gravity and mass damping, and keeps spin and energy of rotation to round-off
/// (dynamics/rigid_body.h). Loads push a crumb with the forces of the step's end, as implicit Euler does, by at most 20
/// iterations of Newton's method for its six unknowns, and in such a step gravity and damping do as they do. A step in
/// which crumbs gain more than 1 % of their kinetic energy from nothing is taken again in up to 64 substeps. A support
/// moves a crumb by the corners that it holds; the change of motion that this takes is the least in kinetic energy. In
/// statics a crumb that nothing holds stays where it is.
///
/// A piece that becomes a crumb keeps its momentum and the mean rotation and angular velocity of its material; what it
/// was deformed by is gone at once, and its angular momentum is that of the material, no longer of masses at corners.
/// One that becomes material again leaves its particles where they are and as they move, and so gives back what
/// becoming one took; what momentum changes by as masses are weighed otherwise, they get as one velocity.

#include "dynamics/quantities.h"
#include "dynamics/stepper.h"
#include "physics/crumb_body.h"

#include <functional>
#include <span>

namespace kerf::physics {

/// The particles of a backend that has its own.
struct CrumbParticles {
  std::vector<std::uint32_t> crumb; ///< in grid::Crumbs::all, of each particle; `none`
  std::span<const double> mass;     ///< [kg]; a crumb weighs what its own do, and has their centre of mass
  const Points& rest;               ///< [m]

  static constexpr std::uint32_t none = 0xffffffff;
};

class Crumbs {
 public:
  explicit Crumbs(const double density) : density_(density) {}

  /// Takes over the crumbs that there are now. A new one moves as its corners do, which are asked for if there is one.
  /// Fills state.crumbs, and places what the crumbs carry. `particles`: null where they are the corners.
  void follow(const grid::Solid& solid, const CrumbParticles* particles,
              const std::function<Motion()>& motion_of_corners, dynamics::State& state);

  /// Moves the crumbs to state.time, by dt; all else has been moved there. In statics nothing flies.
  /// Throws dynamics::StepError where loads leave no way.
  void step(const dynamics::Loads& loads, double dt, dynamics::MotionKind kind, dynamics::State& state);

  /// After a cut. What loads with a potential have got by it, as their points went along with material that is rigid
  /// now, crumbs let out: they go down the slope of these loads (dynamics/relief.h), in steps
  /// W d / tau^2 = push, W their inertia, until loads have no more than they `had` [J]. Velocities stay.
  void let_out(const dynamics::Loads& loads, double had, dynamics::State& state) const;

  /// Lets all crumbs move as their corners do now, with what they carry.
  void put(const Motion& of_corners, dynamics::State& state) const;
  /// Puts the corners of crumbs where they are.
  void place_corners(const dynamics::State& state, Points& corners) const;
  /// Gives the corners of crumbs their velocities [m/s].
  void put_velocities(const dynamics::State& state, Points& of_corners) const;

  /// Of all crumbs, where they rest.
  std::vector<dynamics::RigidMotion> at_rest() const;

  bool any() const { return !crumbs_.empty(); }
  std::size_t size() const { return crumbs_.size(); }
  const dynamics::RigidBody& body(const std::size_t i) const { return crumbs_[i].body; }
  /// Loads::carried, by particle: those of crumbs, and lapsed corners (grid/complex.h).
  const std::vector<std::uint8_t>& carried() const { return carried_; }
  bool carries(const std::size_t particle) const { return particle < carried_.size() && carried_[particle] != 0; }
  /// Mass that each particle would have of its crumb [kg]; empty without crumbs.
  const std::vector<double>& carried_mass() const { return carried_mass_; }

  double mass() const;
  double kinetic_energy(const dynamics::State& state) const;
  double gravity_energy(const dynamics::Loads& loads, const dynamics::State& state) const;
  Vec3 momentum(const dynamics::State& state) const;
  Vec3 angular_momentum(const dynamics::State& state, const Vec3& about) const;

  void archive(Archive& a) {
    a.name("crumbs");
    a(crumbs_, crumb_of_, carried_, carried_mass_, reactions_, work_of_supports_);
  }

  /// What supports did in the last step: force and torque about the origin of each, and their work [J].
  const std::vector<dynamics::Reaction>& reactions() const { return reactions_; }
  double work_of_supports() const { return work_of_supports_; }

 private:
  struct Crumb : CrumbBody {
    std::uint32_t name;
    std::vector<std::uint32_t> particles;
    Points rest_of_particles;

    void archive(Archive& a) {
      CrumbBody::archive(a);
      a(name, particles, rest_of_particles);
    }
  };
  /// A particle that a support holds.
  struct Hold {
    std::size_t support, index; ///< in Loads::supports, in its corners
    Vec3 rest;                  ///< of the particle [m]
  };
  using Motions = std::vector<dynamics::RigidMotion>;

  void take_particles(const grid::Solid& solid, const CrumbParticles* particles);
  /// Puts particles where these motions have them.
  void carry(const Motions& motions, dynamics::State& state) const;
  /// Force [N], and torque about the centre [N m].
  struct Wrench {
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  };
  /// Where loads push the crumbs within dt that would fly from `start` to `flown`.
  Motions pushed(const dynamics::Loads& loads, double dt, const Motions& start, Motions flown,
                 std::vector<Wrench>& wrenches, dynamics::State& state) const;
  /// Whether the energy of all crumbs together grows by hardly anything that nobody gave.
  bool gains_nothing(const dynamics::Loads& loads, double dt, const Motions& start, const Motions& end,
                     dynamics::State& state) const;
  /// Of loads on each crumb, about its centre; and how they stiffen its modes.
  struct Push;
  std::vector<Push> pushes(const dynamics::Loads& loads, double dt, const Motions& motions,
                           const dynamics::State& state) const;
  void fly(const dynamics::Loads& loads, double dt, std::vector<Wrench>& pushes, dynamics::State& state) const;
  void hold(const dynamics::Loads& loads, double dt, const Motions& start, const std::vector<Wrench>& pushes,
            dynamics::State& state);
  /// Where a support has its corners before and after a step.
  struct Way {
    dynamics::Support::Places from, to;
  };
  void obey(const dynamics::Loads& loads, std::span<const Hold> holds, std::span<const Way> ways, double dt,
            const dynamics::RigidBody& body, dynamics::RigidMotion& motion) const;
  std::vector<std::vector<Hold>> holds(const dynamics::Loads& loads) const;

  double density_;
  std::vector<Crumb> crumbs_;           // as grid::Crumbs::all
  std::vector<std::uint32_t> crumb_of_; // by particle
  std::vector<std::uint8_t> carried_;
  std::vector<double> carried_mass_;
  std::vector<dynamics::Reaction> reactions_;
  double work_of_supports_ = 0;
};

/// Of all of the body: what its model moves, and its crumbs [kg m/s].
Vec3 momentum(std::span<const double> mass, const Crumbs& crumbs, const dynamics::State& state);

/// Gives these particles one velocity more, so that the body's momentum is what it was; all of them, where that were
/// more than a hundredth of theirs.
void restore_momentum(const Vec3& had, std::span<const std::uint32_t> particles, std::span<const double> mass,
                      const Crumbs& crumbs, dynamics::State& state);

} // namespace kerf::physics
