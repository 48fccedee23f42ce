/// Steps that are watched: gains of energy, where they show, and what linear solves may leave.

#include "dynamics/sound_steps.h"

#include "base/error.h"
#include "dynamics/conjugate_gradients.h"
#include "dynamics/explicit_steppers.h"
#include "dynamics/forces.h"
#include "dynamics/implicit_euler.h"
#include "dynamics/mixing.h"
#include "dynamics/piece_gains.h"
#include "tests/dynamics/chain.h"
#include "tests/dynamics/truss.h"

#include <gtest/gtest.h>
#include <Eigen/Dense>
#include <Eigen/Geometry>

#include <cmath>
#include <random>

namespace kerf::dynamics::sound_steps_test {
namespace {

constexpr ExplicitOptions go_on{BeyondStable::go_on};

double energy(const ForceModel& model, const State& state) {
  return model.energy(state.x) + kinetic_energy(model, state.v);
}

/// Explicit Euler multiplies a vibration's energy by 1 + (w dt)^2 a step: divided by n, by (1 + (w dt / n)^2)^n.
TEST(SoundSteps, DivideAStepThatGainsEnergy) {
  Chain model({1, 1, 1}, {.anchor = 100});
  SoundSteps stepper(model, Pieces(), std::make_unique<ExplicitEuler>(model, go_on), {});
  State state = model.state();
  state.x[1] += Vec3(0.1, 0, 0);
  const double before = energy(model, state), square = 100 * 0.2 * 0.2;
  const StepReport report = stepper.step(state, {}, 0.2);
  const double n = report.n_substeps;
  EXPECT_GT(n, 1);
  EXPECT_EQ(report.n_rejected, std::log2(n));
  EXPECT_NEAR(energy(model, state) / before, std::pow(1 + square / (n * n), n), 1e-9);
  EXPECT_NEAR(state.time, 0.2, 1e-15);
}

/// A cut, for which integrators are made again, or contact makes a body stiffer than its steps bear.
TEST(SoundSteps, DivideAStepThatHasBecomeTooLong) {
  Chain soft({1, 1, 1}, {.anchor = 100}), stiff({1, 1, 1}, {.anchor = 900});
  const auto sound = [](Chain& model) {
    return SoundSteps(model, Pieces(), std::make_unique<VelocityVerlet>(model, ExplicitOptions{}), {});
  };
  constexpr double dt = 0.16; // stable up to .2, then up to .067
  State state = soft.state();
  state.x[1] += Vec3(0.1, 0, 0);
  EXPECT_EQ(sound(soft).step(state, {}, dt).n_substeps, 0);
  State anew = soft.state();
  EXPECT_THROW(sound(stiff).step(anew, {}, dt), ParameterError) << "from the start";
  SoundSteps stepper = sound(stiff);
  const double before = energy(stiff, state);
  for (int i = 0; i < 500; ++i) {
    ASSERT_EQ(stepper.step(state, {}, dt).n_substeps, 4);
    ASSERT_LT(std::abs(energy(stiff, state) / before - 1), 0.5) << i; // 1 / (1 - .6^2) at most
  }
}

/// Masses 0 and 1, and 2 and 3, joined by springs.
class TwoPairs : public Chain, public PieceEnergies {
 public:
  TwoPairs() : Chain({1, 1, 1, 1}, {}) {}

  double energy(const Points& x) const override { return of_pair(x, 0) + of_pair(x, 2); }
  Loan<double> energies(const Points& x, const Pieces& pieces) const override {
    Loan<double> sums(pieces.n(), 0);
    for (const std::size_t i : {0, 2})
      sums[pieces.of(i)] += of_pair(x, i);
    return sums;
  }
  void force(const Points& x, Points& forces) const override {
    forces.assign(x.size(), Vec3::Zero());
    for (const std::size_t i : {0, 2}) {
      forces[i] = 100 * stretch(x, i);
      forces[i + 1] = -100 * stretch(x, i);
    }
  }

