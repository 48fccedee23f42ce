#include "dynamics/balance.h"

#include "base/error.h"
#include "base/parallel.h"
#include "base/parameters.h"
#include "dynamics/conjugate_gradients.h"
#include "dynamics/direct.h"
#include "dynamics/forces.h"
#include "dynamics/minimal_residuals.h"
#include "dynamics/points.h"
#include "dynamics/state.h"

#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace kerf::dynamics {
namespace {

constexpr int most_where_not_taken = 30; // Newton iterations

} // namespace

BalanceSolver::BalanceSolver(ElasticModel& model, const NewtonOptions& options)
  : model_(model), matrix_(dynamic_cast<const StiffnessMatrix*>(&model)), options_(options), pieces_(options.piece) {
  options_.piece = {}; // pieces_ knows them
  if (options_.solver == LinearSolver::direct && !matrix_)
    throw ParameterError(Complaint{.rule = "a direct solver needs an assembled stiffness, which this model has not",
                                   .remedy = "Use conjugate gradients"});
}

NewtonReport BalanceSolver::solve(const Loads& loads, const Constraints& constraints, Balance balance, Points& x) {
  const double omega = balance.velocity_factor;
  const Problem problem{loads,
                        constraints,
                        balance,
                        model_.lumped_mass(),
                        model_.mass_coupling(),
                        balance.mass_factor + loads.mass_damping * omega,
                        1 + loads.stiffness_damping * omega};
  x = balance.start;
  way_ = 0;
  inertia_.reset();
  if (options_.trust == Trust::tested)
    flies_ = *flying(problem);
  NewtonReport report;
  Mixing mixing(static_cast<std::size_t>(options_.n_mixed));
  LineSearch line_search = options_.line_search;
  int most = options_.max_iterations;
  double first = 0;
  Verdict verdict = Verdict::taken;
  const bool has_guess = !balance.guess.empty();
  for (;;) {
    double scale = linearise_at(problem, x);
    if (options_.tolerance > 0) {
      const double left = norm(residual_);
      if (!has_guess)
        first = std::max(first, left);
      const double most_force = std::max(first, balanced_forces_);
      report.residual = most_force > 0 ? left / most_force : 0;
      report.converged = left <= std::max(options_.tolerance * most_force, round_off_of_forces(x));
      if (report.converged)
        return report;
    }
    const bool is_enough = verdict == Verdict::goes_on && report.n_newton >= options_.max_iterations;
    if (report.n_newton == most || (is_enough && works_little(problem, x, scale)))
      break;
    report.n_linear += correct(problem, x, std::exchange(balance.guess, Loan<Vec3>::none()), scale);
    ++report.n_newton;
    if (report.n_newton == 1 && options_.trust == Trust::tested && line_search == LineSearch::none) {
      Loan<Vec3> end = moved(x, 1, correction_);
      verdict = judge(problem, end);
      if (verdict != Verdict::taken) {
        line_search = LineSearch::backtracking;
        most = std::max(most, most_where_not_taken);
      }
      if (verdict == Verdict::goes_on) {
        x.swap(end);
        continue;
      }
      if (verdict == Verdict::refused) {
        linearise_at(problem, x);
        squared_ways_ = *ways_from_free_motion(problem);
      }
    }
    const bool is_last = verdict == Verdict::refused && report.n_newton > 1 && is_small();
    const double length = line_search == LineSearch::none || is_last ? 1 : mixed_search(problem, x, mixing);
    if (length == 0) {
      report.failure = "no step along the correction lowers the energy";
      break;
    }
    x.swap(moved(x, length, correction_));
    if (is_last || (options_.tolerance == 0 && report.n_newton == most))
      return report;
  }
  report.converged = options_.tolerance == 0 && !(verdict == Verdict::refused && !report.failure.empty());
  return report;
}

double BalanceSolver::linearise_at(const Problem& problem, const Points& x) {
  model_.linearise(x);
  move_to(problem, x);
  factorise(problem);
  return assemble_residual(problem, x);
}

double BalanceSolver::square_of_scaled_residual() const {
  return sum_of(residual_.size(), [&](const std::size_t begin, const std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i)
      sum += scaled(i, residual_[i]).squaredNorm();
    return sum;
  });
}

Loan<Vec3> BalanceSolver::velocities(const Problem& problem, const Points& x) {
  Loan<Vec3> v(x.size());
  parallel_for(
    x.size(), [&](const std::size_t i) { v[i] = problem.velocity(x, i); }, many_corners);
  return v;
}

