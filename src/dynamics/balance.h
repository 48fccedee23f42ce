#pragma once

/// One nonlinear equation behind all implicit integrators and behind statics: the balance of forces
///
///     M (a + alpha v) + beta K v = f(x) + M g + sum of loads(time, x, v) + offset,
///     a = a_0 + kappa (x - x_0),   v = v_0 + omega (x - x_0),
///
/// for x, with supports eliminated: an integrator is a choice of kappa, omega, x_0, v_0, a_0 (Hughes, The Finite
/// Element Method, 2000, ch. 9), statics is kappa = omega = 0. K is the model's stiffness at the iterate.
///
/// Newton's method from x_0. A correction solves A d = r with A = (kappa + alpha omega) M + (1 + beta omega) K + loads,
/// by conjugate gradients or by a factorisation, among the directions that supports leave free. Residuals are measured
/// by the inverses L^-T L^-1 of A's diagonal 3 x 3 blocks (L: Cholesky factors), in which the lumped masses stand for
/// M, as they bound it from above: each corner counts in its own measure, one of hardly any mass like every other. The
/// same are the preconditioner, or what the model offers in their place (preconditioner.h), as long as that comes to an
/// end within 400 iterations.
///
/// The line search halves a correction until the incremental potential falls by 1e-4 of what its slope promises
/// (Armijo), or, where the fall drowns in round-off, until the slope has (Hager and Zhang 2005, A new conjugate
/// gradient method with guaranteed descent, SIAM J. Optim. 16, sec. 3): elastic energy, gravity, conservative loads,
/// (kappa + alpha omega) M |x - x_0|^2 / 2 and so on, and for loads without a potential their work along the
/// correction, by the trapezoidal rule.
///
/// A correction that is tested (Trust) costs one evaluation of forces more, and is taken where its end bears it, in
/// each piece of the body by itself: nothing joins them, and what a small one lacks is not to drown in what a large one
/// does. What conjugate gradients do not see counts for nothing. Its quadratic model has little slope left there: the
/// power of what is out of balance has fallen to a quarter (curvature condition of Wolfe 1969, Convergence conditions
/// for ascent methods), uniform motion of a free piece aside, which anything follows. And what is out of balance turns
/// a piece in free flight by hardly more than what implicit Euler itself does: with x_1 = x_0 + dt v_1, the sum of x x
/// m v changes in a step by dt times the torque at x_1 and by dt times the sum of m v_1 x v_0, which is no torque of
/// anything, and is dt^2 (2 T)^2 / L in a spin of energy T and angular momentum L. Tangents that know a stress, but not
/// all of how it turns, fail there.
///
/// It is gone on from where the energy of the step is not its own. With d = x - x_0 = dt v_1 and r what is out of
/// balance at x, the energy of a step of implicit Euler changes by
///
///     -d.r - |v_1 - v_0|_M^2 / 2 - (V(x_0) - V(x) - f(x).d),
///
/// whose last bracket is d.K d / 2 to second order and positive for a convex V: the method itself takes energy, and
/// gives none. What is left out of balance gives its work -d.r. Newton's method goes on until that is less than what
/// the method takes, |v_1 - v_0|_M^2 / 2 + d.K d / 2 with the K that the first correction has met, so that no step
/// gains energy by an unfinished solution. -d.r is of third order in dt where a solution is smooth, the other of
/// second: shorter steps need no second correction. Of a piece in free flight d is that against its mean motion.
///
/// Half the way from free motion to x is the error of the step itself: x_1 - x_0 - dt v_0 = dt^2 a_1, and implicit
/// Euler is wrong by dt^2 a / 2. Conjugate gradients know that way in the energy norm, wherever they start, and need
/// not be much better. Nothing is solved below the round-off of forces.
///
/// Where nothing resists some rigid motions, K is singular: residuals are relieved of what goes along them, and
/// corrections of what moves along them (FreeMotions).

#include "dynamics/constraints.h"
#include "dynamics/mixing.h"
#include "dynamics/pieces.h"
#include "dynamics/preconditioner.h"
#include "dynamics/rigid_modes.h"

#include <Eigen/SparseCore>

#include <array>
#include <optional>
#include <string>

