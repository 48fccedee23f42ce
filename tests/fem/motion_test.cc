/// Bodies in motion: what the integrators make of the elements.

#include "base/error.h"
#include "base/parallel.h"
#include "dynamics/implicit_euler.h"
#include "dynamics/symplectic_euler.h"
#include "fem/hexahedra.h"
#include "tests/fem/bodies.h"
#include "tests/support/spectrum.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace kerf::fem::motion_test {
namespace {

const material::Elastic rubber{.density = 1000, .youngs_modulus = 1e4, .poissons_ratio = 0.3};

Body cut_block(const unsigned seed) {
  Draw draw(seed);
  Body body = make_block({3, 3, 3}, 0.1, draw, {0.3, 0.7});
  cut_at_random(body, 0.3, draw, {0.3, 0.7});
  return body;
}

struct Momentum {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
};

Momentum momentum(const Hexahedra& model, const dynamics::State& state) {
  Momentum sum;
  for (std::size_t c = 0; c < state.x.size(); ++c) {
    const Vec3 p = model.lumped_mass()[c] * state.v[c];
    sum.linear += p;
    sum.angular += state.x[c].cross(p);
  }
  return sum;
}

/// A body that flies, spins and is out of shape.
dynamics::State thrown(const Body& body, const unsigned seed) {
  Draw draw(seed);
  dynamics::State state{body.rest(), {}, 0};
  const Mat3 Q = draw.rotation();
  for (Vec3& p : state.x) {
    p = Q * p + 0.005 * draw.vector();
    state.v.push_back(Vec3(1, 2, 3) + Vec3(0, 0, 5).cross(p));
  }
  return state;
}

TEST(Motion, ImplicitEulerKeepsMomentum) {
  const Body body = cut_block(71);
  Hexahedra model(body, {.material = rubber});
  dynamics::ImplicitEuler stepper(model, {.cg_tolerance = 1e-13});
  dynamics::State state = thrown(body, 72);
  const Vec3 before = momentum(model, state).linear;
  for (int i = 0; i < 20; ++i)
    stepper.step(state, {}, 1.0 / 60);
  EXPECT_LT((momentum(model, state).linear - before).norm(), 1e-11 * before.norm());
}

/// f has no torque, so x += dt v keeps the angular momentum too. Full cubes: light slivers would need shorter steps.
TEST(Motion, SymplecticEulerKeepsBothMomenta) {
  const Body body = cut_block(73);
  Hexahedra model(body, {.material = rubber, .boundary = Boundary::full_cube});
  dynamics::SymplecticEuler stepper(model);
  dynamics::State state = thrown(body, 74);
  const Momentum before = momentum(model, state);
  for (int i = 0; i < 400; ++i)
    stepper.step(state, {}, 1e-3);
  const Momentum after = momentum(model, state);
  EXPECT_LT((after.linear - before.linear).norm(), 1e-12 * before.linear.norm());
  EXPECT_LT((after.angular - before.angular).norm(), 1e-12 * before.angular.norm());
}

/// 2 / (largest frequency) [s], from the spectrum.
double longest_stable_step(const Hexahedra& model) {
  const auto n = static_cast<Eigen::Index>(3 * model.lumped_mass().size());
  Eigen::MatrixXd K(n, n);
  Eigen::VectorXd scale(n), p = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    scale[i] = 1 / std::sqrt(model.lumped_mass()[i / 3]);
    p[i] = 1;
    model.apply_stiffness({p.data(), p.data() + n}, {K.col(i).data(), K.col(i).data() + n});
    p[i] = 0;
  }
  K = scale.asDiagonal() * K * scale.asDiagonal();
  const Eigen::VectorXd eigenvalues = support::spectrum(K);
  return 2 / std::sqrt(eigenvalues[n - 1]);
}

TEST(Motion, SymplecticEulerIsStableUpToTheLargestFrequency) {
  Draw draw(75);
  const Body body = make_block({2, 2, 2}, 0.1, draw, {0.4, 0.6});
  Hexahedra model(body, {.material = rubber});
  const double limit = longest_stable_step(model);
  const Points rest = body.rest();
  const auto run = [&](const double dt) {
    Draw noise(76);
    dynamics::State state{rest, Points(rest.size(), Vec3::Zero()), 0};
    for (Vec3& x : state.x)
      x += 1e-9 * noise.vector();
    dynamics::SymplecticEuler stepper(model);
    for (int i = 0; i < 4000; ++i)
      stepper.step(state, {}, dt);
    double most = 0;
    for (std::size_t c = 0; c < rest.size(); ++c)
      most = std::max(most, (state.x[c] - rest[c]).norm());
    return most;
  };
  EXPECT_LT(run(0.98 * limit), 1e-6);
  EXPECT_THROW(run(1.02 * limit), NumericalError);
}

/// The price of exact masses: a corner that only a sliver holds is light, and an explicit step must follow it.
TEST(Motion, SliversShortenTheStableStep) {
  double before = 1;
  for (const double t : {0.5, 0.2, 0.1, 0.01}) {
    Draw draw(75);
    const Body body = make_block({2, 2, 2}, 0.1, draw, {t, t});
    const double step = longest_stable_step({body, {.material = rubber}});
    EXPECT_LT(step, before);
    RecordProperty("step_us_at_t_" + std::to_string(t), std::to_string(1e6 * step));
    before = step;
  }
}

/// Cuts right at the nodes leave slivers of 1e-9 of a cube and less: the solve is no harder for it.
TEST(Motion, SliversDoNotStopTheSolver) {
  const auto iterations = [](const double t) {
    Draw draw(77);
    Body body = make_block({4, 4, 4}, 0.1, draw, {0.5, 0.5});
    cut_plane(body, 0, 2, t);
    cut_at_random(body, 0.1, draw, {t, t});
    Hexahedra model(body, {.material = rubber});
    dynamics::ImplicitEuler stepper(model, {});
    dynamics::State state{body.rest(), Points(body.complex.n_corners(), Vec3::Zero()), 0};
    for (Vec3& v : state.v)
      v = draw.vector();
    int n = 0;
    for (int i = 0; i < 5; ++i)
      n += stepper.step(state, {.gravity = Vec3(0, 0, -9.81), .supports = {}}, 1.0 / 60).n_iterations;
    for (const Vec3& x : state.x)
      EXPECT_TRUE(x.allFinite());
    return n;
  };
  const int usual = iterations(0.5), sliver = iterations(1e-9);
  RecordProperty("usual", usual);
  RecordProperty("sliver", sliver);
  EXPECT_LT(sliver, 4 * usual);
}

TEST(Motion, OneAndTwoThreadsGiveTheSameBits) {
  std::array<dynamics::State, 2> states;
  for (const int n : {1, 2}) {
    set_n_threads(n);
    Draw draw(78);
    Body body = make_block({14, 14, 14}, 0.1, draw, {0.3, 0.7});
    cut_at_random(body, 0.1, draw, {0.3, 0.7});
    Hexahedra model(body, {.material = rubber});
    dynamics::ImplicitEuler stepper(model, {});
    states[n - 1] = thrown(body, 79);
    for (int i = 0; i < 2; ++i)
      stepper.step(states[n - 1], {.gravity = Vec3(0, 0, -9.81), .supports = {}}, 1.0 / 60);
  }
  set_n_threads(1);
  EXPECT_EQ(states[0].x, states[1].x);
  EXPECT_EQ(states[0].v, states[1].v);
}

} // namespace
} // namespace kerf::fem::motion_test