void BalanceSolver::move_to(const Problem& problem, const Points& x) {
  const Balance& b = problem.balance;
  const bool is_damped = problem.loads.stiffness_damping > 0 && b.velocity_factor > 0;
  damping_.clear();
  tangent_ = {};
  if (!is_damped && problem.loads.acting.empty())
    return;
  const Loan<Vec3> v = velocities(problem, x);
  tangent_ = load_tangent(problem.loads, Tangent::positive, {b.time, x, v}, b.velocity_factor);
  if (is_damped) {
    damping_.resize(x.size());
    model_.apply_stiffness(flat(*v), flat(damping_));
  }
}

void BalanceSolver::factorise(const Problem& problem) {
  const std::size_t n = problem.mass.size();
  Loan<Mat3> of_loads = Loan<Mat3>::none();
  if (!tangent_.empty()) {
    of_loads = Loan<Mat3>(n, Mat3::Zero());
    tangent_.add_diagonal(of_loads);
  }
  size_.resize(n);
  scaling_.resize(n);
  model_.stiffness_diagonal([&](const std::size_t i, const Mat3& of_stiffness) {
    Mat3 block = problem.stiffness_factor * of_stiffness + problem.mass_factor * problem.mass[i] * Mat3::Identity();
    if (!of_loads.empty())
      block += of_loads[i];
    size_[i] = block.trace();
    scaling_[i] = inverse_factor_in_single(block, problem.constraints.freedom(i));
  });
}

Vec3 BalanceSolver::damping(const Problem& problem, const std::size_t i) const {
  return damping_.empty() ? Vec3(Vec3::Zero()) : Vec3(problem.loads.stiffness_damping * damping_[i]);
}

Loan<Vec3> BalanceSolver::coupled_inertia(const Problem& problem, const Points& x) const {
  if (!problem.coupling)
    return Loan<Vec3>::none();
  Loan<Vec3> a(x.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    a[i] = problem.resisted(x, i);
  return coupled(model_, a);
}

double BalanceSolver::assemble_residual(const Problem& problem, const Points& x) {
  const auto& [loads, constraints, balance, mass, coupling, mass_factor, stiffness_factor] = problem;
  const std::size_t n = x.size();
  Loan<Vec3> force = Loan<Vec3>::with_room(n);
  model_.force(x, force);
  Loan<Vec3> of_loads = Loan<Vec3>::none();
  if (!loads.acting.empty()) {
    of_loads = Loan<Vec3>(n, Vec3::Zero());
    add_load_forces(loads, {balance.time, x, velocities(problem, x)}, of_loads);
  }
  const auto load_force = [&](const std::size_t i) { return Problem::of_corner(of_loads, i); };
  residual_.resize(n);
  if (!inertia_)
    inertia_ = inertia_of_guess(problem);
  const Loan<Vec3> more = coupled_inertia(problem, x);
  const double square_of_scale = sum_of(n, [&](const std::size_t begin, const std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 weight = mass[i] * loads.gravity, resistance = mass[i] * problem.resisted(x, i) + damping(problem, i);
      residual_[i] = force[i] + weight + load_force(i) + problem.offset(i) - resistance;
      if (coupling)
        residual_[i] -= more[i];
      if (!constraints.is_free(i))
        residual_[i] = constraints.freedom(i).project * residual_[i];
      const Mat3 S = scaling_[i].cast<double>();
      sum += (S * force[i]).squaredNorm() + (S * weight).squaredNorm();
      if (!of_loads.empty())
        sum += (S * of_loads[i]).squaredNorm();
    }
    return sum;
  });
  balance.free.relieve_forces(flat(residual_));
  if (!std::isfinite(square_of_scale) || !std::isfinite(norm(residual_)))
    throw NumericalError("forces are not finite");
  if (options_.tolerance > 0)
    balanced_forces_ = std::sqrt(sum_of(n, [&](const std::size_t begin, const std::size_t end) {
      double sum = 0;
      for (std::size_t i = begin; i < end; ++i)
        sum += force[i].squaredNorm() + load_force(i).squaredNorm() + (mass[i] * loads.gravity).squaredNorm();
      return sum;
    }) + inertia_->plain);
  scaled_round_off_ = scaled_round_off_at(x);
  return std::sqrt(square_of_scale + inertia_->scaled);
}

BalanceSolver::InertiaSquares BalanceSolver::inertia_of_guess(const Problem& problem) const {
  const Points& guess = problem.balance.guess;
  const auto sum = [&](const auto& square) {
    return sum_of(problem.mass.size(), [&](const std::size_t begin, const std::size_t end) {
      double all = 0;
      for (std::size_t i = begin; i < end; ++i)
        all += square(i, problem.mass[i] * (problem.acceleration_at_start(i) +
                                            problem.balance.mass_factor * Problem::of_corner(guess, i)));
      return all;
    });
  };
  return {sum([&](const std::size_t i, const Vec3& f) { return scaled(i, f).squaredNorm(); }),
          options_.tolerance > 0 ? sum([](std::size_t, const Vec3& f) { return f.squaredNorm(); }) : 0};
}

