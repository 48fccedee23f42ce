#include "physics/crumbs.h"

#include "base/loan.h"
#include "dynamics/flight.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace kerf::physics {

using dynamics::RigidBody;
using dynamics::RigidMotion;

namespace {

/// Of the particles of a crumb.
struct Weight {
  double mass = 0;             ///< [kg]
  Vec3 moment = Vec3::Zero(); ///< mass times rest position [kg m]
};
std::vector<Weight> weights_of(const CrumbParticles& particles, const std::size_t n_crumbs) {
  std::vector<Weight> weights(n_crumbs);
  for (std::size_t i = 0; i < particles.crumb.size(); ++i)
    if (particles.crumb[i] != CrumbParticles::none) {
      auto& [mass, moment] = weights[particles.crumb[i]];
      mass += particles.mass[i];
      moment += particles.mass[i] * particles.rest[i];
    }
  return weights;
}

/// Gives a crumb the mass of its particles, or none to speak of: a backend that has its own has given them all of the
/// body's, some of it for material across the cut, and none is to be made or lost. Its centre is theirs, or becoming a
/// crumb would change momentum where it turns.
void weigh(const Weight& weight, CrumbBody& crumb) {
  constexpr double nothing = 1e-12;
  const double factor = std::max(nothing, weight.mass / crumb.body.mass);
  if (weight.mass > 0)
    crumb.body.centre = weight.moment / weight.mass;
  crumb.body.mass *= factor;
  crumb.body.inertia *= factor;
  for (double& of_corner : crumb.mass_of_corners)
    of_corner *= factor;
}

} // namespace

void Crumbs::follow(const grid::Solid& solid, const CrumbParticles* const particles,
                    const std::function<Motion()>& motion_of_corners, dynamics::State& state) {
  if (!solid.crumbs.any() && crumbs_.empty() && (particles || solid.complex.lapsed.empty()))
    return;
  std::vector<Crumb> crumbs;
  Motions motions;
  std::optional<Motion> now;
  const auto weights = particles ? weights_of(*particles, solid.crumbs.all.size()) : std::vector<Weight>();
  auto before = crumbs_.begin(); // both lists are by ascending name
  for (const grid::Crumb& crumb : solid.crumbs.all) {
    while (before != crumbs_.end() && before->name < crumb.name)
      ++before;
    if (before != crumbs_.end() && before->name == crumb.name) {
      motions.push_back(state.crumbs[static_cast<std::size_t>(before - crumbs_.begin())]);
      crumbs.push_back(std::move(*before));
      continue;
    }
    if (!now)
      now = motion_of_corners();
    crumbs.push_back({measure(solid, crumb, density_), crumb.name, {}, {}});
    if (particles)
      weigh(weights[crumbs.size() - 1], crumbs.back());
    motions.push_back(motion_of(crumbs.back(), *now));
  }
  crumbs_ = std::move(crumbs);
  state.crumbs = std::move(motions);
  take_particles(solid, particles);
  carry(state.crumbs, state);
}

void Crumbs::take_particles(const grid::Solid& solid, const CrumbParticles* const particles) {
  const std::size_t n = particles ? particles->crumb.size() : solid.complex.n_corners();
  crumb_of_.assign(n, CrumbParticles::none);
  carried_.assign(n, 0);
  carried_mass_.assign(n, 0.0);
  for (std::uint32_t b = 0; b < crumbs_.size(); ++b) {
    crumbs_[b].particles.clear();
    crumbs_[b].rest_of_particles.clear();
  }
  const auto take = [&](const std::uint32_t particle, const std::uint32_t crumb, const Vec3& rest, const double mass) {
    crumb_of_[particle] = crumb;
    carried_[particle] = 1;
    carried_mass_[particle] = mass;
    crumbs_[crumb].particles.push_back(particle);
    crumbs_[crumb].rest_of_particles.push_back(rest);
  };
  if (particles) {
    for (std::uint32_t i = 0; i < n; ++i)
      if (const auto crumb = particles->crumb[i]; crumb != CrumbParticles::none)
        take(i, crumb, particles->rest[i], particles->mass[i]);
    return;
  }
  for (const grid::Lapse& lapse : solid.complex.lapsed)
    carried_[lapse.corner.value] = 1;
  for (std::uint32_t b = 0; b < crumbs_.size(); ++b)
    for (std::size_t i = 0; i < crumbs_[b].corners.size(); ++i)
      take(crumbs_[b].corners[i], b, crumbs_[b].rest_of_corners[i], crumbs_[b].mass_of_corners[i]);
}

