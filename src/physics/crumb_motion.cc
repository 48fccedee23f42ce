// How crumbs move in a step.

#include "base/loan.h"
#include "dynamics/flight.h"
#include "dynamics/forces.h"
#include "dynamics/sound_steps.h"
#include "physics/crumbs.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace kerf::physics {

using dynamics::RigidBody;
using dynamics::RigidMotion;

namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix36 = Eigen::Matrix<double, 3, 6>;

/// Displacement of a point at r from the centre, by rotation.
Mat3 turns_at(const Vec3& r) {
  Mat3 G;
  G << 0, r[2], -r[1], -r[2], 0, r[0], r[1], -r[0], 0;
  return G;
}

/// The same by translation and rotation.
Matrix36 modes_at(const Vec3& r) {
  Matrix36 G;
  G << Mat3::Identity(), turns_at(r);
  return G;
}

Mat3 inertia_now(const RigidBody& body, const RigidMotion& motion) {
  return motion.R * body.inertia * motion.R.transpose();
}

/// The metric of kinetic energy.
Matrix6 inertia_of_modes(const RigidBody& body, const RigidMotion& motion) {
  Matrix6 W = Matrix6::Zero();
  W.topLeftCorner<3, 3>() = body.mass * Mat3::Identity();
  W.bottomRightCorner<3, 3>() = inertia_now(body, motion);
  return W;
}

/// The least d, as measured by W, of those with the least (S d - b).
Vector6 least_solution(const Matrix6& S, const Vector6& b, const Matrix6& W) {
  constexpr double round_off = 1e-9, well_conditioned = 1e-3;
  const Eigen::LLT<Matrix6> factor(W);
  const Matrix6 inverse = factor.matrixL().solve(Matrix6::Identity()), A = inverse * S * inverse.transpose();
  const Vector6 c = inverse * b;
  if (const Eigen::LDLT<Matrix6> all(A); all.vectorD().minCoeff() > well_conditioned * all.vectorD().maxCoeff())
    return inverse.transpose() * all.solve(c); // there is one alone
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(A);
  const Vector6 along = eigen.eigenvectors().transpose() * c;
  Vector6 d = Vector6::Zero();
  for (int k = 0; k < 6; ++k)
    if (eigen.eigenvalues()[k] > round_off * eigen.eigenvalues()[5])
      d += along[k] / eigen.eigenvalues()[k] * eigen.eigenvectors().col(k);
  return inverse.transpose() * d;
}

/// `flown` moved by a translation and a rotation within dt.
RigidMotion moved(const RigidMotion& flown, const Matrix6& inertia, const Vector6& d, const double dt) {
  return {flown.x + d.head<3>(), flown.v + d.head<3>() / dt, dynamics::turned(flown.R, d.tail<3>()),
          flown.spin + inertia.bottomRightCorner<3, 3>() * d.tail<3>() / dt};
}

} // namespace

struct Crumbs::Push {
  Vector6 force = Vector6::Zero(); // and torque
  Matrix6 stiffness = Matrix6::Zero();
};

void Crumbs::step(const dynamics::Loads& loads, const double dt, const dynamics::MotionKind kind,
                  dynamics::State& state) {
  reactions_.assign(loads.supports.size(), {});
  work_of_supports_ = 0;
  if (!any())
    return;
  const Motions start = state.crumbs;
  std::vector<Wrench> pushes(crumbs_.size());
  if (kind == dynamics::MotionKind::dynamic)
    fly(loads, dt, pushes, state);
  hold(loads, dt, start, pushes, state);
  if (kind == dynamics::MotionKind::quasi_static)
    for (RigidMotion& motion : state.crumbs)
      motion.v = motion.spin = Vec3::Zero();
  carry(state.crumbs, state);
}

void Crumbs::fly(const dynamics::Loads& loads, const double dt, std::vector<Wrench>& pushes,
                 dynamics::State& state) const {
  constexpr int most = 64;
  const auto body_of = [&](const std::size_t b) -> const RigidBody& { return crumbs_[b].body; };
  const Motions begin = state.crumbs;
  for (int n = 1; n <= most; n *= 2) {
    Motions motions = begin;
    bool is_sound = true;
    for (int k = 0; k < n && is_sound; ++k) {
      const Motions start = motions;
      dynamics::fly(body_of, loads.gravity, loads.mass_damping, dt / n, motions);
      if (!loads.acting.empty()) {
        motions = pushed(loads, dt / n, start, Motions(motions), pushes, state);
        is_sound = gains_nothing(loads, dt / n, start, motions, state);
      }
    }
    if (is_sound) {
      state.crumbs = std::move(motions);
      return;
    }
  }
  throw dynamics::StepError(
    "crumbs, pieces that move as rigid bodies, gain energy that no load gave, and 64 substeps do "
    "not mend it",
    crumbs_[0].particles.empty() ? 0 : crumbs_[0].particles[0]);
}

