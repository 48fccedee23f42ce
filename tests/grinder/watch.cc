#include "tests/grinder/watch.h"

#include "base/parameters.h"
#include "geometry/triangle_mesh.h"
#include "material/elastic.h"
#include "scene/observables.h"
#include "scene/soundness.h"
#include "tests/support/whole_crumbs.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kerf::grinder {

namespace {

/// A piece needs that many particles for a percentile to say anything.
constexpr std::size_t least_for_percentile = 100;
constexpr double most_over_ordinary = 10;   // speed over the 99th percentile [1]
constexpr double most_volume_change = 0.3;  // [1]
constexpr double most_reach = 3;            // over that at rest [1]
constexpr double most_energy_gained = 0.01; // of what has been turned over [1]
constexpr double most_energy_swing = 0.25;  // the same, of shape matching [1]
constexpr double most_energy_kept = 0.1;    // the same, of implicit integrators that take none or little [1]
constexpr double most_cut_energy = 0.1;     // the same [1]

/// Diagonal of its bounding box [m].
double extent(const scene::Body& body) {
  const Box box = geometry::bounding_box({body.surface.rest, {}});
  return (box.upper - box.lower).norm();
}

/// sqrt(E / density) [m/s]
double wave_speed(const Scene& scene) {
  const material::Elastic usual;
  return std::sqrt(number_of(scene, "Young's modulus [Pa]").value_or(usual.youngs_modulus) /
                   number_of(scene, "Density [kg/m^3]").value_or(usual.density));
}

bool says(const Scene& scene, const char* const words) { return text(scene).find(words) != std::string::npos; }

/// Shape matching is symplectic Euler.
bool is_symplectic(const Scene& scene) {
  return says(scene, "Backend = lattice") || says(scene, "Integrator = symplectic Euler") ||
         says(scene, "Integrator = velocity Verlet");
}

/// Where nothing damps them light corners have their part of the body's vibrations: what they ride on keeps them within
/// a cube (lattice/riders.h), and their speeds mean nothing.
double least_mass(const Scene& scene) {
  return is_symplectic(scene) && !says(scene, "Backend = lattice") ? 1.0 / 128 : 0;
}

bool keeps_energy(const Scene& scene) {
  return is_symplectic(scene) || says(scene, "Integrator = Newmark") || says(scene, "Integrator = generalised alpha");
}

double most_gained(const Scene& scene) {
  return is_symplectic(scene)  ? most_energy_swing
         : keeps_energy(scene) ? most_energy_kept
                               : most_energy_gained;
}

std::string percent(const double part) { return to_text(std::round(1000 * part) / 10) + " %"; }

} // namespace

Watch::Watch(const Scene& scene, const scene::Body& body)
  : most_energy_gained_(most_gained(scene)),
    keeps_energy_(keeps_energy(scene)),
    least_mass_(least_mass(scene)),
    gravity_(body.loads.gravity.norm()),
    wave_speed_(wave_speed(scene)),
    recoil_(gravity_ * extent(body) / wave_speed_),
    mass_(scene::find_observable("mass")->value(body)),
    start_gravity_(scene::find_observable("gravity energy")->value(body)),
    n_pieces_(grid::n_pieces(body.solid.complex)),
    n_recuts_(body.n_recuts) {}

/// What falls has g t. What has sagged and is let go recoils: by no more than g t again, as no more momentum has come
/// in, or where stress waves of its own weight meet by g L / c each; or by c times the strain that was let go, twice
/// that at a free end (one-dimensional waves). Blades give no momentum to what they cut.
std::optional<Failure> Watch::watch_speeds(const scene::Body& body, const Look& look, const int step,
                                           const double time) {
  const double usual = gravity_ * time + recoil_, limit = 2 * usual;
  std::optional<Failure> failure;
  for (const PieceLook& piece : look.pieces) {
    const auto tell = [&](const std::string& reason, const double most) {
      if (!failure)
        failure = {reason, step,
                   to_text(piece.fastest) + " m/s where " + to_text(most) + " are allowed, 99th percentile of " +
                     std::to_string(piece.n_particles) + " in its piece " + to_text(piece.ordinary) + " m/s; " +
                     about_particle(body, piece.who)};
    };
    figures_.fastest = std::max(figures_.fastest, piece.fastest);
    figures_.runaway = std::max(figures_.runaway, piece.fastest / limit);
    if (piece.fastest > limit)
      tell("runaway", limit);
    if (piece.n_particles < least_for_percentile || piece.fastest < usual)
      continue;
    const double outlier = piece.fastest / (most_over_ordinary * piece.ordinary);
    figures_.outlier = std::max(figures_.outlier, outlier);
    if (outlier > 1)
      tell("outlier", usual);
  }
  recoil_ = std::max(recoil_, wave_speed_ * (look.stretch - 1)); // from the next step on
  return failure;
}