double BalanceSolver::round_off_of_forces(const Points& x) const {
  constexpr double round_off = 8 * std::numeric_limits<double>::epsilon();
  return round_off * std::sqrt(sum_of(x.size(), [&](const std::size_t begin, const std::size_t end) {
           double sum = 0;
           for (std::size_t i = begin; i < end; ++i)
             sum += (size_[i] * x[i]).squaredNorm(); // x itself is rounded, and A is what it meets
           return sum;
         }));
}

double BalanceSolver::scaled_round_off_at(const Points& x) const {
  constexpr double round_off = 8 * std::numeric_limits<double>::epsilon(),
                   nothing = 1e-100; // squares of less underflow
  return std::max(nothing, round_off * std::sqrt(sum_of(x.size(), [&](const std::size_t begin, const std::size_t end) {
                             double sum = 0;
                             for (std::size_t i = begin; i < end; ++i)
                               sum += size_[i] * x[i].squaredNorm();
                             return sum;
                           })));
}

void BalanceSolver::apply(const Problem& problem, const std::span<const double> p, const std::span<double> y) {
  model_.apply_stiffness(p, y);
  if (problem.coupling) {
    mass_product_.assign(p.size(), 0);
    problem.coupling->add_product(p, mass_product_);
  }
  if (!tangent_.empty()) {
    load_product_.assign(p.size(), 0);
    tangent_.add_product(p, load_product_);
  }
  parallel_for(
    residual_.size(),
    [&](const std::size_t i) {
      Vec3 Ap =
        problem.mass_factor * problem.mass[i] * at(p, i) + problem.stiffness_factor * at(std::span<const double>(y), i);
      if (problem.coupling)
        Ap += problem.mass_factor * at(std::span<const double>(mass_product_), i);
      if (!tangent_.empty())
        Ap += at(std::span<const double>(load_product_), i);
      if (!problem.constraints.is_free(i))
        Ap = (problem.constraints.freedom(i).project * Ap).eval();
      at(y, i) = Ap;
    },
    many_corners);
}

/// Nothing along directions that are held, of which single precision would leave something.
Vec3 BalanceSolver::by_inverse_block(const Problem& problem, const std::size_t corner, const Vec3& force) const {
  const Vec3 all = scaling_[corner].cast<double>().transpose() * scaled(corner, force);
  return problem.constraints.is_free(corner) ? all : Vec3(problem.constraints.freedom(corner).project * all);
}

void BalanceSolver::apply_inverse_blocks(const Problem& problem, const std::span<const double> r,
                                         const std::span<double> z) const {
  parallel_for(
    scaling_.size(), [&](const std::size_t i) { at(z, i) = by_inverse_block(problem, i, at(r, i)); },
    many_corners);
}

Preconditioner* BalanceSolver::preconditioner(const Problem& problem) {
  const double trace = std::accumulate(size_.begin(), size_.end(), 0.0);
  return model_.preconditioner(
    {problem.mass_factor, problem.stiffness_factor, problem.mass, trace, tangent_, problem.constraints});
}

int BalanceSolver::correct(const Problem& problem, const Points& x, Loan<Vec3> guess, const double scale) {
  int n_iterations = 0;
  elastic_.clear();
  if (options_.solver == LinearSolver::conjugate_gradients) {
    n_iterations = correct_by_cg(problem, std::move(guess), scale);
  } else {
    correct_directly(problem, x, options_.tangent);
    if (options_.tangent == Tangent::exact && !(product(residual_, correction_) > 0))
      correct_directly(problem, x, Tangent::positive); // at a saddle the exact one leads uphill
  }
  if (options_.line_search != LineSearch::none && !(product(residual_, correction_) > 0))
    for (std::size_t i = 0; i < correction_.size(); ++i) // the scaled force itself always leads downhill
      correction_[i] = by_inverse_block(problem, i, residual_[i]);
  problem.balance.free.relieve_motion(flat(correction_));
  return n_iterations;
}