 private:
  Vec3 stretch(const Points& x, const std::size_t i) const { return x[i + 1] - x[i] - (rest()[i + 1] - rest()[i]); }
  double of_pair(const Points& x, const std::size_t i) const { return 50 * stretch(x, i).squaredNorm(); }
};

const Pieces two_pairs({0, 0, 1, 1});

/// Gains 25 % of what vibrates in a step, which drowns where two fly apart, unless each one's mean motion is left out.
TEST(SoundSteps, DivideAStepOfOneOfTwoPiecesThatFlyApart) {
  const auto substeps = [](const Pieces& pieces) {
    TwoPairs pairs;
    SoundSteps stepper(pairs, pieces, std::make_unique<ExplicitEuler>(pairs, go_on), {.most_gain = 0.05});
    State state = pairs.state();
    state.x[3] += Vec3(0.01, 0, 0);
    state.v = {Vec3(0, 5, 0), Vec3(0, 5, 0), Vec3(0, -5, 0), Vec3(0, -5, 0)};
    return stepper.step(state, {}, 0.05).n_substeps;
  };
  EXPECT_EQ(substeps(Pieces()), 0);
  EXPECT_GE(substeps(two_pairs), 4);
}

/// A small piece draws out by itself, beside a large one that is as taut as before.
TEST(SoundSteps, RefuseWhatASmallPieceGains) {
  class DrawsOut : public Stepper {
   public:
    StepReport step(State& state, const Loads&, const double dt) override {
      state.x[3] += Vec3(0.01, 0, 0);
      state.time += dt;
      return {};
    }
  };
  const auto step = [](const Pieces& pieces, const bool each_piece, const Loads& loads) {
    TwoPairs pairs;
    SoundSteps stepper(pairs, pieces, std::make_unique<DrawsOut>(),
                       {.most_substeps = 1, .most_gain = 0.05, .each_piece = each_piece});
    State state = pairs.state();
    state.x[1] += Vec3(0.2, 0, 0);
    state.x[3] += Vec3(0.01, 0, 0);
    stepper.step(state, loads, 0.01);
  };
  EXPECT_NO_THROW(step(two_pairs, false, {}));
  EXPECT_NO_THROW(step(Pieces(), true, {}));
  try {
    step(two_pairs, true, {});
    FAIL() << "four times the energy of a piece passed";
  } catch (const StepError& error) {
    EXPECT_GE(error.particle(), 2u);
  }
  Loads held{.supports = {}}; // what supports do to a piece is not known
  held.supports = {{{2}, {Vec3(0.2, 0, 0)}, [](double) { return Vec3(Vec3::Zero()); }}};
  EXPECT_NO_THROW(step(two_pairs, true, held));
}

TEST(SoundSteps, SayWhereAStepCannotBeMended) {
  Chain model({1, 1, 1}, {.anchor = 100});
  SoundSteps stepper(model, Pieces(), std::make_unique<ExplicitEuler>(model, go_on), {.most_substeps = 1});
  State state = model.state();
  state.x[1] += Vec3(0.1, 0, 0);
  const State before = state;
  try {
    stepper.step(state, {}, 0.2);
    FAIL() << "a step of 16 times the energy passed";
  } catch (const StepError& error) {
    EXPECT_EQ(error.particle(), 1u);
    EXPECT_NE(std::string(error.what()).find("gained"), std::string::npos) << error.what();
  }
  EXPECT_EQ(state.x, before.x);
  EXPECT_EQ(state.time, before.time);
}

/// Each step gains less than anyone would mind; together they do.
TEST(SoundSteps, RefuseAMotionThatGrowsStepByStep) {
  Chain model({1, 1}, {.anchor = 100});
  SoundSteps stepper(model, Pieces(), std::make_unique<ExplicitEuler>(model, go_on), {.most_substeps = 1});
  State state = model.state();
  state.x[0] += Vec3(0.1, 0, 0);
  state.x[1] -= Vec3(0.1, 0, 0);
  const double before = energy(model, state);
  EXPECT_THROW(for (int i = 0; i < 3000; ++i) stepper.step(state, {}, 0.005);, StepError);
  EXPECT_LT(energy(model, state), 2.5 * before); // else it grows to 1e3 times and more
  EXPECT_GT(energy(model, state), 1.5 * before);
}

/// What cannot be mended is taken by another integrator, from which the next step starts anew.
TEST(SoundSteps, HandAStepThatNothingMendsToTheLastResort) {
  Chain model({1, 1, 1}, {.anchor = 100});
  SoundSteps stepper(model, Pieces(), std::make_unique<ExplicitEuler>(model, go_on), {.most_substeps = 1},
                     std::make_unique<ImplicitEuler>(model, ImplicitEulerOptions{.cg_tolerance = 1e-12}));
  State state = model.state();
  state.x[1] += Vec3(0.1, 0, 0);
  state.history["acceleration"] = Points(3, Vec3::Ones());
  const double before = energy(model, state), square = 100 * 0.2 * 0.2;
  const StepReport report = stepper.step(state, {}, 0.2);
  EXPECT_EQ(report.n_rejected, 1);
  EXPECT_NEAR(energy(model, state) / before, 1 / (1 + square), 1e-9);
  EXPECT_TRUE(state.history.empty());
  EXPECT_NEAR(state.time, 0.2, 1e-15);
}

/// Gravity, moving supports and dampers give and take: none of it passes for a gain.
TEST(SoundSteps, LetWorkPass) {
  for (const double dt : {1e-3, 0.01, 0.1}) {
    Chain model({1, 2, 1}, {.neighbour = 100});
    SoundSteps stepper(model, Pieces(), std::make_unique<ImplicitEuler>(model, ImplicitEulerOptions{.cg_tolerance = 1e-12}),
                       {.most_substeps = 1});
    Loads loads{.gravity = Vec3(0, 0, -9.81), .mass_damping = 0.2, .stiffness_damping = 0.01, .supports = {}};
    loads.supports = {{{0}, {model.rest()[0]}, [](const double t) { return Vec3(std::sin(20 * t), t * t, t); }}};
    State state = model.state();
    for (int i = 0; i < 300; ++i)
      ASSERT_NO_THROW(stepper.step(state, loads, dt)) << "dt " << dt << ", step " << i;
  }
}

/// Of 4 % a step gains in two substeps 2 %, in four 1 %: what is wanted decides how many are taken; where it cannot be
/// had, what gains least.
TEST(SoundSteps, DivideAStepThatGainsMoreThanWanted) {
  const auto substeps = [](const double wanted) {
    Chain model({1, 1}, {.anchor = 100});
    SoundSteps stepper(model, Pieces(), std::make_unique<ExplicitEuler>(model, go_on), {.wanted_gain = wanted});
    State state = model.state();
    state.x[0] += Vec3(0.1, 0, 0);
    state.x[1] -= Vec3(0.1, 0, 0);
    return stepper.step(state, {}, 0.02).n_substeps;
  };
  EXPECT_EQ(substeps(0.03), 0); // of the energies before and after, which is twice as much
  EXPECT_EQ(substeps(0.006), 2);
  EXPECT_EQ(substeps(0.003), 4);
  EXPECT_EQ(substeps(1e-4), 4);
}

class CountedChain : public Chain {
 public:
  using Chain::Chain;
  double energy(const Points& x) const override {
    ++n_energies;
    return Chain::energy(x);
  }
  mutable int n_energies = 0;
};

/// A step that is taken costs one evaluation: where it ends, the next one starts.
TEST(SoundSteps, EvaluateTheEnergyOnceAStep) {
  CountedChain model({1, 2, 1}, {.neighbour = 100});
  SoundSteps stepper(model, Pieces(), std::make_unique<ImplicitEuler>(model, ImplicitEulerOptions{.cg_tolerance = 1e-12}), {});
  State state = model.state();
  state.x[1] += Vec3(0.1, 0, 0);
  for (int i = 1; i <= 20; ++i) {
    stepper.step(state, {}, 0.01);
    EXPECT_EQ(model.n_energies, i + 1);
  }
}

/// Leaves one particle without a velocity, or without a place.
class Losing : public Stepper {
 public:
  explicit Losing(Points State::*const what) : what_(what) {}
  StepReport step(State& state, const Loads&, const double dt) override {
    (state.*what_)[1][1] = std::nan("");
    state.time += dt;
    return {};
  }

