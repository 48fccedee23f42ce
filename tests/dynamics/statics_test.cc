/// Newton's method and statics: equilibria in closed form, quadratic convergence, falling energy, snap-through, free
/// rigid motions by name.

#include "base/error.h"
#include "dynamics/direct.h"
#include "dynamics/forces.h"
#include "dynamics/handle.h"
#include "dynamics/quantities.h"
#include "dynamics/quasi_static.h"
#include "dynamics/rigid_modes.h"
#include "dynamics/surface_load.h"
#include "tests/dynamics/chain.h"
#include "tests/dynamics/integrators.h"
#include "tests/dynamics/truss.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace kerf::dynamics::statics_test {
namespace {

Vec3 still(double) { return Vec3::Zero(); }

Support clamp(const Points& rest, const std::vector<std::uint32_t>& corners, const Mat3& held = Mat3::Identity()) {
  Support support{corners, {}, still, {}, held};
  for (const auto c : corners)
    support.rest.push_back(rest[c]);
  return support;
}

QuasiStaticOptions by(const LinearSolver solver, const Tangent tangent) {
  QuasiStaticOptions options;
  options.newton.solver = solver;
  options.newton.tangent = tangent;
  options.newton.tolerance = 1e-10;
  options.newton.cg_tolerance = 1e-12;
  return options;
}

/// A flat truss that can only rise out of its plane: two bars of span 2 a and a load P in the middle.
struct Roof {
  Truss truss{{Vec3(-1, 0, 0), Vec3(0, 0, 0.2), Vec3(1, 0, 0)}, {{0, 1}, {1, 2}}, 1000};
  Loads loads;