int BalanceSolver::correct_by_cg(const Problem& problem, Loan<Vec3> guess, const double scale) {
  const bool has_guess = !guess.empty();
  correction_.resize(residual_.size());
  parallel_for(
    residual_.size(),
    [&](const std::size_t i) {
      correction_[i] = has_guess ? Vec3(problem.constraints.freedom(i).project * guess[i]) : Vec3(Vec3::Zero());
    },
    many_corners);
  guess = Loan<Vec3>::none();
  const double of_own = 0.5 * options_.step_tolerance; // the step's own error is half the way from free motion
  const double left =
    options_.n_mixed > 0 ? 1e-3 * std::sqrt(square_of_scaled_residual()) : 0; // where other corrections follow
  CgStop stop{.residual = std::max({options_.cg_tolerance * scale, left, scaled_round_off_}),
              .error = of_own * way_,
              .of_way = has_guess ? of_own : 0};
  if (stop.of_way > 0 && !problem.balance.guess_is_free_motion)
    stop.from = {[&](const auto product) { return potential_of_free_motion(problem, product); },
                 [&] { return inertia_of_way(problem); }};
  const Product A = [&](const auto p, const auto y) { apply(problem, p, y); }, J = [&](const auto r, const auto z) {
    apply_inverse_blocks(problem, r, z);
    problem.balance.free.relieve_motion(z);
  };
  Preconditioner* const own = options_.equation == Equation::regular ? preconditioner(problem) : nullptr;
  const CgEquation equation =
    own ? CgEquation{A, [own](const auto r, const auto z) { own->apply(r, z); }, J} : CgEquation{A, J, {}};
  Loan<Vec3> unsolved(residual_.size());
  const CgReport report = solve_equation(equation, own ? own->stiff_part() : nullptr, flat(residual_), stop,
                                         options_.max_cg_iterations, flat(correction_), flat(*unsolved));
  if (!report.converged && !report.indefinite)
    throw NumericalError("conjugate gradients left a relative residual of " + to_text(report.residual / scale) +
                         " after " + std::to_string(report.n_iterations) + " iterations. Use " +
                         (problem.mass_factor > 0 ? "a smaller time step, " : "") +
                         "more CG iterations or a larger CG tolerance");
  if (has_guess)
    way_ = report.way;
  if (options_.trust == Trust::tested && tangent_.empty() && !report.indefinite)
    put_elastic(problem, std::move(unsolved));
  return report.n_iterations;
}

/// Conjugate gradients have had A d = r - unsolved, so d.Kd takes no product.
void BalanceSolver::put_elastic(const Problem& problem, Loan<Vec3> unsolved) {
  parallel_for(
    unsolved.size(), [&](const std::size_t i) { unsolved[i] = residual_[i] - unsolved[i]; }, many_corners);
  const Loan<double> all = pieces_.products(correction_, unsolved),
                     inertia = pieces_.products(correction_, momenta(model_, correction_));
  elastic_.resize(all.size());
  for (std::size_t p = 0; p < all.size(); ++p)
    elastic_[p] = (all[p] - problem.mass_factor * inertia[p]) / problem.stiffness_factor;
}

Vec3 BalanceSolver::free_motion(const Problem& problem, const std::size_t i) {
  return problem.constraints.freedom(i).project *
         (-1 / problem.balance.mass_factor * problem.acceleration_at_start(i));
}

double BalanceSolver::inertia_of_way(const Problem& problem) const {
  if (problem.coupling) {
    Loan<Vec3> way(correction_.size());
    for (std::size_t i = 0; i < way.size(); ++i)
      way[i] = correction_[i] - free_motion(problem, i);
    return std::sqrt(problem.mass_factor * product(way, momenta(model_, way)));
  }
  return std::sqrt(problem.mass_factor * sum_of(correction_.size(), [&](const std::size_t begin, const std::size_t end) {
                     double sum = 0;
                     for (std::size_t i = begin; i < end; ++i)
                       sum += problem.mass[i] * (correction_[i] - free_motion(problem, i)).squaredNorm();
                     return sum;
                   }));
}

double BalanceSolver::potential_of_free_motion(const Problem& problem, const std::span<double> Ad) {
  Loan<Vec3> d(residual_.size());
  parallel_for(
    d.size(), [&](const std::size_t i) { d[i] = free_motion(problem, i); }, many_corners);
  apply(problem, flat(*d), Ad);
  return dot(flat(*d), Ad) - 2 * product(residual_, d);
}

void BalanceSolver::correct_directly(const Problem& problem, const Points& x, const Tangent kind) {
  const Balance& b = problem.balance;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (int k = 0; k < 3; ++k)
      entries.emplace_back(3 * i + k, 3 * i + k, problem.mass_factor * problem.mass[i]);
  if (problem.coupling)
    problem.coupling->add_entries(problem.mass_factor, entries);
  load_tangent(problem.loads, kind, {b.time, x, velocities(problem, x)}, b.velocity_factor).add_entries(entries);
  Eigen::SparseMatrix<double> A(3 * x.size(), 3 * x.size());
  A.setFromTriplets(entries.begin(), entries.end());
  A += problem.stiffness_factor * matrix_->stiffness_matrix(x, kind);
  solve_directly(A, problem.constraints, residual_, correction_);
}