 private:
  Points State::*what_;
};

TEST(SoundSteps, NameAParticleThatIsNowhere) {
  for (Points State::*const what : {&State::x, &State::v}) {
    CountedChain model({1, 2, 1}, {.neighbour = 100});
    SoundSteps stepper(model, Pieces(), std::make_unique<Losing>(what), {.most_substeps = 1});
    State state = model.state();
    try {
      stepper.step(state, {}, 0.01);
      FAIL() << "passed";
    } catch (const StepError& error) {
      EXPECT_EQ(error.particle(), 1u);
    }
  }
}

struct System {
  Eigen::MatrixXd A;
  Eigen::VectorXd b, solution;
  explicit System(const unsigned seed, const Eigen::Index n = 300) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    A = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      A(i, i) = 2 + 1e-4 * (1 + i % 7);
      if (i > 0)
        A(i, i - 1) = A(i - 1, i) = -1;
    }
    solution = Eigen::VectorXd(n).unaryExpr([&](double) { return normal(random); });
    b = A * solution;
  }
  double size(const Eigen::VectorXd& e) const { return std::sqrt(e.dot(A * e)); }
  CgReport solve(const CgStop& stop, Eigen::VectorXd& x) const {
    return conjugate_gradients(
      {[&](const auto p, const auto y) {
         Eigen::Map<Eigen::VectorXd>(y.data(), b.size()) = A * Eigen::Map<const Eigen::VectorXd>(p.data(), b.size());
       },
       [](const auto r, const auto z) { std::copy(r.begin(), r.end(), z.begin()); }},
      {b.data(), static_cast<std::size_t>(b.size())}, stop, 10000, {x.data(), static_cast<std::size_t>(x.size())});
  }
};

