#pragma once

/// Backends whose particles are the corners of the copies: elements, springs, lattice shape matching. New corners take
/// position, velocity and history from the corner they come from.

#include "dynamics/forces.h"
#include "dynamics/relief.h"
#include "fem/hexahedra.h"
#include "lattice/relief.h"
#include "lattice/shape_matching.h"
#include "physics/bearers.h"
#include "physics/carry_all.h"
#include "physics/narrowed.h"
#include "physics/physics.h"
#include "physics/widened.h"
#include "spring/mass_spring.h"

#include <functional>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

namespace kerf::physics {

/// Elements with explicit integrators: corners of hardly any mass ring for ever once a cut has moved them, take up what
/// the body's vibrations have, and turn their copies inside out. They are riders with slack (lattice/riders.h), damped
/// critically for the frequency of a cube. Of the others none.
inline lattice::Riders riders_of(const dynamics::ForceModel&, const CutBody&) { return {}; }
lattice::Riders riders_of(const fem::Hexahedra& model, const CutBody& body);
inline void damp_riders(const dynamics::ForceModel&, const lattice::Riders&, std::span<const double>,
                        const dynamics::Loads&, double, dynamics::State&) {}
/// `mass` by corner [kg]. What is held keeps its velocity: supports take the impulse.
void damp_riders(const fem::Hexahedra& model, const lattice::Riders& riders, std::span<const double> mass,
                 const dynamics::Loads& loads, double dt, dynamics::State& state);

/// Elements hold light corners by themselves, and the skin's loads are in balance with them; but for what a blade has
/// made thin, which may have any surface.
Bearers bearers_of(const fem::Hexahedra& model, const CutBody& body, std::span<const double> mass);
/// `mass` by corner [kg].
template <class Model>
Bearers bearers_of(const Model&, const CutBody& body, const std::span<const double> mass) {
  const double h = body.solid.grid.h();
  std::vector<double> material(mass.begin(), mass.end());
  for (double& m : material)
    m /= body.density * h * h * h;
  return {body.solid, material, std::vector<std::uint8_t>(mass.size(), 1)};
}

/// Corners that lapse bring their heirs what they had of momentum, angular momentum and place, by mass as it was [kg].
/// The heirs turn for that by what the joining has taken of the kinetic energy at most: one heir has no inertia but
/// round-off, and a few that lie close together hardly any.
void join_lapsed(std::span<const grid::Lapse> lapsed, const std::function<double(std::uint32_t)>& mass,
                 dynamics::State& state);

/// A later cut of a cell moves vertices of earlier ones, and so gives some corners of a node material that others had.
/// Among these corners, what some get brings the mean velocity of what others lose, as bodies that collide and stay
/// together; so no momentum is lost, and no kinetic energy won. Masses by corner [kg], before and now.
void carry_momentum(const grid::CellComplex& complex, std::span<const std::uint32_t> corners,
                    std::span<const double> before, std::span<const double> now, Points& v);

/// What lets out of the corners that a cut has touched what it gave.
inline std::unique_ptr<dynamics::Stepper> relief_of(dynamics::ElasticModel& model, dynamics::Excess excess) {
  return std::make_unique<dynamics::Relief>(model, std::move(excess));
}
inline std::unique_ptr<dynamics::Stepper> relief_of(const lattice::Matching& model, dynamics::Excess excess) {
  return std::make_unique<lattice::Relief>(model, std::move(excess));
}

/// 1 for each corner of copies that a cut has reshaped.
std::vector<std::uint8_t> touched_corners(const grid::CellComplex& complex, const grid::CutChange& change);

/// Of the corners that are counted, by number: pieces without one are left out.
std::vector<std::uint32_t> counted_pieces(std::vector<std::uint32_t> of_corners, const grid::CornerNumbers& numbers);

/// One model on the corners, with an integrator of it. Both see those that the model counts (grid/corner_numbers.h);
/// state and loads are of all.
template <class Model>
class OnCorners : public Physics {
 public:
  using ModelMaker = std::function<std::unique_ptr<Model>(const CutBody&)>;
  using IntegratorMaker = std::function<std::unique_ptr<dynamics::Stepper>(Model&, const PiecesOfParticles&)>;

  using Widened =
    std::conditional_t<std::is_base_of_v<dynamics::ElasticModel, Model>, WidenedElasticModel, WidenedForceModel>;