/// What hangs by a thread is drawn out as far as it falls, and what falls is not.
std::optional<Failure> Watch::watch_shapes(const scene::Body& body, const Look& look, const int step,
                                           const double time) {
  const double h = body.solid.grid.h(), least_volume = 1e-9 * h * h * h;
  figures_.stretch = std::max(figures_.stretch, scene::largest_stretch(body).factor);
  std::optional<Failure> failure;
  for (const PieceLook& piece : look.pieces) {
    if (piece.rest_volume < least_volume)
      continue;
    const double change = piece.volume / piece.rest_volume - 1, drawn = piece.is_held ? 0.5 * gravity_ * time * time : 0,
                 reach = std::max(0.0, piece.reach - drawn) / piece.rest_reach;
    figures_.volume = std::max(figures_.volume, std::abs(change) / most_volume_change);
    figures_.reach = std::max(figures_.reach, reach / most_reach);
    const std::string size = " of a piece of " + to_text(piece.rest_volume / (h * h * h)) + " cubes at rest, " +
                             std::to_string(piece.n_particles) + " particles";
    if (!failure && std::abs(change) > most_volume_change)
      failure = {"volume", step, percent(change) + size};
    if (!failure && reach > most_reach)
      failure = {"drawn out", step, "reach " + to_text(reach) + " times that" + size};
  }
  return failure;
}

/// A step of an implicit integrator may lose energy and never gains any that no load gave; what steps gain is summed,
/// so that losses elsewhere hide nothing. Newmark and generalised alpha give and take it. Symplectic Euler lets the
/// energy swing by frequency times half a step (cases.cc takes 0.45 of the longest step), and keeps it in the mean.
std::optional<Failure> Watch::watch_energy(const Look& look, const int step, const double dt) {
  const double gained = std::max(missing_ - look.missing, 0.0), by_cut = std::max(look.work_of_cut - work_of_cut_, 0.0);
  missing_ = look.missing;
  work_of_cut_ = look.work_of_cut;
  gained_ = keeps_energy_ ? std::max(gained_, -look.missing) : gained_ + gained;
  gained_by_cuts_ += by_cut;
  const double least = mass_ * gravity_ * gravity_ * dt * dt; // what the first step of a fall turns over
  turnover_ = std::max({turnover_, least, look.kinetic + look.elastic, std::abs(look.gravity - start_gravity_)});
  const double most = most_energy_gained_;
  figures_.energy = std::max(figures_.energy, gained_ / turnover_ / most);
  figures_.cut_energy = std::max(figures_.cut_energy, gained_by_cuts_ / turnover_ / most_cut_energy);
  const std::string of = " of the " + to_text(turnover_) + " J that were turned over";
  if (gained_ > most * turnover_)
    return Failure{"energy", step, "steps gained " + percent(gained_ / turnover_) + of};
  if (gained_by_cuts_ > most_cut_energy * turnover_)
    return Failure{"cut energy", step, "cuts gave " + percent(gained_by_cuts_ / turnover_) + of};
  return {};
}

/// Only a cut makes pieces; it also joins splinters to what lies on the same side of all cuts.
std::optional<Failure> Watch::watch_pieces(const scene::Body& body, const Look& look, const int step) {
  const std::size_t n_before = std::exchange(n_pieces_, look.pieces.size());
  const bool was_cut = std::exchange(n_recuts_, body.n_recuts) != body.n_recuts;
  if (n_pieces_ != n_before && !was_cut)
    return Failure{"pieces", step, std::to_string(n_before) + " have become " + std::to_string(n_pieces_)};
  if (was_cut && !support::are_crumbs_whole_pieces(body.solid))
    return Failure{"crumbs", step, "a part of a piece is a crumb"};
  if (was_cut && !support::are_loose_pieces_crumbs(body.solid))
    return Failure{"crumbs", step, "a piece of loose copies is none"};
  return {};
}

std::optional<Failure> Watch::after_step(const scene::Body& body, const int step, const double dt) {
  const Look look = look_at(body, least_mass_);
  if (!look.is_finite)
    return Failure{"NaN", step, "a number that is none", true};
  for (const auto& failure : {watch_speeds(body, look, step, step * dt), watch_shapes(body, look, step, step * dt),
                              watch_energy(look, step, dt), watch_pieces(body, look, step)})
    if (failure)
      return failure;
  return {};
}

} // namespace kerf::grinder