void Crumbs::carry(const Motions& motions, dynamics::State& state) const {
  Loan<Vec3> omegas(crumbs_.size());
  dynamics::put_angular_velocities([&](const std::size_t b) -> const RigidBody& { return crumbs_[b].body; }, motions,
                                   *omegas);
  for (std::size_t b = 0; b < crumbs_.size(); ++b)
    dynamics::carry(crumbs_[b].body, motions[b], omegas[b], crumbs_[b].rest_of_particles, crumbs_[b].particles.data(),
                    state.x, state.v);
}

void Crumbs::put(const Motion& of_corners, dynamics::State& state) const {
  for (std::size_t b = 0; b < crumbs_.size(); ++b)
    state.crumbs[b] = motion_of(crumbs_[b], of_corners);
  carry(state.crumbs, state);
}

void Crumbs::place_corners(const dynamics::State& state, Points& corners) const {
  for (std::size_t b = 0; b < crumbs_.size(); ++b)
    for (std::size_t i = 0; i < crumbs_[b].corners.size(); ++i)
      corners[crumbs_[b].corners[i]] = dynamics::place(crumbs_[b].body, state.crumbs[b], crumbs_[b].rest_of_corners[i]);
}

void Crumbs::put_velocities(const dynamics::State& state, Points& of_corners) const {
  for (std::size_t b = 0; b < crumbs_.size(); ++b) {
    const RigidMotion& motion = state.crumbs[b];
    const Vec3 omega = dynamics::angular_velocity(crumbs_[b].body, motion);
    for (std::size_t i = 0; i < crumbs_[b].corners.size(); ++i) {
      const Vec3 place = dynamics::place(crumbs_[b].body, motion, crumbs_[b].rest_of_corners[i]);
      of_corners[crumbs_[b].corners[i]] = motion.v + omega.cross(place - motion.x);
    }
  }
}

std::vector<RigidMotion> Crumbs::at_rest() const {
  Motions motions;
  for (const Crumb& one : crumbs_)
    motions.push_back({.x = one.body.centre});
  return motions;
}

double Crumbs::mass() const {
  double sum = 0;
  for (const Crumb& one : crumbs_)
    sum += one.body.mass;
  return sum;
}

double Crumbs::kinetic_energy(const dynamics::State& state) const {
  double sum = 0;
  for (std::size_t b = 0; b < crumbs_.size(); ++b)
    sum += dynamics::kinetic_energy(crumbs_[b].body, state.crumbs[b]);
  return sum;
}

double Crumbs::gravity_energy(const dynamics::Loads& loads, const dynamics::State& state) const {
  double sum = 0;
  for (std::size_t b = 0; b < crumbs_.size(); ++b)
    sum -= crumbs_[b].body.mass * loads.gravity.dot(state.crumbs[b].x);
  return sum;
}

Vec3 Crumbs::momentum(const dynamics::State& state) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t b = 0; b < crumbs_.size(); ++b)
    sum += crumbs_[b].body.mass * state.crumbs[b].v;
  return sum;
}

Vec3 Crumbs::angular_momentum(const dynamics::State& state, const Vec3& about) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t b = 0; b < crumbs_.size(); ++b) {
    const RigidMotion& motion = state.crumbs[b];
    sum += motion.spin + crumbs_[b].body.mass * (motion.x - about).cross(motion.v);
  }
  return sum;
}

Vec3 momentum(const std::span<const double> mass, const Crumbs& crumbs, const dynamics::State& state) {
  Vec3 sum = crumbs.momentum(state);
  for (std::size_t i = 0; i < mass.size(); ++i)
    sum += mass[i] * state.v[i];
  return sum;
}

void restore_momentum(const Vec3& had, const std::span<const std::uint32_t> particles,
                      const std::span<const double> mass, const Crumbs& crumbs, dynamics::State& state) {
  constexpr double round_off = 1e-13, little = 0.01;
  const Vec3 missing = had - momentum(mass, crumbs, state);
  double all = 0, moved = 0, of_particles = 0, moved_of_particles = 0;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    all += mass[i];
    moved += mass[i] * state.v[i].norm();
  }
  if (!(all > 0) || missing.norm() <= round_off * moved)
    return;
  for (const auto i : particles) {
    of_particles += mass[i];
    moved_of_particles += mass[i] * state.v[i].norm();
  }
  if (missing.norm() <= little * moved_of_particles)
    for (const auto i : particles)
      state.v[i] += missing / of_particles;
  else
    for (std::size_t i = 0; i < mass.size(); ++i)
      if (mass[i] > 0)
        state.v[i] += missing / all;
}

} // namespace kerf::physics
