#include "dynamics/sound_steps.h"

#include "base/error.h"
#include "base/fingerprint.h"
#include "dynamics/conjugate_gradients.h"
#include "dynamics/constraints.h"
#include "dynamics/followers.h"
#include "dynamics/forces.h"
#include "dynamics/piece_gains.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

namespace kerf::dynamics {

namespace {

void add_try(StepReport& sum, const StepReport& part) {
  sum.n_iterations += part.n_iterations;
  sum.n_newton += part.n_newton;
  sum.n_substeps += part.n_substeps;
  sum.n_rejected += part.n_rejected;
  sum.stable_step = part.stable_step;
  sum.residual = std::max(sum.residual, part.residual);
  sum.begins_anew |= part.begins_anew;
}

/// The first particle that is not at a finite place, or has no finite velocity.
struct FirstLost {
  std::size_t particle = std::numeric_limits<std::size_t>::max();

  FirstLost& operator+=(const FirstLost& next) {
    particle = std::min(particle, next.particle);
    return *this;
  }
};

bool drives(const Loads& loads) {
  return std::any_of(loads.acting.begin(), loads.acting.end(),
                     [](const auto& load) { return load->nature() == Nature::driving; });
}

/// Work that driving loads would do along the step with their forces at a state.
double work_of_driving_loads(const Loads& loads, const State& at, const State& before, const State& after) {
  Loan<Vec3> forces(at.x.size(), Vec3::Zero());
  for (const auto& load : loads.acting)
    if (load->nature() == Nature::driving)
      load->add_force({at.time, at.x, at.v}, forces);
  double sum = 0;
  for (std::size_t i = 0; i < forces.size(); ++i)
    sum += forces[i].dot(after.x[i] - before.x[i]);
  return sum;
}

/// Work of supports along the step with what the balance of forces lacks at a state.
double work_of_supports(const ForceModel& model, const Loads& loads, const Constraints& constraints, const State& at,
                        const State& before, const State& after) {
  Loan<Vec3> forces = Loan<Vec3>::with_room(at.x.size());
  model.force(at.x, forces);
  add_load_forces(loads, {at.time, at.x, at.v}, forces);
  const auto mass = model.lumped_mass();
  const double dt = after.time - before.time;
  Loan<Vec3> change(after.v.size());
  for (std::size_t i = 0; i < change.size(); ++i)
    change[i] = after.v[i] - before.v[i];
  change = momenta(model, change);
  double sum = 0;
  for (const auto& held : constraints.held()) {
    const auto i = held.corner;
    const Vec3 moved = after.x[i] - before.x[i];
    sum -= (forces[i] + mass[i] * loads.gravity).dot(moved - constraints.freedom(i).project * moved);
    const Vec3 v = 0.5 * (after.v[i] + before.v[i]); // the kinetic energy's growth, see Accounts of a scene
    sum += change[i].dot(v - constraints.freedom(i).project * v);
    sum += dt * loads.mass_damping * mass[i] * after.v[i].squaredNorm();
  }
  return sum;
}

bool supports_move(const Constraints& constraints, const State& before, const State& after) {
  return std::any_of(constraints.held().begin(), constraints.held().end(), [&](const auto& held) {
    const auto i = held.corner;
    const Vec3 moved = after.x[i] - before.x[i];
    return moved != constraints.freedom(i).project * moved || before.v[i] != after.v[i];
  });
}

double work_on(const ForceModel& model, const Loads& loads, const State& before, const State& after) {
  double work = 0;
  if (drives(loads))
    work += std::max(
      {0.0, work_of_driving_loads(loads, before, before, after), work_of_driving_loads(loads, after, before, after)});
  const Constraints constraints(loads, after.x.size());
  if (supports_move(constraints, before, after))
    work += std::max({0.0, work_of_supports(model, loads, constraints, before, before, after),
                      work_of_supports(model, loads, constraints, after, before, after)});
  const auto by_time = [&](const Points& x) { // of potentials that change with time
    return load_energy(loads, after.time, x) - load_energy(loads, before.time, x);
  };
  return loads.acting.empty() ? work : work + std::max({0.0, by_time(before.x), by_time(after.x)});
}

/// Kinetic energy of a motion by a millionth of the body's size in a step: it is as good as at rest [J].
double unseen(const MassSums& sums, const double dt) {
  const double mass = sums.all.mass;
  return mass > 0 ? 1e-12 * std::max(0.0, sums.second_moment - sums.moment.squaredNorm() / mass) / (dt * dt) : 0;
}

/// The particle that leaves free motion most.
std::size_t most_thrown(const State& before, const State& after) {
  std::size_t most = 0;
  double largest = 0;
  for (std::size_t i = 0; i < after.x.size(); ++i)
    if (const double change = (after.v[i] - before.v[i]).squaredNorm(); change > largest) {
      largest = change;
      most = i;
    }
  return most;
}

std::size_t fastest(const State& state) {
  const auto slower = [](const Vec3& a, const Vec3& b) { return a.squaredNorm() < b.squaredNorm(); };
  return static_cast<std::size_t>(std::max_element(state.v.begin(), state.v.end(), slower) - state.v.begin());
}

/// Integrators that know no constraints inside their loops may have moved what a rigid body carries.
void keep_carried(const Loads& loads, const State& before, State& after) {
  for (std::size_t i = 0; i < loads.carried.size(); ++i)
    if (is_carried(loads, i)) {
      after.x[i] = before.x[i];
      after.v[i] = before.v[i];
    }
}

/// What a step did to the energy.
struct EnergyChange {
  double gained = 0; ///< that nobody gave [J]
  double dealt = 0;  ///< with which it dealt: what a gain is measured by [J]
  double kick = 0;   ///< what first order may misplace of gravity [J]
  double unseen = 0; ///< round-off, and motions that are none [J]
  double inner = 0;  ///< kinetic and elastic energy at the end [J]
};

/// elastic_0: at the start.
EnergyChange energy_change(const ForceModel& model, const Pieces& pieces, ElasticEnergies& energies, const Loads& loads,
                           const State& before, const double elastic_0, const State& after, const SumsOfStep& sums) {
  const auto& [sums_0, sums_1] = sums;
  const double elastic_1 = energies.at(after.x),
               kinetic_0 = sums_0.kinetic_energy + kinetic_energy_of_coupling(model, before.v),
               kinetic_1 = sums_1.kinetic_energy + kinetic_energy_of_coupling(model, after.v),
               load_0 = load_energy(loads, before.time, before.x), load_1 = load_energy(loads, after.time, after.x),
               gravity_0 = -loads.gravity.dot(sums_0.moment), gravity_1 = -loads.gravity.dot(sums_1.moment),
               inner_0 = inner_kinetic_energy(model, pieces, before.v, kinetic_0, sums_0.all),
               inner_1 = inner_kinetic_energy(model, pieces, after.v, kinetic_1, sums_1.all),
               work = work_on(model, loads, before, after), dt = after.time - before.time,
               exchanged = std::abs(kinetic_1 - kinetic_0) + std::abs(gravity_1 - gravity_0);
  constexpr double drowned = 1e-9; // see balance.cc: of energies whose difference counts
  constexpr double solved = 1e-5;  // ten times what the default leaves of forces, over those that balance
  const double sizes = kinetic_0 + kinetic_1 + std::abs(elastic_0) + std::abs(elastic_1) + std::abs(gravity_0) +
                       std::abs(gravity_1) + std::abs(load_0) + std::abs(load_1);
  return {
    .gained = elastic_1 - elastic_0 + (kinetic_1 - kinetic_0) + (load_1 - load_0) + (gravity_1 - gravity_0) - work,
    .dealt = inner_0 + inner_1 + std::abs(elastic_0) + std::abs(elastic_1) + std::abs(load_1 - load_0) + work,
    .kick = 4 * sums_1.all.mass * loads.gravity.squaredNorm() * dt * dt,
    .unseen = drowned * sizes + solved * exchanged + unseen(sums_1, dt),
    .inner = kinetic_1 + std::abs(elastic_1)};
}

/// Throws StepError when a position or a velocity is not finite.
void require_finite(const State& state, const MassSums& sums) {
  if (std::isfinite(sums.second_moment + sums.kinetic_energy))
    return;
  const FirstLost all = sum_in_blocks(
    state.x.size(), FirstLost(), [&](const std::size_t begin, const std::size_t end, FirstLost& part) {
      for (std::size_t i = begin; i < end; ++i)
        if (!state.x[i].allFinite() || !state.v[i].allFinite())
          part += {i};
    });
  if (all.particle != FirstLost().particle)
    throw StepError("a position or a velocity is no longer finite", all.particle);
}

} // namespace

double noise_of_energy(const ForceModel& model, const Points& x) {
  Loan<Vec3> grown(x);
  for (Vec3& p : *grown)
    p *= 1.001;
  return 1e-8 * std::abs(model.energy(grown) - model.energy(x));
}

double noise_of_steps(const ForceModel& model, const Points& x) { return 1e4 * noise_of_energy(model, x); }

std::string in_short(const double value) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

std::string per_cent(const double part) { return in_short(100 * part) + " %"; }

double ElasticEnergies::at(const Points& x) {
  const std::uint64_t where = fingerprint(x);
  if (known_[0].where == where)
    return known_[0].energy;
  std::swap(known_[0], known_[1]);
  if (known_[0].where != where) {
    const double energy = model_.energy_ahead(x); // which may fail: then nothing is known of x
    known_[0] = {where, energy};
  }
  return known_[0].energy;
}

SoundSteps::LentState SoundSteps::lend() {
  LentState lent(nullptr, {this});
  if (idle_.empty()) {
    lent.reset(new State);
  } else {
    lent.reset(idle_.back().release());
    idle_.pop_back();
  }
  return lent;
}

void SoundSteps::add_checked(const State& state, const Loads& loads, const double dt, Tried& tried) {
  LentState lent = lend();
  State& after = *lent;
  // Asked for while the step asks for forces here too: the model knows them at one place alone.
  const double elastic = energies_.at(state.x);
  const auto [report, found] = stepper_->step_from(state, loads, dt, after);
  keep_carried(loads, state, after);
  const SumsOfStep sums = found ? *found : SumsOfStep{mass_sums(model_, state), mass_sums(model_, after)};
  require_finite(after, sums.after);
  const EnergyChange change = energy_change(model_, pieces_, energies_, loads, state, elastic, after, sums);
  const double shift = options_.kick * change.kick + change.unseen;
  if (!(change.gained <= options_.most_gain * change.dealt + shift) && change.gained > noise_of_energy(model_, after.x))
    throw StepError("the step gained " + in_short(change.gained) + " J that no load and no support gave, " +
                      per_cent(change.gained / change.dealt) + " of the energy that it dealt with",
                    most_thrown(state, after));
  if (options_.each_piece)
    require_no_piece_gains(model_, pieces_, loads, state, after, options_.most_gain);
  double& sum = after.numbers[energy_gained];
  sum = std::max(0.0, sum + change.gained);
  if (change.gained > 0 && !(sum <= options_.most_sum * change.inner + shift) &&
      sum > noise_of_steps(model_, after.x))
    throw StepError("the integrator has gained " + per_cent(sum / change.inner) +
                      " of the body's kinetic and elastic energy, step by step: the motion is no more the body's",
                    most_thrown(state, after));
  tried.is_as_wanted = tried.is_as_wanted && change.gained <= options_.wanted_gain * change.dealt + change.unseen;
  tried.gained += std::max(0.0, change.gained);
  add_try(tried.report, report);
  tried.state = std::move(lent);
}

SoundSteps::Tried SoundSteps::divided(const State& state, const Loads& loads, const double dt, const int n) {
  Tried tried{{}, {nullptr, {this}}};
  for (int k = 1; k <= n; ++k) {
    const State& before = tried.state ? *tried.state : state;
    add_checked(before, loads, (state.time + k * dt / n) - before.time, tried);
  }
  tried.state->time = state.time + dt;
  if (n > 1) {
    tried.report.n_substeps = n;
    tried.report.begins_anew = false; // most of them do not
  }
  return tried;
}

StepReport SoundSteps::by_last_resort(State& state, const Loads& loads, const double dt) {
  State after = state;
  forget_past(after);
  StepReport report = last_resort_->step(after, loads, dt);
  forget_past(after);
  lead_along(model_, after.x, after.v);
  after.numbers[energy_gained] = 0;
  state = std::move(after);
  return report;
}

StepReport SoundSteps::step(State& state, const Loads& loads, const double dt) {
  constexpr int most_for_wanted = 4;
  std::optional<StepError> first;
  std::optional<Tried> bearable; // nothing else is wrong with it
  const auto keep = [&](const std::string& reason, const std::size_t particle) {
    if (!first)
      first.emplace(reason, particle);
  };
  int n_rejected = 0;
  for (int n = 1; n <= options_.most_substeps && !(bearable && n > most_for_wanted); n *= 2, ++n_rejected) {
    try {
      Tried tried = divided(state, loads, dt, n);
      tried.report.n_rejected += n_rejected;
      if (!bearable || tried.is_as_wanted || tried.gained < bearable->gained)
        bearable = std::move(tried);
      if (bearable->is_as_wanted)
        break;
    } catch (const StepError& error) {
      keep(error.what(), error.particle());
    } catch (const NumericalError& error) {
      keep(error.what(), fastest(state));
    }
  }
  if (bearable) {
    std::swap(state, *bearable->state);
    return bearable->report;
  }
  if (last_resort_) {
    StepReport report = by_last_resort(state, loads, dt);
    report.n_rejected += n_rejected;
    return report;
  }
  if (options_.most_substeps == 1)
    throw *first;
  throw StepError(
    std::string(first->what()) + ". " + std::to_string(options_.most_substeps) + " substeps do not mend it",
    first->particle());
}

} // namespace kerf::dynamics