/// The error that is left is what was asked for, in the norm in which it was asked for; and it did cost less.
TEST(ConjugateGradients, StopByTheErrorInEnergy) {
  for (const unsigned seed : {1u, 2u, 3u})
    for (const double part : {1e-1, 1e-2, 1e-3, 1e-4}) {
      const System system(seed);
      Eigen::VectorXd x = 0.9 * system.solution, start = x, exact = x;
      const CgReport report = system.solve({.of_way = part}, x), full = system.solve({.residual = 1e-10}, exact);
      EXPECT_TRUE(report.converged);
      EXPECT_LE(system.size(x - system.solution), part * system.size(start - system.solution));
      EXPECT_LT(report.n_iterations, full.n_iterations);
      EXPECT_NEAR(report.way, system.size(x - start), 1e-6 * report.way);
    }
}

/// From a guess that is worse than nothing it starts at zero, and knows how far that was.
TEST(ConjugateGradients, StartNearer) {
  const System system(4);
  Eigen::VectorXd x = 100 * Eigen::VectorXd::Random(system.b.size()), zero = Eigen::VectorXd::Zero(x.size());
  const Eigen::VectorXd start = x;
  const CgReport report = system.solve({.residual = 1e-8}, x), from_zero = system.solve({.residual = 1e-8}, zero);
  EXPECT_EQ(report.n_iterations, from_zero.n_iterations);
  EXPECT_NEAR(report.way, system.size(start - system.solution), 1e-6 * report.way);
}

/// A stiff bar that turns by a fifth of a turn in a step: the tangent sends its end on straight, the equation does not.
TEST(ImplicitEuler, DoesNotStretchWhatTurns) {
  const auto length_after = [](const Trust trust) {
    Truss bar({Vec3(-1, 0, 0), Vec3(1, 0, 0)}, {{0, 1}}, 1e6);
    ImplicitEuler stepper(bar, {.cg_tolerance = 1e-10, .trust = trust});
    State state = bar.state();
    state.v = {Vec3(0, -1.2, 0), Vec3(0, 1.2, 0)};
    const StepReport report = stepper.step(state, {}, 1);
    EXPECT_EQ(report.n_newton > 1, trust == Trust::tested);
    return (state.x[1] - state.x[0]).norm();
  };
  EXPECT_GT(length_after(Trust::blind), 3);
  EXPECT_NEAR(length_after(Trust::tested), 2, 0.02);
}