  OnCorners(const CutBody& body, ModelMaker make_model, IntegratorMaker make_integrator)
    : make_model_(std::move(make_model)),
      make_integrator_(std::move(make_integrator)),
      rest_(grid::rest_positions(body.solid)),
      model_(make_model_(body)),
      crumbs_(body.density) {
    dynamics::State at_rest{rest_, Points(rest_.size(), Vec3::Zero())};
    follow_crumbs(body, at_rest);
    widen(body);
    make_stepper(body);
  }

  /// Of all corners.
  dynamics::ForceModel& model() override {
    return widened_ ? static_cast<dynamics::ForceModel&>(*widened_) : static_cast<dynamics::ForceModel&>(*model_);
  }
  /// Of those that it counts.
  const Model& own_model() const { return *model_; }
  const Points& rest() const override { return rest_; }
  bool particles_are_corners() const override { return true; }
  const Crumbs& crumbs() const override { return crumbs_; }
  dynamics::MotionKind motion() const override { return stepper_->motion(); }

  dynamics::StepReport step(dynamics::State& state, const dynamics::Loads& loads, const double dt) override {
    dynamics::StepReport report;
    if (carry_all(crumbs_)) {
      state.time += dt;
    } else {
      if (riders_.n_riders() > 0) {
        const double had = dynamics::kinetic_energy(model(), state.v);
        damp_riders(*model_, riders_, model().lumped_mass(), loads, dt, state);
        state.numbers[dynamics::dissipated_energy] += had - dynamics::kinetic_energy(model(), state.v);
      }
      report =
        widened_ ? narrowed_step(*stepper_, model_->numbers(), state, loads, dt) : stepper_->step(state, loads, dt);
    }
    crumbs_.step(loads, dt, stepper_->motion(), state);
    follow_heirs(state);
    return report;
  }

  void follow_cut(const CutBody& body, const grid::CutChange& change, dynamics::State& state) override {
    const std::vector<double> mass(model().lumped_mass().begin(), model().lumped_mass().end()); // before the cut
    const Vec3 had = momentum(mass, crumbs_, state);
    const std::vector<std::uint8_t> carried = crumbs_.carried();
    for (Points* of_corners : {&rest_, &state.x, &state.v})
      grid::inherit(change, *of_corners);
    join_lapsed(
      change.lapsed,
      [&](const std::uint32_t corner) { // in the model, or in a crumb that may be material again
        return corner < change.n_corners_before
                 ? mass[corner] + (crumbs_.carries(corner) ? crumbs_.carried_mass()[corner] : 0)
                 : 0;
      },
      state);
    for (auto& [name, values] : state.history)
      if (values.size() == change.n_corners_before)
        grid::inherit(change, values);
    dynamics::forget_forces(state);
    follow_cut_with_model(body, change);
    widen(body);
    follow_crumbs(body, state);
    const std::vector<std::uint32_t> touched = touched_material(body, change, carried),
                                     freed = freed_corners(change, carried);
    carry_momentum(body.solid.complex, touched, mass_before(change, mass), model().lumped_mass(), state.v);
    restore_momentum(had, freed.empty() ? touched : freed, model().lumped_mass(), crumbs_, state);
    make_stepper(body);
    follow_heirs(state);
  }

  void let_out(const CutBody& body, const grid::CutChange& change, const EnergyBefore& had,
               const dynamics::Loads& loads, dynamics::State& state) override {
    if (stepper_->motion() != dynamics::MotionKind::dynamic)
      return;
    crumbs_.let_out(loads, had.of_loads, state);
    if (carry_all(crumbs_))
      return;
    const grid::CornerNumbers& numbers = model_->numbers();
    dynamics::Excess excess{.most = dynamics::most_after_cut(model(), had.elastic, state.v),
                            .touched = {},
                            .piece = [&] { return own_pieces(body); }};
    numbers.gather(touched_corners(body.solid.complex, change), excess.touched);
    const auto relief = relief_of(*model_, std::move(excess));
    if (widened_)
      narrowed_step(*relief, numbers, state, loads, 0);
    else
      relief->step(state, loads, 0);
    follow_heirs(state);
  }

  /// Models are the same bits, however the body came to be what it is.
  void archive(Archive& a, const CutBody& body) override {
    a(crumbs_);
    if (a.reads()) {
      rest_ = grid::rest_positions(body.solid);
      model_ = make_model_(body);
      widen(body);
      make_stepper(body);
    }
    a(*stepper_);
  }

