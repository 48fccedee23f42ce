/// What a correction must bear where it ends (balance.h). Nothing joins the pieces of a body, so each is asked by
/// itself.

#include "base/error.h"
#include "base/parallel.h"
#include "dynamics/balance.h"
#include "dynamics/forces.h"
#include "dynamics/points.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace kerf::dynamics {

namespace {


} // namespace

Loan<std::uint8_t> BalanceSolver::flying(const Problem& problem) const {
  Loan<std::uint8_t> flies(pieces_.n(), problem.loads.acting.empty() ? 1 : 0);
  for (std::size_t i = 0; i < problem.mass.size(); ++i)
    if (!problem.constraints.is_free(i))
      flies[pieces_.of(i)] = 0;
  return flies;
}

Loan<Vec3> BalanceSolver::unlike_flight(const Problem& problem, Loan<Vec3> values) const {
  pieces_.take_out_mean(problem.mass, flies_, values);
  return values;
}

double BalanceSolver::error_of_cg() const { return 0.5 * options_.step_tolerance * way_; }

Loan<std::uint8_t> BalanceSolver::seen(const double scale) const {
  Loan<double> squares(pieces_.n(), 0);
  if (pieces_.n() == 1)
    squares[0] = square_of_scaled_residual();
  for (std::size_t i = 0; i < residual_.size() && pieces_.n() > 1; ++i)
    squares[pieces_.of(i)] += scaled(i, residual_[i]).squaredNorm();
  const double least = std::max(options_.cg_tolerance * scale, scaled_round_off_);
  Loan<std::uint8_t> is_seen(squares.size());
  std::ranges::transform(*squares, is_seen->begin(),
                         [&](const double square) { return square > least * least ? 1 : 0; });
  return is_seen;
}

bool BalanceSolver::slopes_little(const Points& d, const std::vector<double>& at_start, const double scale) const {
  constexpr double part = 0.25; // of the slope at the start
  const Loan<double> at_end = pieces_.products(residual_, d);
  const auto is_seen = seen(scale);
  for (std::size_t p = 0; p < pieces_.n(); ++p) {
    const double slope = std::abs(at_start[p]);
    if (is_seen[p] && std::abs(at_end[p]) > part * slope + std::sqrt(slope) * error_of_cg())
      return false;
  }
  return true;
}

BalanceSolver::Verdict BalanceSolver::judge(const Problem& problem, const Points& end) {
  double scale = 0;
  {
    const Loan<Vec3> d = unlike_flight(problem, correction_);
    const Loan<double> at_start = pieces_.products(residual_, d);
    try {
      move_to(problem, end);
      scale = assemble_residual(problem, end);
    } catch (const NumericalError&) { // no forces there
      return Verdict::refused;
    }
    if (!slopes_little(d, at_start, scale))
      return Verdict::refused;
  }
  if (!turns_little(problem, end))
    return Verdict::refused;
  most_work_ = *most_work(problem, end);
  return works_little(problem, end, scale) ? Verdict::taken : Verdict::goes_on;
}

Loan<double> BalanceSolver::most_work(const Problem& problem, const Points& x) {
  const double dt = 1 / problem.balance.velocity_factor;
  const auto with_inertia = [&](const Points& values) { return pieces_.products(values, momenta(model_, values)); };
  const Loan<double> of_change = [&] {
    Loan<Vec3> a(x.size());
    parallel_for(
      a.size(), [&](const std::size_t i) { a[i] = problem.acceleration(x, i); }, many_corners);
    return with_inertia(a);
  }();
  const Loan<Vec3> d = unlike_flight(problem, moved(x, -1, problem.balance.start));
  const Loan<double> of_way = with_inertia(d);
  const Loan<double> elastic = [&] { // mean motions have none
    if (!elastic_.empty() && tangent_.empty())
      return Loan<double>(elastic_);
    Loan<Vec3> Kd(x.size(), Vec3::Zero());
    model_.apply_stiffness(flat(d), flat(*Kd));
    if (!tangent_.empty())
      tangent_.add_product(flat(d), flat(*Kd));
    return pieces_.products(d, Kd);
  }();
  Loan<double> most(pieces_.n());
  for (std::size_t p = 0; p < most.size(); ++p)
    most[p] = 0.5 * (dt * dt * of_change[p] + elastic[p]) +
              error_of_cg() * std::sqrt(std::max(0.0, elastic[p] + problem.mass_factor * of_way[p]));
  return most;
}

bool BalanceSolver::works_little(const Problem& problem, const Points& x, const double scale) const {
  const Loan<double> work = pieces_.products(residual_, unlike_flight(problem, moved(x, -1, problem.balance.start)));
  const auto is_seen = seen(scale);
  for (std::size_t p = 0; p < work.size(); ++p)
    if (is_seen[p] && -work[p] > most_work_[p])
      return false;
  return true;
}

bool BalanceSolver::turns_little(const Problem& problem, const Points& x) const {
  struct Turning {
    Vec3 turned = Vec3::Zero(), spin = Vec3::Zero();
    double energy = 0, inertia = 0; // twice the kinetic energy
  };
  const Balance& b = problem.balance;
  if (b.velocity_factor == 0 || std::ranges::count(flies_, 0) == std::ssize(flies_))
    return true;
  const double dt = 1 / b.velocity_factor;
  Loan<Vec3> at_start(x.size());
  for (std::size_t i = 0; i < at_start.size(); ++i)
    at_start[i] = problem.velocity_at_start(i) - dt * problem.acceleration_at_start(i);
  const Loan<Vec3> r = unlike_flight(problem, x), v = unlike_flight(problem, velocities(problem, x)),
                   v_0 = unlike_flight(problem, std::move(at_start)), p_0 = momenta(model_, v_0);
  Loan<Turning> all(pieces_.n());
  for (std::size_t i = 0; i < x.size(); ++i) {
    Turning& piece = all[pieces_.of(i)];
    piece.turned += dt * (v[i].cross(p_0[i]) - r[i].cross(residual_[i]));
    piece.spin += r[i].cross(p_0[i]);
    piece.energy += v_0[i].dot(p_0[i]);
    piece.inertia += problem.mass[i] * r[i].squaredNorm();
  }
  constexpr double own = 1.1, unseen = 1e-4; // of what the method does; of all that the energy could be
  for (std::size_t p = 0; p < all.size(); ++p) {
    const auto& [turned, spin, energy, inertia] = all[p];
    if (flies_[p] && turned.norm() * spin.norm() >
                       own * dt * dt * energy * energy + unseen * std::sqrt(energy * inertia) * spin.norm())
      return false;
  }
  return true;
}

Loan<double> BalanceSolver::ways_from_free_motion(const Problem& problem) {
  Loan<Vec3> way(correction_.size()), A_way(correction_.size());
  for (std::size_t i = 0; i < way.size(); ++i)
    way[i] = correction_[i] +
             problem.constraints.freedom(i).project * (1 / problem.mass_factor * problem.acceleration_at_start(i));
  apply(problem, flat(*way), flat(*A_way));
  return pieces_.products(way, A_way);
}

bool BalanceSolver::is_small() {
  constexpr double part = 0.03;
  const Loan<double> decrement = pieces_.products(residual_, correction_); // squares of the ways that are left
  const double unseen = error_of_cg() * error_of_cg();
  bool all = true;
  for (std::size_t p = 0; p < decrement.size(); ++p) {
    squared_ways_[p] += std::max(0.0, decrement[p]);
    all = all && std::abs(decrement[p]) <= std::max(unseen, part * part * squared_ways_[p]);
  }
  return all;
}

} // namespace kerf::dynamics