  explicit Roof(const double force) {
    loads.gravity = Vec3(0, 0, -force); // of masses 1
    loads.supports = {clamp(truss.rest(), {0, 2}), clamp(truss.rest(), {1}, held_axes("xy"))};
  }
  /// Force that holds it at a height.
  static double balance(const double z) {
    const double L = std::hypot(1, 0.2), l = std::hypot(1, z);
    return 2 * 1000 * (L - l) * z / l;
  }
};

TEST(QuasiStatic, FindsTheEquilibriumOfATruss) {
  for (const auto& [solver, tangent] :
       {std::pair{LinearSolver::conjugate_gradients, Tangent::positive},
        std::pair{LinearSolver::direct, Tangent::positive}, std::pair{LinearSolver::direct, Tangent::exact}}) {
    Roof roof(Roof::balance(0.17));
    State state = roof.truss.state();
    const StepReport report = QuasiStatic(roof.truss, by(solver, tangent)).step(state, roof.loads, 1);
    EXPECT_NEAR(state.x[1][2], 0.17, 1e-9);
    EXPECT_EQ(state.v[1], Vec3::Zero());
    EXPECT_EQ(state.time, 1);
    EXPECT_LE(report.residual, 1e-10);
    EXPECT_EQ(report.n_substeps, 1);
    EXPECT_GT(report.n_newton, 1);
  }
}

/// Beyond the limit load it snaps to where the bars are drawn: past a saddle of the energy, to the other side.
TEST(QuasiStatic, SnapsThrough) {
  for (const Tangent tangent : {Tangent::positive, Tangent::exact}) {
    Roof roof(Roof::balance(-0.35)); // well above the limit, about 3 N
    State state = roof.truss.state();
    QuasiStatic(roof.truss, by(LinearSolver::direct, tangent)).step(state, roof.loads, 1);
    EXPECT_NEAR(state.x[1][2], -0.35, 1e-8);
  }
}

/// Corrections halve the digits left with the exact tangent, and do not with the positive one.
TEST(Newton, IsQuadraticWithTheExactTangent) {
  const auto residuals = [](const Tangent tangent) {
    std::vector<double> found;
    for (int n = 1; n <= 7; ++n) {
      Roof roof(Roof::balance(0.15));
      BalanceSolver solver(
        roof.truss, {.max_iterations = n, .tolerance = 1e-14, .solver = LinearSolver::direct, .tangent = tangent});
      const Points zero(3, Vec3::Zero());
      Points x;
      found.push_back(solver
                        .solve(roof.loads, Constraints(roof.loads, 3),
                               {.start = roof.truss.rest(), .velocity = zero, .acceleration = zero}, x)
                        .residual);
    }
    return found;
  };
  const auto exact = residuals(Tangent::exact), positive = residuals(Tangent::positive);
  int n_quadratic = 0;
  for (std::size_t i = 1; i < exact.size(); ++i)
    if (exact[i - 1] < 1e-3 && exact[i] > 1e-13) {
      EXPECT_GT(std::log(exact[i]) / std::log(exact[i - 1]), 1.7) << exact[i - 1] << " " << exact[i];
      ++n_quadratic;
    }
  EXPECT_GE(n_quadratic, 2);
  EXPECT_GT(positive[5], 1e3 * exact[5]);
}

/// The incremental potential of one long step of implicit Euler after 1, 2, ... Newton iterations.
TEST(Newton, LineSearchLowersTheEnergyAtEveryIteration) {
  const double dt = 0.5;
  const auto potential_after = [&](const int n, const LineSearch line_search) {
    Truss truss({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(1, 0.1, 0.8)},
                {{0, 1}, {1, 2}, {0, 3}, {1, 3}, {2, 3}}, 5000);
    Loads loads{.gravity = Vec3(0, 0, -9.81), .mass_damping = 0.3, .supports = {}};
    loads.supports = {clamp(truss.rest(), {0})};
    const State state = [&] {
      State s = truss.state();
      s.v = {Vec3::Zero(), Vec3(3, -8, 2), Vec3(-9, 1, 4), Vec3(1, 7, -12)};
      return s;
    }();
    BalanceSolver solver(truss, {.max_iterations = n, .line_search = line_search, .cg_tolerance = 1e-12});
    Balance balance{.time = dt,
                    .mass_factor = 1 / (dt * dt),
                    .velocity_factor = 1 / dt,
                    .start = state.x,
                    .velocity = Points(4, Vec3::Zero()),
                    .acceleration = state.v};
    for (Vec3& a : balance.acceleration)
      a /= -dt;
    Points x;
    solver.solve(loads, Constraints(loads, 4), std::move(balance), x);
    double sum = truss.energy(x) + gravity_energy(truss, loads, x);
    for (int i = 0; i < 4; ++i)
      sum += 0.5 / (dt * dt) * (x[i] - state.x[i] - dt * state.v[i]).squaredNorm() +
             0.5 * 0.3 / dt * (x[i] - state.x[i]).squaredNorm();
    return sum;
  };
  double before = 1e300;
  bool always_fell = true;
  for (int n = 1; n <= 25; ++n) {
    const double now = potential_after(n, LineSearch::backtracking);
    EXPECT_LE(now, before + 1e-10 * std::abs(before)) << n;
    before = now;
  }
  for (int n = 2; n <= 25; ++n)
    always_fell = always_fell && potential_after(n, LineSearch::none) <= potential_after(n - 1, LineSearch::none);
  EXPECT_FALSE(always_fell); // else this case shows nothing
}

/// A step that does not converge at once is divided: a hanging rope whose end is carried to the other side.
TEST(QuasiStatic, DividesTheLoadWhenItMust) {
  Points rest;
  std::vector<Truss::Bar> bars;
  constexpr std::uint32_t n = 8;
  for (std::uint32_t i = 0; i <= n; ++i)
    rest.emplace_back(i, 0, 0);
  for (std::uint32_t i = 0; i < n; ++i)
    bars.push_back({i, i + 1});
  Truss rope(rest, bars, 3000);
  Loads loads{.gravity = Vec3(0, 0, -9.81), .supports = {}};
  loads.supports = {clamp(rest, {0}), clamp(rest, {n})};
  loads.supports[1].displacement = [](const double t) { return t > 1.5 ? Vec3(-12, 3, 2) : Vec3(0.2, 0, 0); };
  QuasiStaticOptions options = by(LinearSolver::direct, Tangent::positive);
  options.newton.max_iterations = 1000;
  options.free_modes = FreeModes::allow; // it may swing about its ends: gravity resists that
  State state = rope.state();
  for (Vec3& x : state.x)
    x *= 1.025; // slack bars resist nothing across
  QuasiStatic(rope, options).step(state, loads, 1);
  options.newton.max_iterations = 12;
  options.newton.tangent = Tangent::exact;
  const StepReport report = QuasiStatic(rope, options).step(state, loads, 1);
  EXPECT_GT(report.n_substeps, 1);
  EXPECT_GT(report.n_rejected, 0);
  EXPECT_LT((state.x[n] - Vec3(-4, 3, 2)).norm(), 1e-12);
  Points force;
  rope.force(state.x, force);
  for (std::uint32_t i = 1; i < n; ++i)
    EXPECT_LT((force[i] + loads.gravity).norm(), 1e-6);
}

/// A chain stretched by its ends has no force left over but at the ends.
TEST(QuasiStatic, MovedSupportsStretch) {
  Chain model(std::vector<double>(9, 1.0), {.neighbour = 40});
  Loads loads;
  loads.supports = {clamp(model.rest(), {0}), clamp(model.rest(), {8}), clamp(model.rest(), {4}, held_axes("y"))};
  loads.supports[1].displacement = [](const double t) { return Vec3(0.8 * t, 0, 0.4 * t); };
  State state = model.state();
  QuasiStatic(model, by(LinearSolver::conjugate_gradients, Tangent::positive)).step(state, loads, 1);
  for (int i = 0; i < 9; ++i)
    EXPECT_LT((state.x[i] - model.rest()[i] - i / 8.0 * Vec3(0.8, 0, 0.4)).norm(), 1e-9);
  const auto found = reactions(model, loads, state, Points(9, Vec3::Zero()), Vec3::Zero());
  EXPECT_LT((found[0].force + found[1].force).norm(), 1e-9); // equal and opposite
  EXPECT_LT((found[1].force - 40 * Vec3(0.1, 0, 0.05)).norm(), 1e-9);
}

/// Pressure on a free triangle held by three handles: an unsymmetric tangent, and the direct solver copes.
TEST(QuasiStatic, FollowerPressureOnHandles) {
  Truss truss({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {{0, 1}, {1, 2}, {0, 2}}, 300);
  Loads loads;
  for (std::uint32_t i = 0; i < 3; ++i) {
    Interpolation point;
    const double one = 1;
    point.add_row({&i, 1}, {&one, 1});
    loads.acting.push_back(
      std::make_unique<HandleSpring>(point, i == 0 ? 40 : 90, [X = truss.rest()[i]](double) { return X; }));
  }
  loads.acting.push_back(std::make_unique<Pressure>(SurfacePatch{corners_themselves(3), truss.rest(), {{0, 1, 2}}},
                                                    [](const Vec3&, double) { return 60.0; }));
  Points ends[3];
  int k = 0;
  for (const auto& [solver, tangent] :
       {std::pair{LinearSolver::conjugate_gradients, Tangent::positive},
        std::pair{LinearSolver::direct, Tangent::positive}, std::pair{LinearSolver::direct, Tangent::exact}}) {
    State state = truss.state();
    QuasiStatic(truss, by(solver, tangent)).step(state, loads, 1);
    EXPECT_LT(external_force(truss, loads, state).norm(), 1e-7);
    EXPECT_GT((state.x[0] - truss.rest()[0]).norm(), 0.1);
    ends[k++] = state.x;
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT((ends[0][i] - ends[1][i]).norm(), 1e-7);
    EXPECT_LT((ends[0][i] - ends[2][i]).norm(), 1e-7);
  }
}

std::set<std::string> names(const std::vector<FreeMode>& modes) {
  std::set<std::string> all;
  for (const FreeMode& mode : modes)
    all.insert(mode.name);
  return all;
}

const std::set<std::string> all_six = {"translation along x", "translation along y", "translation along z",
                                       "rotation about x",    "rotation about y",    "rotation about z"};

/// Six points around a centre, in general position.
Truss cloud() {
  return Truss({Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)}, {}, 1);
}

TEST(RigidModes, AreNamed) {
  const Truss body = cloud();
  const auto free = [&](const Loads& loads) { return names(free_rigid_modes(body, loads, 0, body.rest(), {})); };
  EXPECT_EQ(free({}), all_six);
  Loads loads;
  loads.supports = {clamp(body.rest(), {0, 2, 4})};
  EXPECT_EQ(free(loads), std::set<std::string>());
  loads.supports = {clamp(body.rest(), {0, 1})}; // a hinge through the centre
  EXPECT_EQ(free(loads), std::set<std::string>({"rotation about x"}));
  loads.supports = {clamp(body.rest(), {0, 1, 2, 3, 4, 5}, held_axes("z"))}; // sliding on a plane
  EXPECT_EQ(free(loads), std::set<std::string>({"translation along x", "translation along y", "rotation about z"}));
  loads.supports = {clamp(body.rest(), {2, 4})}; // a hinge beside the centre
  EXPECT_EQ(free(loads), std::set<std::string>({"rotation about the axis (0, 0.7071, -0.7071) through (0, 0.5, 0.5)"}));
  loads.supports = {clamp(body.rest(), {0})}; // a ball joint: three rotations about it
  EXPECT_EQ(free(loads).size(), 3u);
}

TEST(RigidModes, LoadsThatResistCount) {
  const Truss body = cloud();
  Loads loads;
  loads.supports = {clamp(body.rest(), {0, 1})};
  Interpolation point;
  const std::uint32_t corner = 2;
  const double one = 1;
  point.add_row({&corner, 1}, {&one, 1});
  loads.acting.push_back(std::make_unique<HandleSpring>(point, 3, still));
  EXPECT_TRUE(free_rigid_modes(body, loads, 0, body.rest(), {}).empty());
}

TEST(RigidModes, ArePerPiece) {
  const Truss one = cloud();
  Points rest = one.rest();
  for (const Vec3& x : one.rest())
    rest.push_back(x + Vec3(5, 0, 0));
  const Truss two(rest, {}, 1);
  Loads loads;
  loads.supports = {clamp(rest, {0, 2, 4})}; // the first one
  std::vector<std::uint32_t> piece(6, 0);
  piece.resize(12, 1);
  const auto modes = free_rigid_modes(two, loads, 0, rest, piece);
  EXPECT_EQ(names(modes), all_six);
  for (const FreeMode& mode : modes)
    EXPECT_EQ(mode.piece, 1u);
  EXPECT_TRUE(free_rigid_modes(two, loads, 0, rest, {}).empty()); // as one body it would be held
}

/// A straight row does not turn about itself.
TEST(RigidModes, OfARowAreFive) {
  Chain row({1, 2, 1}, {});
  const auto modes = free_rigid_modes(row, {}, 0, row.rest(), {});
  std::set<std::string> expected = all_six;
  expected.erase("rotation about x");
  EXPECT_EQ(names(modes), expected);
}

TEST(QuasiStatic, RefusesABodyThatIsFreeByName) {
  Truss body = cloud();
  State state = body.state();
  Loads loads{.gravity = Vec3(0, 0, -1), .supports = {}};
  loads.supports = {clamp(body.rest(), {0, 1})};
  try {
    QuasiStatic(body, {}).step(state, loads, 1);
    FAIL() << "found an equilibrium";
  } catch (const ParameterError& error) {
    EXPECT_NE(error.complaint().rule.find("rotation about x"), std::string::npos) << error.what();
    EXPECT_EQ(error.complaint().rule.find("translation"), std::string::npos) << error.what();
  }
}

TEST(QuasiStatic, SaysThatThereIsNoEquilibrium) {
  Truss pair({Vec3(0, 0, 0), Vec3(1, 0, 0)}, {{0, 1}}, 10);
  Loads loads;
  loads.supports = {clamp(pair.rest(), {0}), clamp(pair.rest(), {1}, held_axes("yz"))};
  loads.acting.push_back(std::make_unique<Pressure>( // pulls ever harder, the further it goes
    SurfacePatch{corners_themselves(2), pair.rest(), {}}, [](const Vec3&, double) { return 0.0; }));
  struct Runaway : Load {
    Nature nature() const override { return Nature::driving; }
    double energy(double, const Points&) const override { return 0; }
    void add_force(const Moment& moment, Points& forces) const override {
      forces[1] += Vec3(5 + 20 * moment.x[1][0], 0, 0);
    }
    void add_tangent(Tangent, const Moment&, double, LoadTangent&) const override {}
  };
  loads.acting.push_back(std::make_unique<Runaway>());
  State state = pair.state();
  const State before = state;
  EXPECT_THROW(QuasiStatic(pair, {}).step(state, loads, 1), NumericalError);
  EXPECT_EQ(state.x, before.x);
  EXPECT_EQ(state.time, before.time);
}

TEST(Direct, NeedsAModelThatOffersIt) {
  Chain model({1}, {.anchor = 1});
  EXPECT_THROW(BalanceSolver(model, {.solver = LinearSolver::direct}), ParameterError);
}

TEST(Direct, SaysThatAMatrixIsSingular) {
  Truss truss({Vec3(0, 0, 0), Vec3(1, 0, 0)}, {{0, 1}}, 10);
  const Loads none;
  Points d;
  EXPECT_THROW(solve_directly(truss.stiffness_matrix(truss.rest(), Tangent::positive), Constraints(none, 2),
                              {Vec3(0, 0, 1), Vec3(0, 0, 0)}, d),
               NumericalError);
}

/// Both solvers take the same step, with a support along no axis.
TEST(Direct, AgreesWithConjugateGradients) {
  Points x[2];
  for (const int k : {0, 1}) {
    Truss truss({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, 1, 0), Vec3(0.5, 0.3, 1)},
                {{0, 1}, {0, 2}, {1, 2}, {0, 3}, {1, 3}, {2, 3}}, 2000);
    Loads loads{.gravity = Vec3(1, 2, -9), .mass_damping = 0.1, .supports = {}};
    loads.supports = {clamp(truss.rest(), {0}), clamp(truss.rest(), {1}, held_along(Vec3(1, 2, 3)))};
    ImplicitEuler stepper(
      truss, {.cg_tolerance = 1e-13, .solver = k == 0 ? LinearSolver::direct : LinearSolver::conjugate_gradients});
    State state = truss.state();
    for (int i = 0; i < 5; ++i)
      stepper.step(state, loads, 0.02);
    x[k] = state.x;
  }
  for (int i = 0; i < 4; ++i)
    EXPECT_LT((x[0][i] - x[1][i]).norm(), 1e-11);
}