bool Crumbs::gains_nothing(const dynamics::Loads& loads, const double dt, const Motions& start, const Motions& end,
                           dynamics::State& state) const {
  constexpr double most = 0.01; // of what moves
  if (std::any_of(loads.acting.begin(), loads.acting.end(),
                  [](const auto& load) { return load->nature() == dynamics::Nature::driving; }))
    return true;
  double kinetic = 0, gained = 0, kick = 0; // of gravity in the step, which first order shifts in time
  for (std::size_t b = 0; b < crumbs_.size(); ++b) {
    const double before = dynamics::kinetic_energy(crumbs_[b].body, start[b]),
                 after = dynamics::kinetic_energy(crumbs_[b].body, end[b]);
    kinetic += before + after;
    kick += crumbs_[b].body.mass * loads.gravity.squaredNorm() * dt * dt;
    gained += after - before - crumbs_[b].body.mass * loads.gravity.dot(end[b].x - start[b].x);
  }
  carry(start, state);
  gained -= dynamics::load_energy(loads, state.time, state.x);
  carry(end, state);
  gained += dynamics::load_energy(loads, state.time, state.x);
  return gained <= most * kinetic + kick;
}

std::vector<Crumbs::Push> Crumbs::pushes(const dynamics::Loads& loads, const double dt, const Motions& motions,
                                         const dynamics::State& state) const {
  const dynamics::Moment moment{state.time, state.x, state.v};
  std::vector<Push> all(crumbs_.size());
  const auto for_each_particle = [&](const auto& f) {
    for (std::size_t b = 0; b < crumbs_.size(); ++b)
      for (const auto particle : crumbs_[b].particles)
        f(b, particle, modes_at(state.x[particle] - motions[b].x));
  };
  Points forces(state.x.size(), Vec3::Zero());
  dynamics::add_load_forces(loads, moment, forces);
  for_each_particle([&](const std::size_t b, const std::uint32_t particle, const Matrix36& G) {
    all[b].force += G.transpose() * forces[particle];
  });
  const auto tangent = dynamics::load_tangent(loads, dynamics::Tangent::positive, moment, 1 / dt);
  for (int k = 0; k < 6 && !tangent.empty(); ++k) {
    Points mode(state.x.size(), Vec3::Zero()), force(state.x.size(), Vec3::Zero());
    for_each_particle([&](std::size_t, const std::uint32_t particle, const Matrix36& G) { mode[particle] = G.col(k); });
    tangent.add_product(dynamics::flat(mode), dynamics::flat(force));
    for_each_particle([&](const std::size_t b, const std::uint32_t particle, const Matrix36& G) {
      all[b].stiffness.col(k) += G.transpose() * force[particle];
    });
  }
  return all;
}

namespace {

/// Newton's method for one crumb, asked for one trial after the other: halves a correction until what is out of balance
/// falls.
class Settling {
 public:
  Settling() = default;
  Settling(const Matrix6& inertia, const double dt, const double size)
    : W_(inertia / (dt * dt)), settled_(1e-8 * size), size_(size) {}

  /// Takes force and stiffness where way() leads; returns whether it may end there.
  bool improve(const Vector6& force, const Matrix6& stiffness) {
    const Vector6 residual = force - W_ * way_;
    const double left = norm(residual);
    if (left == 0)
      return true;
    if (is_begun_ && !(left < left_)) {
      length_ *= 0.5;
      way_ = from_ + length_ * correction_;
      return length_ * size_of(correction_) <= settled_;
    }
    is_begun_ = true;
    left_ = left;
    length_ = 1;
    from_ = way_;
    correction_ = (W_ + 0.5 * (stiffness + stiffness.transpose())).ldlt().solve(residual);
    if (size_of(correction_) <= settled_)
      return true;
    way_ += correction_;
    return false;
  }

  const Vector6& way() const { return way_; }
  Vector6 force() const { return W_ * way_; }

 private:
  double size_of(const Vector6& d) const { return d.head<3>().norm() + size_ * d.tail<3>().norm(); }
  /// Of a force, and of a torque over the crumb's size.
  double norm(const Vector6& f) const { return std::hypot(f.head<3>().norm(), f.tail<3>().norm() / size_); }