namespace kerf::dynamics {

enum class LineSearch { none, backtracking };
enum class LinearSolver { conjugate_gradients, direct };

/// What to make of a correction that no line search has looked at.
enum class Trust {
  blind, ///< take it
  tested ///< test it where it leads; if it does not bear that, go on with a line search, from the start or from there
};

/// A singular equation leaves motions that nothing resists, of bodies that are free in statics. The blocks add none of
/// them; a model's preconditioner makes them of round-off, and a rotation by much lets no step along the correction
/// pass.
enum class Equation { regular, singular };

struct NewtonOptions {
  int max_iterations = 1;
  /// Forces out of balance over the forces that balance, in the scaled Euclidean norm, at which iteration ends [1].
  /// 0: no test, all iterations are done.
  double tolerance = 0;
  LineSearch line_search = LineSearch::none;
  LinearSolver solver = LinearSolver::conjugate_gradients;
  Tangent tangent = Tangent::positive; ///< what `direct` factorises; conjugate gradients take the positive one
  /// Residual of the linear equation over the forces that balance (elastic, weight, inertia, loads). Not over the
  /// right-hand side, which vanishes at rest and would be solved ever more exactly there.
  double cg_tolerance = 1e-6;
  int max_cg_iterations = 2000;
  /// Error that conjugate gradients may leave over the step's own, in the energy norm of A [1]. 0: `cg_tolerance`
  /// alone.
  double step_tolerance = 0;
  Trust trust = Trust::blind;
  Equation equation = Equation::regular;
  int n_mixed = 0; ///< corrections before that are mixed into one, see mixing.h; asks for a line search
  std::vector<std::uint32_t> piece = {}; ///< of each corner, 0, 1, ...: each is tested by itself; empty: all are one
};

/// What is to be solved. `start` obeys the supports already; velocity and acceleration are those at `start`.
struct Balance {
  double time = 0;            ///< at which loads act [s]
  double mass_factor = 0;     ///< kappa [1/s^2]
  double velocity_factor = 0; ///< omega [1/s]
  Loan<Vec3> start;
  Loan<Vec3> velocity = Loan<Vec3>::none();     ///< empty: zero
  Loan<Vec3> acceleration = Loan<Vec3>::none(); ///< empty: zero
  Loan<Vec3> guess = Loan<Vec3>::none();        ///< first guess of x - start [m]; empty: zero
  bool guess_is_free_motion = false;            ///< of which nothing accelerates
  Loan<Vec3> offset = Loan<Vec3>::none();       ///< a force on each corner [N]; empty: none
  FreeMotions free = {};                        ///< that A does not resist
};

struct NewtonReport {
  int n_newton = 0, n_linear = 0;
  double residual = 0;      ///< at the last iterate that was tested, see NewtonOptions::tolerance [1]
  bool converged = true;    ///< always without a tolerance
  std::string failure = {}; ///< why not
};

class BalanceSolver {
 public:
  /// The model must outlive it. Throws ParameterError when a direct solver is asked for and the model is no
  /// StiffnessMatrix.
  BalanceSolver(ElasticModel& model, const NewtonOptions& options);

  /// Solves for x; on failure to converge says so in the report and leaves the last iterate. Throws NumericalError for
  /// forces that are not finite, and for linear equations that cannot be solved to tolerance.
  NewtonReport solve(const Loads& loads, const Constraints& constraints, Balance balance, Points& x);

 private:
  /// What stays the same during a solution.
  struct Problem {
    const Loads& loads;
    const Constraints& constraints;
    const Balance& balance;
    std::span<const double> mass;
    const MassCoupling* coupling;         ///< null where the mass is lumped
    double mass_factor, stiffness_factor; ///< of M and K in A

    static Vec3 of_corner(const Points& values, const std::size_t i) {
      return values.empty() ? Vec3(Vec3::Zero()) : values[i];
    }
    Vec3 offset(const std::size_t i) const { return of_corner(balance.offset, i); }
    Vec3 velocity_at_start(const std::size_t i) const { return of_corner(balance.velocity, i); }
    Vec3 acceleration_at_start(const std::size_t i) const { return of_corner(balance.acceleration, i); }
    /// Of a corner, with all at x.
    Vec3 velocity(const Points& x, const std::size_t i) const {
      return velocity_at_start(i) + balance.velocity_factor * (x[i] - balance.start[i]);
    }
    Vec3 acceleration(const Points& x, const std::size_t i) const {
      return acceleration_at_start(i) + balance.mass_factor * (x[i] - balance.start[i]);
    }
    /// a + alpha v, which M resists.
    Vec3 resisted(const Points& x, const std::size_t i) const {
      return acceleration(x, i) + loads.mass_damping * velocity(x, i);
    }
  };
  /// Of mass times acceleration in the motion that is guessed, by which forces are measured beside others: that of the
  /// start would grow with the velocity of a body in flight, and with shorter steps.
  struct InertiaSquares {
    double scaled = 0; ///< in the measure of residuals
    double plain = 0;  ///< [N^2]
  };
  InertiaSquares inertia_of_guess(const Problem& problem) const;
  /// Of a first correction: taken, gone on from with a line search, or thrown away for a start with one.
  enum class Verdict { taken, goes_on, refused };
  /// What a trial does to the incremental potential along the correction.
  struct Change {
    double potential, size; ///< and what it is the difference of [J]
    double slope;           ///< at the trial, by the length [J]
  };