double BalanceSolver::mixed_search(const Problem& problem, const Points& x, Mixing& mixing) {
  constexpr double far = 0.25; // a mixed correction that must be shorter knows nothing of what lies ahead
  if (options_.n_mixed == 0)
    return search(problem, x);
  const Loan<Vec3> plain(correction_);
  mixing.mix(x, size_, correction_);
  if (product(residual_, correction_) > 0)
    if (const double length = search(problem, x); length >= far)
      return length;
  mixing.forget();
  correction_ = *plain;
  return search(problem, x);
}

double BalanceSolver::search(const Problem& problem, const Points& x) {
  const double slope = -product(residual_, correction_);
  if (slope == 0)
    return 1;
  Loan<Vec3> damped(x.size(), Vec3::Zero()), trial(x.size());
  if (problem.loads.stiffness_damping > 0 && problem.balance.velocity_factor > 0)
    model_.apply_stiffness(flat(correction_), flat(*damped));
  constexpr int most_halvings = 40;
  constexpr double part = 1e-4, drowned = 1e-9; // of the slope; of the energies whose difference counts
  double length = 1;
  for (int i = 0; i < most_halvings; ++i, length *= 0.5) {
    for (std::size_t k = 0; k < x.size(); ++k)
      trial[k] = x[k] + length * correction_[k];
    const Change c = change(problem, x, trial, length, damped);
    if (c.potential <= part * length * slope) // false for NaN
      return length;
    if (std::abs(c.potential) <= drowned * c.size && c.slope <= (2 * part - 1) * slope)
      return length;
  }
  return 0;
}

BalanceSolver::Change BalanceSolver::change(const Problem& problem, const Points& x, const Points& trial,
                                            const double length, const Points& damped) const {
  const Loads& loads = problem.loads;
  const Balance& b = problem.balance;
  Loan<Vec3> force = Loan<Vec3>::with_room(x.size());
  model_.force(trial, force);
  double linear = 0, quadratic = 0; // in the length, of all that is no energy of its own
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3& d = correction_[i];
    linear +=
      d.dot(problem.mass[i] * (problem.resisted(x, i) - loads.gravity) + damping(problem, i) - problem.offset(i));
    quadratic += 0.5 * problem.mass_factor * problem.mass[i] * d.squaredNorm() +
                 0.5 * loads.stiffness_damping * b.velocity_factor * d.dot(damped[i]);
  }
  if (problem.coupling) {
    const Loan<Vec3> more = coupled(model_, correction_);
    Loan<Vec3> a(x.size());
    for (std::size_t i = 0; i < a.size(); ++i)
      a[i] = problem.resisted(x, i);
    linear += product(a, more);
    quadratic += 0.5 * problem.mass_factor * product(correction_, more);
  }
  const auto [at_x, at_trial] = without_potential(problem, x, trial, length);
  if (!loads.acting.empty()) {
    const Loan<Vec3> v = velocities(problem, x);
    for (const auto& load : loads.acting)
      if (load->nature() == Nature::conservative)
        load->add_force({b.time, trial, v}, force);
  }
  const double before = model_.energy(x) + load_energy(loads, b.time, x),
               after = model_.energy(trial) + load_energy(loads, b.time, trial);
  return {after - before + length * (linear - 0.5 * (at_x + at_trial)) + length * length * quadratic,
          std::abs(before) + std::abs(after), linear + 2 * length * quadratic - at_trial - product(force, correction_)};
}

std::array<double, 2> BalanceSolver::without_potential(const Problem& problem, const Points& x, const Points& trial,
                                                       const double length) const {
  if (problem.loads.acting.empty())
    return {0, 0};
  const Balance& b = problem.balance;
  Loan<Vec3> v = velocities(problem, x);
  const auto times_correction = [&](const Points& where) {
    Loan<Vec3> forces(x.size(), Vec3::Zero());
    for (const auto& load : problem.loads.acting)
      if (load->nature() != Nature::conservative)
        load->add_force({b.time, where, v}, forces);
    return product(forces, correction_);
  };
  const double at_x = times_correction(x);
  for (std::size_t i = 0; i < v.size(); ++i)
    v[i] += b.velocity_factor * length * correction_[i];
  return {at_x, times_correction(trial)};
}

} // namespace kerf::dynamics