  Matrix6 W_ = Matrix6::Identity();
  double settled_ = 0, size_ = 0, left_ = 0, length_ = 1;
  bool is_begun_ = false;
  Vector6 way_ = Vector6::Zero(), from_ = Vector6::Zero(), correction_ = Vector6::Zero();
};

} // namespace

Crumbs::Motions Crumbs::pushed(const dynamics::Loads& loads, const double dt, const Motions& start, Motions flown,
                               std::vector<Wrench>& wrenches, dynamics::State& state) const {
  constexpr int most = 20;
  const double drag = 1 + dt * loads.mass_damping;
  Motions motions = flown;
  std::vector<Settling> settling(crumbs_.size());
  std::vector<Matrix6> inertia(crumbs_.size());
  std::vector<std::uint8_t> is_pushed(crumbs_.size(), 0);
  for (int i = 0; i < most; ++i) {
    carry(motions, state);
    const std::vector<Push> all = pushes(loads, dt, motions, state);
    bool is_settled = true;
    for (std::size_t b = 0; b < crumbs_.size(); ++b) {
      if (!is_pushed[b]) { // gravity and damping are to act as loads do, or they would have no balance at rest
        if (all[b].force.isZero(0))
          continue;
        is_pushed[b] = 1;
        const RigidBody& body = crumbs_[b].body;
        flown[b].v = (start[b].v + dt * loads.gravity) / drag;
        flown[b].x = start[b].x + dt * flown[b].v;
        flown[b].spin = start[b].spin / drag;
        inertia[b] = inertia_of_modes(body, flown[b]);
        settling[b] = Settling(drag * inertia[b], dt, std::sqrt(body.inertia.trace() / body.mass));
        is_settled = false;
      } else {
        is_settled &= settling[b].improve(all[b].force, all[b].stiffness);
        wrenches[b] = {settling[b].force().head<3>(), settling[b].force().tail<3>()};
      }
      motions[b] = moved(flown[b], inertia[b], settling[b].way(), dt);
    }
    if (is_settled)
      break;
  }
  return motions;
}

void Crumbs::let_out(const dynamics::Loads& loads, const double had, dynamics::State& state) const {
  constexpr int most = 12;
  const dynamics::Loads potentials = dynamics::potentials_of(loads);
  if (!any() || potentials.acting.empty())
    return;
  const auto energy = [&] { return dynamics::load_energy(potentials, state.time, state.x); };
  double excess = energy() - had, slope = 0;
  if (!(excess > 0))
    return;
  const Motions found = state.crumbs;
  Motions places = found; // at rest there
  for (RigidMotion& place : places)
    place.v = place.spin = Vec3::Zero();
  const std::vector<Push> first = pushes(potentials, 1, places, state);
  for (std::size_t b = 0; b < crumbs_.size(); ++b)
    slope += first[b].force.dot(inertia_of_modes(crumbs_[b].body, places[b]).ldlt().solve(first[b].force));
  std::vector<Wrench> wrenches(crumbs_.size());
  double tau = slope > 0 ? std::sqrt(excess / slope) : 0;
  for (int k = 0; k < most && tau > 0 && excess > 0; ++k, tau *= 4) {
    Motions next = pushed(potentials, tau, places, Motions(places), wrenches, state);
    for (RigidMotion& place : next)
      place.v = place.spin = Vec3::Zero();
    carry(next, state);
    const double left = energy() - had;
    if (!(left < excess))
      break;
    excess = left;
    places = std::move(next);
  }
  for (std::size_t b = 0; b < crumbs_.size(); ++b) {
    state.crumbs[b].x = places[b].x;
    state.crumbs[b].R = places[b].R;
  }
  carry(state.crumbs, state);
}

std::vector<std::vector<Crumbs::Hold>> Crumbs::holds(const dynamics::Loads& loads) const {
  std::vector<std::vector<Hold>> all(crumbs_.size());
  for (std::size_t s = 0; s < loads.supports.size(); ++s)
    for (std::size_t i = 0; i < loads.supports[s].corners.size(); ++i)
      if (const auto particle = loads.supports[s].corners[i]; crumb_of_[particle] != CrumbParticles::none) {
        const Crumb& crumb = crumbs_[crumb_of_[particle]];
        const auto place = std::find(crumb.particles.begin(), crumb.particles.end(), particle);
        const auto index = static_cast<std::size_t>(place - crumb.particles.begin());
        all[crumb_of_[particle]].push_back({s, i, crumb.rest_of_particles[index]});
      }
  return all;
}

