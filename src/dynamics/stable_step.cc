#include "dynamics/stable_step.h"

#include "base/error.h"
#include "base/parallel.h"
#include "dynamics/conjugate_gradients.h"
#include "dynamics/constraints.h"
#include "dynamics/forces.h"
#include "dynamics/points.h"
#include "dynamics/sound_steps.h"

#include <Eigen/Eigenvalues>

#include <cmath>
#include <limits>
#include <random>

namespace kerf::dynamics {

namespace {

/// y = S p with a symmetric S.
using Symmetric = std::function<void(const Points& p, Points& y)>;

double norm(const Points& p) { return std::sqrt(dot(flat(p), flat(p))); }

Points random_directions(const std::size_t n, const Constraints& constraints) {
  std::mt19937 random(20090417);
  Points p(n);
  for (Vec3& value : p)
    for (int k = 0; k < 3; ++k)
      value[k] = static_cast<double>(random()) / std::mt19937::max() - 0.5;
  constraints.project(p);
  return p;
}

/// Largest eigenvalue of the symmetric tridiagonal matrix.
double largest_eigenvalue(const std::vector<double>& diagonal, const std::vector<double>& beside) {
  const auto n = static_cast<Eigen::Index>(diagonal.size());
  const Eigen::Map<const Eigen::VectorXd> d(diagonal.data(), n), e(beside.data(), n - 1);
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(d, e, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[n - 1];
}

/// Lanczos without orthogonalisation again, which repeats eigenvalues and does not harm the largest.
double lanczos(const Symmetric& S, Points q) {
  constexpr int most = 300, between = 5;
  constexpr double accuracy = 2e-4; // of an eigenvalue, over `between` iterations
  std::vector<double> diagonal, beside;
  Points before(q.size(), Vec3::Zero()), y(q.size());
  double length = norm(q), eigenvalue = 0;
  if (length == 0)
    return 0;
  for (int k = 0; k < most; ++k) {
    const double inverse = 1 / length;
    parallel_for(
      q.size(), [&](const std::size_t i) { q[i] *= inverse; }, many_corners);
    S(q, y);
    if (k > 0)
      beside.push_back(length);
    diagonal.push_back(dot(flat(q), flat(y)));
    parallel_for(
      q.size(), [&](const std::size_t i) { y[i] -= diagonal.back() * q[i] + (k > 0 ? length : 0) * before[i]; },
      many_corners);
    std::swap(before, q);
    std::swap(q, y);
    length = norm(q);
    const bool ends = !(length > 1e-12 * std::abs(diagonal.back())) || k + 1 == most;
    if (ends || k % between == between - 1) {
      const double now = largest_eigenvalue(diagonal, beside);
      if (ends || std::abs(now - eigenvalue) <= accuracy * std::abs(now))
        return now;
      eigenvalue = now;
    }
  }
  return eigenvalue;
}

/// Largest eigenvalue of M^-1 A.
double largest_of(const ForceModel& model, const Constraints& constraints, const Symmetric& A) {
  const auto mass = model.lumped_mass();
  Points p(mass.size());
  std::vector<double> scale(mass.size());
  for (std::size_t i = 0; i < p.size(); ++i)
    scale[i] = per_mass(1.0, std::sqrt(mass[i]));
  const Symmetric S = [&](const Points& q, Points& y) {
    parallel_for(
      p.size(), [&](const std::size_t i) { p[i] = scale[i] * q[i]; }, many_corners);
    A(p, y);
    parallel_for(
      p.size(), [&](const std::size_t i) { y[i] *= scale[i]; }, many_corners);
    constraints.project(y);
  };
  return std::max(0.0, lanczos(S, random_directions(mass.size(), constraints)));
}

double spectral_radius(const Eigen::Matrix2d& A) {
  const double half_trace = 0.5 * A.trace(), determinant = A.determinant(),
               discriminant = half_trace * half_trace - determinant;
  return discriminant < 0 ? std::sqrt(determinant) : std::abs(half_trace) + std::sqrt(discriminant);
}

} // namespace

double largest_square_frequency(ElasticModel& model, const Loads& loads, const State& state) {
  const Constraints constraints(loads, state.x.size());
  model.linearise(state.x);
  const LoadTangent tangent = load_tangent(loads, Tangent::positive, {state.time, state.x, state.v}, 0);
  return largest_of(model, constraints, [&](const Points& p, Points& y) {
    model.apply_stiffness(flat(p), flat(y));
    tangent.add_product(flat(p), flat(y));
  });
}

double largest_load_damping(const ForceModel& model, const Loads& loads, const State& state) {
  const Moment moment{state.time, state.x, state.v};
  LoadTangent with, without;
  for (const auto& load : loads.acting)
    if (!load->is_bounded_in_velocity()) {
      load->add_tangent(Tangent::positive, moment, 1, with);
      load->add_tangent(Tangent::positive, moment, 0, without);
    }
  if (with.empty())
    return 0;
  const Constraints constraints(loads, state.x.size());
  Points stiffness(state.x.size());
  return largest_of(model, constraints, [&](const Points& p, Points& y) {
    y.assign(p.size(), Vec3::Zero());
    stiffness.assign(p.size(), Vec3::Zero());
    with.add_product(flat(p), flat(y));
    without.add_product(flat(p), flat(stiffness));
    for (std::size_t i = 0; i < y.size(); ++i)
      y[i] -= stiffness[i];
  });
}

double load_square_bound(const ForceModel& model, const Loads& loads, const State& state) {
  if (loads.acting.empty())
    return 0;
  const LoadTangent tangent = load_tangent(loads, Tangent::positive, {state.time, state.x, state.v}, 0);
  if (tangent.empty())
    return 0;
  const auto mass = model.lumped_mass();
  Loan<Mat3> blocks(mass.size(), Mat3::Zero());
  std::vector<std::pair<std::uint32_t, double>> weights; // of a point, which add up to 1
  tangent.for_each_point([&](const std::uint32_t corner, const double weight) { weights.emplace_back(corner, weight); },
                         [&](const Mat3& block) {
                           for (const auto& [corner, weight] : weights)
                             blocks[corner] += std::abs(weight) * block;
                           weights.clear();
                         });
  tangent.add_bound_of_pairs(blocks);
  double most = 0;
  for (std::size_t i = 0; i < mass.size(); ++i)
    most = std::max(most, per_mass(blocks[i].trace(), mass[i]));
  return most;
}

double stable_step(const Amplification amplification, const Mode& fastest, const double stiffness_damping,
                   const double allowance) {
  const double rate = std::sqrt(fastest.square) + fastest.mass_damping + fastest.other_damping;
  if (rate == 0)
    return std::numeric_limits<double>::infinity();
  const auto is_stable = [&](const double dt) {
    constexpr int n_modes = 64; // from the fastest on, each 0.8 times the frequency of the one before
    Mode mode = fastest;
    for (int k = 0; k < n_modes; ++k) {
      if (!(spectral_radius(amplification(mode, dt)) <= 1 + allowance))
        return false;
      mode.other_damping -= 0.36 * stiffness_damping * mode.square;
      mode.square *= 0.64;
    }
    return true;
  };
  double stable = 0, unstable = 16 / rate + 4 * fastest.mass_damping / std::max(fastest.square, rate);
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (stable + unstable);
    (is_stable(middle) ? stable : unstable) = middle;
  }
  return stable;
}

double StepLimit::at(const State& state, const Loads& loads) const {
  Mode mode{.square = largest_square_frequency(model_, loads, state), .mass_damping = loads.mass_damping};
  mode.other_damping = loads.stiffness_damping * mode.square + largest_load_damping(model_, loads, state);
  return stable_step(scheme_.amplification, mode, loads.stiffness_damping, scheme_.allowance);
}

void StepLimit::require(const State& state, const Loads& loads, const double dt,
                        std::map<std::string, double>& numbers) {
  constexpr double steps_between = 200, part = 0.75, stiffer = 1.1;
  if (options_.beyond == BeyondStable::go_on)
    return;
  double &n_since = ++numbers[steps_since_], &load_known = numbers[load_];
  const double load = load_square_bound(model_, loads, state);
  const bool is_stiffer = load > stiffer * std::max(load_known, load_found_);
  if (dt <= longest_checked_ && !is_stiffer)
    return;
  const auto known = numbers.find(known_);
  const bool is_first = known == numbers.end();
  const bool is_found = n_since_found_ >= 0 && ++n_since_found_ < steps_between && !is_stiffer;
  if (!is_found && !is_first && dt <= part * known->second && n_since < steps_between && !is_stiffer) {
    last_ = known->second;
    return;
  }
  if (!is_found) {
    longest_checked_ = 0;
    last_ = at(state, loads);
    load_found_ = load;
    n_since_found_ = 0;
  }
  require_stable(dt, is_first);
  numbers[known_] = last_;
  load_known = load_found_;
  n_since = n_since_found_;
}

void StepLimit::require_stable(const double dt, const bool is_first) {
  constexpr double near = 0.9; // of the stable step: beyond, what moves may already swing by five times its energy
  if (dt <= (is_first ? 1 : near) * last_) {
    longest_checked_ = dt;
    return;
  }
  const std::string rule = scheme_.name + " is stable here up to " + to_text(last_) + " s";
  if (!is_first)
    throw NumericalError("the time step is " + in_short(dt) + " s, and " + rule +
                         ": contact, a load or a cut has made something stiff");
  throw ParameterError(Complaint{.path = "Time step [s]",
                                 .value = in_short(dt), // of one that ends with others, whose round-off it has
                                 .rule = rule,
                                 .remedy = "Use a smaller time step or an implicit integrator, or set Beyond the "
                                           "stable step = go on"});
}

} // namespace kerf::dynamics