  /// Linearises at x; returns the scale of what balances there, in the scaled norm.
  double linearise_at(const Problem& problem, const Points& x);
  /// What loads resist at x, and what damping there is; the linearisation stays.
  void move_to(const Problem& problem, const Points& x);
  void factorise(const Problem& problem);
  static Loan<Vec3> velocities(const Problem& problem, const Points& x);
  /// beta K v of a corner [N].
  Vec3 damping(const Problem& problem, std::size_t i) const;
  /// What the masses of different corners resist together; nothing where the mass is lumped.
  Loan<Vec3> coupled_inertia(const Problem& problem, const Points& x) const;
  /// What is out of balance at x, by the linearisation at hand; returns the scale of what balances, in the scaled norm.
  double assemble_residual(const Problem& problem, const Points& x);
  double round_off_of_forces(const Points& x) const;
  /// The same in the scaled norm.
  double scaled_round_off_at(const Points& x) const;
  /// y = A p among the free directions, for p among them.
  void apply(const Problem& problem, std::span<const double> p, std::span<double> y);
  /// Tests the first correction where it ends, and moves there.
  Verdict judge(const Problem& problem, const Points& end);
  /// Whether the power of what is out of balance along d has fallen enough in every piece.
  bool slopes_little(const Points& d, const std::vector<double>& at_start, double scale) const;
  /// Work that may be left out of balance at x in each piece: the energy that the integrator itself takes, from the
  /// stiffness at its start, and what the linear solver does not see [J].
  Loan<double> most_work(const Problem& problem, const Points& x);
  /// Whether what is out of balance at x does less work than that in every piece.
  bool works_little(const Problem& problem, const Points& x, double scale) const;
  double square_of_scaled_residual() const;
  /// 1 for each piece in which more is out of balance than the linear solver is asked for.
  Loan<std::uint8_t> seen(double scale) const;
  /// That it may leave by the step's own error, in the energy norm; 0: unknown.
  double error_of_cg() const;
  bool turns_little(const Problem& problem, const Points& x) const;
  /// 1 for each piece that nothing holds and nothing but gravity acts on.
  Loan<std::uint8_t> flying(const Problem& problem) const;
  /// Values a corner, without their mean over pieces that fly, as anything follows that.
  Loan<Vec3> unlike_flight(const Problem& problem, Loan<Vec3> values) const;
  /// Squares of the ways from free motion to where the correction leads, in the energy norm.
  Loan<double> ways_from_free_motion(const Problem& problem);
  /// Whether what is left to correct is small beside the way from free motion, in every piece.
  bool is_small();
  /// Returns the iterations of the linear solver.
  int correct(const Problem& problem, const Points& x, Loan<Vec3> guess, double scale);
  int correct_by_cg(const Problem& problem, Loan<Vec3> guess, double scale);
  /// `unsolved`: what conjugate gradients left of the residual.
  void put_elastic(const Problem& problem, Loan<Vec3> unsolved);
  /// z = S^T S r.
  void apply_inverse_blocks(const Problem& problem, std::span<const double> r, std::span<double> z) const;
  /// A corner's force in the measure of residuals.
  Vec3 scaled(const std::size_t corner, const Vec3& force) const { return scaling_[corner].cast<double>() * force; }
  Vec3 by_inverse_block(const Problem& problem, std::size_t corner, const Vec3& force) const;
  /// The model's, for A; null: none.
  Preconditioner* preconditioner(const Problem& problem);
  /// The displacement of a corner with which nothing accelerates.
  static Vec3 free_motion(const Problem& problem, std::size_t i);
  /// d.Ad - 2 r.d of that; Ad is written.
  double potential_of_free_motion(const Problem& problem, std::span<double> Ad);
  /// Of the way from there to the correction, in the energy norm, what the masses say: most of it in a motion that
  /// steps resolve.
  double inertia_of_way(const Problem& problem) const;
  void correct_directly(const Problem& problem, const Points& x, Tangent kind);
  /// Mixes the correction with those before, where that leads downhill and far; returns how much of it to take.
  double mixed_search(const Problem& problem, const Points& x, Mixing& mixing);
  /// How much of the correction to take; 0 when nothing of it helps.
  double search(const Problem& problem, const Points& x);
  Change change(const Problem& problem, const Points& x, const Points& trial, double length,
                const Points& damped) const;
  /// Forces of loads without a potential times the correction at x, and at the trial.
  std::array<double, 2> without_potential(const Problem& problem, const Points& x, const Points& trial,
                                          double length) const;

  ElasticModel& model_;
  const StiffnessMatrix* matrix_; // null: the model offers none
  NewtonOptions options_;
  Points damping_; // where the residual is; empty: none
  Points residual_, correction_;
  double balanced_forces_ = 0;  // their norm, where a tolerance asks for it [N]
  std::optional<InertiaSquares> inertia_; // of the step; none before its first linearisation
  double scaled_round_off_ = 0; // where the residual is
  LoadTangent tangent_;
  std::vector<double> size_;  // of A's diagonal blocks: their traces [N/m]
  std::vector<Eigen::Matrix3f>
    scaling_; // L^-1 of them from the free directions' basis, a row of zeros for each that is held; single is enough
  std::vector<double> load_product_, mass_product_;
  double way_ = 0; // from free motion to the first iterate, in the energy norm; 0: unknown
  Pieces pieces_;
  std::vector<std::uint8_t> flies_;  // each piece
  std::vector<double> elastic_;      // d.Kd of the correction d in each piece [J]; empty: unknown
  std::vector<double> most_work_;    // of what is out of balance in each piece, in the step at hand [J]
  std::vector<double> squared_ways_; // from free motion, of each piece, in the energy norm
};

} // namespace kerf::dynamics