void Crumbs::obey(const dynamics::Loads& loads, const std::span<const Hold> holds, const std::span<const Way> ways,
                  const double dt, const RigidBody& body, RigidMotion& motion) const {
  constexpr int n_places = 4;       // rotations are not linear
  constexpr double nothing = 1e-15; // of a turn, or of the way from the origin
  Loan<Vec3> places, velocities;    // that supports want, the latter in the mean of the step
  for (const Hold& hold : holds) {
    const Vec3& rest = loads.supports[hold.support].rest[hold.index];
    places->push_back(ways[hold.support].to(rest));
    velocities->push_back((ways[hold.support].to(rest) - ways[hold.support].from(rest)) / dt);
  }
  const auto least_change = [&](const auto& missing) {
    Matrix6 S = Matrix6::Zero();
    Vector6 rhs = Vector6::Zero();
    for (std::size_t i = 0; i < holds.size(); ++i) {
      const Vec3 x = dynamics::place(body, motion, holds[i].rest);
      const Mat3 G = turns_at(x - motion.x);
      const Mat3& H = loads.supports[holds[i].support].held;
      const Mat3 HG = H * G;
      S.topLeftCorner<3, 3>() += H;
      S.topRightCorner<3, 3>() += HG;
      S.bottomRightCorner<3, 3>() += G.transpose() * HG;
      const Vec3 wanted = H * missing(i, x);
      rhs.head<3>() += wanted;
      rhs.tail<3>() += G.transpose() * wanted;
    }
    S.bottomLeftCorner<3, 3>() = S.topRightCorner<3, 3>().transpose();
    return least_solution(S, rhs, inertia_of_modes(body, motion));
  };
  for (int i = 0; i < n_places; ++i) {
    const Vector6 d = least_change([&](const std::size_t i, const Vec3& x) { return Vec3(places[i] - x); });
    motion.x += d.head<3>();
    motion.R = dynamics::turned(motion.R, d.tail<3>());
    if (d.head<3>().norm() <= nothing * motion.x.norm() && d.tail<3>().norm() <= nothing)
      break;
  }
  const Vec3 omega = dynamics::angular_velocity(body, motion);
  const Vector6 d = least_change(
    [&](const std::size_t i, const Vec3& x) { return Vec3(velocities[i] - dynamics::velocity(motion, omega, x)); });
  motion.v += d.head<3>();
  motion.spin += inertia_now(body, motion) * d.tail<3>();
}

void Crumbs::hold(const dynamics::Loads& loads, const double dt, const Motions& start,
                  const std::vector<Wrench>& pushes, dynamics::State& state) {
  const auto all = holds(loads);
  std::vector<Way> ways;
  for (const dynamics::Support& support : loads.supports)
    ways.push_back({support.places(state.time - dt), support.places(state.time)});
  for (std::size_t b = 0; b < crumbs_.size(); ++b) {
    if (all[b].empty())
      continue;
    const RigidBody& body = crumbs_[b].body;
    RigidMotion& motion = state.crumbs[b];
    const RigidMotion before = motion;
    obey(loads, all[b], ways, dt, body, motion);
    dynamics::Reaction& reaction = reactions_[all[b][0].support];
    const double alpha = loads.mass_damping;
    const Vec3 force = body.mass * ((motion.v - start[b].v) / dt + alpha * motion.v - loads.gravity) - pushes[b].force;
    reaction.force += force;
    reaction.torque +=
      (motion.spin - start[b].spin) / dt + alpha * motion.spin - pushes[b].torque + motion.x.cross(force);
    // What its energy and what is booked as damped (scene/accounts.cc) leave to explain, less what has pushed it.
    const auto energy = [&](const RigidMotion& at) {
      return dynamics::kinetic_energy(body, at) - body.mass * loads.gravity.dot(at.x - start[b].x);
    };
    const auto damped = [&](const RigidMotion& end) {
      return alpha * dt * (dynamics::kinetic_energy(body, start[b]) + dynamics::kinetic_energy(body, end));
    };
    const bool is_pushed = !pushes[b].force.isZero(0) || !pushes[b].torque.isZero(0);
    const double by_pushes = is_pushed ? energy(before) - energy(start[b]) + damped(before) : 0;
    work_of_supports_ += energy(motion) - energy(start[b]) + damped(motion) - by_pushes;
  }
}

} // namespace kerf::physics