  const Points& corners(const dynamics::State& state) const override { return state.x; }
  Interpolation carry(const Interpolation& of_corners) const override { return of_corners; }
  Interpolation bear(const CutBody& body, const Interpolation& of_corners) const override {
    if (!bearers_)
      bearers_ = bearers_of(*model_, body, widened_ ? widened_->lumped_mass() : model_->lumped_mass());
    return bearers_->carry(of_corners);
  }

  const dynamics::Stepper& stepper() const { return *stepper_; }

 private:
  /// Corners of copies that a cut has reshaped, of which no crumb carries or has carried anything. Ascending.
  std::vector<std::uint32_t> touched_material(const CutBody& body, const grid::CutChange& change,
                                              std::vector<std::uint8_t> carried) const {
    carried.resize(change.n_corners_before, 0);
    grid::inherit(change, carried);
    const std::vector<std::uint8_t> is_touched = touched_corners(body.solid.complex, change);
    std::vector<std::uint32_t> touched;
    for (std::uint32_t i = 0; i < is_touched.size(); ++i)
      if (is_touched[i] != 0 && carried[i] == 0 && !crumbs_.carries(i))
        touched.push_back(i);
    return touched;
  }
  /// Of all corners: new ones had nothing, and heirs what lapsed.
  static std::vector<double> mass_before(const grid::CutChange& change, std::vector<double> mass) {
    mass.resize(change.n_corners_before + change.parents.size(), 0);
    for (const auto& [corner, heir] : change.lapsed)
      mass[heir.value] += std::exchange(mass[corner.value], 0);
    return mass;
  }
  /// That crumbs carried before a cut, and none does now; or their heirs. Ascending.
  std::vector<std::uint32_t> freed_corners(const grid::CutChange& change, std::vector<std::uint8_t> carried) const {
    carried.resize(rest_.size(), 0);
    for (const auto& [corner, heir] : change.lapsed)
      carried[heir.value] |= carried[corner.value];
    std::vector<std::uint32_t> freed;
    for (std::uint32_t i = 0; i < carried.size(); ++i)
      if (carried[i] != 0 && !crumbs_.carries(i))
        freed.push_back(i);
    return freed;
  }
  void follow_heirs(dynamics::State& state) const {
    for (const auto& [corner, heir] : lapsed_) {
      state.x[corner.value] = state.x[heir.value];
      state.v[corner.value] = state.v[heir.value];
    }
  }
  void follow_cut_with_model(const CutBody& body, const grid::CutChange&) { model_ = make_model_(body); }
  void follow_crumbs(const CutBody& body, dynamics::State& state) {
    crumbs_.follow(
      body.solid, nullptr,
      [&] {
        return Motion{state.x, state.v};
      },
      state);
  }
  void widen(const CutBody& body) {
    const grid::CornerNumbers& numbers = model_->numbers();
    widened_ = nullptr;
    if (!numbers.are_all())
      widened_ = std::make_unique<Widened>(*model_, numbers, body.solid.complex.n_corners());
  }
  /// The piece of each corner that the model counts.
  std::vector<std::uint32_t> own_pieces(const CutBody& body) const {
    const grid::CellComplex& complex = body.solid.complex;
    return counted_pieces(body.pieces ? grid::corner_pieces(complex, *body.pieces) : grid::corner_pieces(complex),
                          model_->numbers());
  }
  /// All that is made again from what the body is now.
  void make_stepper(const CutBody& body) {
    lapsed_ = body.solid.complex.lapsed;
    // The complex outlives the call, as the stepper asks at once.
    stepper_ = make_integrator_(*model_, [&] { return own_pieces(body); });
    riders_ = riders_of(*model_, body);
    bearers_ = std::nullopt;
  }

  ModelMaker make_model_;
  IntegratorMaker make_integrator_;
  Points rest_;
  std::unique_ptr<Model> model_;
  std::unique_ptr<Widened> widened_; // null where the model counts all corners
  Crumbs crumbs_;
  std::unique_ptr<dynamics::Stepper> stepper_;
  lattice::Riders riders_;
  mutable std::optional<Bearers> bearers_; // none until a load asks
  std::vector<grid::Lapse> lapsed_;
};

/// Elements are brought up to date where the cut is, and stay elsewhere.
template <>
inline void OnCorners<fem::Hexahedra>::follow_cut_with_model(const CutBody& body, const grid::CutChange& change) {
  model_->update(body.solid, change.reshaped);
}

using Elements = OnCorners<fem::Hexahedra>;
using Springs = OnCorners<spring::MassSpring>;
using ShapeMatching = OnCorners<lattice::Matching>;

} // namespace kerf::physics