template <class P>
std::string broken_rule(const std::string& key, const std::string& value) {
  P parameters;
  Parameters list;
  parameters.describe(list);
  for (const Parameter& parameter : list.list())
    if (parameter.name == key)
      return parameter.check(value);
  return "no such key";
}

TEST(Integrators, HaveKeysWithRules) {
  EXPECT_EQ(broken_rule<NewmarkParameters>("Gamma [1]", "0.4"), "must be >= 0.5");
  EXPECT_EQ(broken_rule<NewmarkParameters>("Beta [1]", "0"), "must be > 0");
  EXPECT_EQ(broken_rule<GeneralisedAlphaParameters>("Spectral radius [1]", "1.5"), "must be >= 0 and <= 1");
  EXPECT_EQ(broken_rule<NewtonParameters>("Newton iterations [1]", "0"), "must be a whole number >= 1");
  EXPECT_EQ(broken_rule<QuasiStaticParameters>("Newton tolerance [1]", "0"), "must be > 0");
  EXPECT_EQ(broken_rule<ExplicitParameters>("Beyond the stable step", "maybe"), "must be one of refuse, go on");
  EXPECT_EQ(broken_rule<NewtonParameters>("Solver", "direct"), "");
  NewtonParameters chosen;
  Parameters list;
  chosen.describe(list);
  for (const Parameter& parameter : list.list())
    if (parameter.name == "Line search") {
      EXPECT_EQ(parameter.assign("yes"), "");
    }
  EXPECT_EQ(chosen.options().line_search, LineSearch::backtracking);
}

} // namespace
} // namespace kerf::dynamics::statics_test