/// The same beside a bar whose ends fly at each other, of which one correction is right: nothing joins the two, and
/// what the first one lacks is little beside what the second one does.
TEST(ImplicitEuler, JudgesEachPieceByItself) {
  const auto length_after = [](const std::vector<std::uint32_t>& piece) {
    Truss bars({Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, 0), Vec3(1e4, 0, 0)}, {{0, 1}, {2, 3}}, 1e6);
    ImplicitEuler stepper(bars, {.cg_tolerance = 1e-12, .trust = Trust::tested, .piece = piece});
    State state = bars.state();
    state.v = {Vec3(0, -1.2, 0), Vec3(0, 1.2, 0), Vec3(1e7, 0, 0), Vec3(-1e7, 0, 0)};
    const StepReport report = stepper.step(state, {}, 1);
    EXPECT_EQ(report.n_newton > 1, !piece.empty());
    EXPECT_NEAR((state.x[3] - state.x[2]).norm(), 1e4 - 2 * 1e7 / (1 + 2e6), 1e-2);
    return (state.x[1] - state.x[0]).norm();
  };
  EXPECT_GT(length_after({}), 3);
  EXPECT_NEAR(length_after({0, 0, 1, 1}), 2, 0.02);
}

/// Masses fly into springs that stiffen by c |d|^2 and that their tangents do not see: half the work of what one
/// correction leaves out of balance, c (dt v)^4, is energy from nothing. Going on takes it back, and costs nothing
/// where the tangent was right.
TEST(ImplicitEuler, GivesNoEnergyByAnUnfinishedSolution) {
  const auto gain = [](const double cubic, const Trust trust) {
    Chain model({1, 1}, {.anchor = 1e-3, .cubic = cubic});
    ImplicitEuler stepper(model, {.cg_tolerance = 1e-12, .trust = trust});
    State state = model.state();
    state.v = {Vec3(0, 1, 0), Vec3(0, -1, 0)};
    const double before = energy(model, state);
    const StepReport report = stepper.step(state, {}, 0.1);
    EXPECT_EQ(report.n_newton > 1, trust == Trust::tested && cubic > 0) << cubic;
    return energy(model, state) / before - 1;
  };
  EXPECT_LT(gain(0, Trust::tested), 0);
  for (const double part : {0.002, 0.02, 0.2}) { // c (dt v)^4 over m v^2
    EXPECT_NEAR(gain(part * 1e4, Trust::blind), 0.5 * part, 1e-4);
    EXPECT_LE(gain(part * 1e4, Trust::tested), 0) << part;
  }
}

/// A linear fixed-point map x -> x + d(x) with as many slow directions as it remembers: solved after one more.
TEST(Mixing, SolvesWhatItHasSeen) {
  const Vec3 rates(0.01, 0.05, 0.2), answer(1, -2, 3);
  const std::vector<double> weight = {1};
  Mixing mixing(4);
  Points x = {Vec3::Zero()};
  for (int k = 0; k < 5; ++k) {
    Points d = {rates.cwiseProduct(answer - x[0])};
    mixing.mix(x, weight, d);
    x[0] += d[0];
  }
  EXPECT_LT((x[0] - answer).norm(), 1e-8); // plain steps would leave 95 % of the slowest
}

/// Beyond a centimetre its energy cannot be told, the first time.
class Shy : public Chain {
 public:
  using Chain::Chain;
  double energy_ahead(const Points& x) const override {
    if ((x[0] - rest()[0]).norm() > 0.01 && ++n_asked_ == 1)
      throw NumericalError("too far");
    return energy(x);
  }

 private:
  mutable int n_asked_ = 0;
};

TEST(ElasticEnergies, RememberNothingOfWhatFails) {
  const Shy model({1.0}, {.anchor = 100});
  ElasticEnergies energies(model);
  Points far = model.rest();
  far[0].x() += 0.1;
  EXPECT_EQ(energies.at(model.rest()), 0);
  EXPECT_THROW(energies.at(far), NumericalError);
  EXPECT_EQ(energies.at(far), model.energy(far));
  EXPECT_EQ(energies.at(model.rest()), 0);
}

} // namespace
} // namespace kerf::dynamics::sound_steps_test
