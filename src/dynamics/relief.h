#pragma once

/// What a cut gave is let out.
///
/// The problem: a cut makes energy another function of the positions. Near-empty copies are held by a penalty that was
/// not there, partial elements condense other modes, phyxels lose neighbours that their gradients were fitted to. So at
/// the same positions there may be more elastic energy than before, which nobody gave, and which would throw what the
/// cut has touched.
///
/// The method: what the cut has touched goes towards its balance, all else held, by implicit steps of the gradient flow
///
///     M (x' - x) / tau^2 = f(x'),
///
/// each of which takes energy, until there is no more than there was. f has the loads with a potential too, as handles
/// that strain the body, and in pieces that are held gravity; a step that these ask for more than it lets out is not
/// taken: else what hangs would rise by what its cut gave, and what a handle holds would snap away from it. With e
/// the excess, the first has tau^2 = e / f.M^-1 f, the way down the slope that would take it; each further one four
/// times that tau. What the touched cannot let out by themselves the whole body does, in the same way. Then every piece
/// that nothing holds is shifted, and its velocities are turned, so that its masses' centre and its angular momentum
/// are what they were.
///
/// Limits: a piece may come to a balance of its own with energy left, as was seen of points; that stays.

#include "dynamics/model.h"
#include "dynamics/pieces.h"
#include "dynamics/stepper.h"

#include <functional>

namespace kerf::dynamics {

/// What is to be let out of a body, and where.
struct Excess {
  double most = 0;                   ///< energy that there may be [J]
  std::vector<std::uint8_t> touched; ///< 1 for each particle that the cut has touched
  std::function<std::vector<std::uint32_t>()> piece; ///< of each particle, 0, 1, ...
};

/// Elastic energy that a cut may leave where there were `had` [J] before: a thousandth more, of it and of the motion
/// against the mean one.
double most_after_cut(const ForceModel& model, double had, const Points& v);

/// Gravity of each particle, none of those in pieces that fall [m/s^2].
Loan<Vec3> gravity_on_held(const Pieces& pieces, const Loads& loads, std::size_t n_particles);
/// What such gravity asks for to come from one place to another [J].
double lift(std::span<const double> mass, const Points& gravity, const Points& from, const Points& to);

/// Shifts pieces that loads hold nowhere, and turns their velocities, so that their masses' centres and their angular
/// momenta are as before.
void keep_moments(const Pieces& pieces, std::span<const double> mass, const Loads& loads, const State& before,
                  State& after);

/// A step lets out what it can; time stands still, dt is not asked for.
class Relief : public Stepper {
 public:
  /// The model must outlive it.
  Relief(ElasticModel& model, Excess excess) : model_(model), excess_(std::move(excess)) {}

  StepReport step(State& state, const Loads& loads, double dt) override;

 private:
  /// Moves what is marked (1) until nothing is left of the excess, or no more goes; returns what is left of it.
  /// `gravity` of each particle; none where a piece falls [m/s^2].
  double flow(std::span<const std::uint8_t> is_marked, const Loads& loads, const Points& gravity, double excess,
              State& state, StepReport& report) const;

  ElasticModel& model_;
  Excess excess_;
};

} // namespace kerf::dynamics
