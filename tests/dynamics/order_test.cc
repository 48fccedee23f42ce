/// The order of every integrator, against closed forms: a damped oscillator that is driven, a vibrating bar, a
/// nonlinear oscillator against its own fine solution, and a support that moves.

#include "dynamics/body_force.h"
#include "tests/dynamics/chain.h"
#include "tests/dynamics/integrators.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

namespace kerf::dynamics::order_test {
namespace {

class Order : public testing::TestWithParam<Integrator> {
 protected:
  /// Advances to `end` in n steps.
  static void run(ElasticModel& model, State& state, const Loads& loads, const double end, const int n) {
    const auto stepper = GetParam().make(model);
    for (int i = 0; i < n; ++i)
      stepper->step(state, loads, end / n);
    EXPECT_NEAR(state.time, end, 1e-12);
  }

  /// The rate from n to 8 n steps.
  static void expect_order(const std::function<double(int n)>& error, const int n) {
    const double first = error(n), last = error(8 * n), rate = std::log2(first / last) / 3;
    EXPECT_NEAR(rate, GetParam().order, 0.1) << "errors " << first << " .. " << last;
    RecordProperty("rate", std::to_string(rate));
  }
};

/// m x'' + c x' + k x = A cos(q t) with both kinds of Rayleigh damping: transient and steady state.
TEST_P(Order, OnADampedDrivenOscillator) {
  const double m = 2, k = 50, alpha = 0.3, beta = 0.01, q = 3, A = 4, end = 1.5, x0 = 0.1, v0 = -0.4;
  const double decay = 0.5 * (alpha + beta * k / m), omega = std::sqrt(k / m - decay * decay);
  using C = std::complex<double>;
  const C steady = A / C(k - m * q * q, 2 * decay * m * q);
  const C transient(x0 - steady.real(), 0); // of exp(-decay t) (B cos + D sin)
  const double B = transient.real(), D = (v0 + decay * B - (steady * C(0, q)).real()) / omega;
  const double exact = std::exp(-decay * end) * (B * std::cos(omega * end) + D * std::sin(omega * end)) +
                       (steady * std::exp(C(0, q * end))).real();
  const auto error = [&](const int n) {
    Chain model({m}, {.anchor = k});
    State state = model.state();
    state.x[0][1] += x0;
    state.v[0][1] = v0;
    Loads loads{.mass_damping = alpha, .stiffness_damping = beta, .supports = {}};
    loads.acting.push_back(
      std::make_unique<BodyForce>(std::vector<double>{0.5}, model.rest(),
                                  [&](const Vec3&, const double t) { return Vec3(0, 2 * A * std::cos(q * t), 0); }));
    run(model, state, loads, end, n);
    return std::abs(state.x[0][1] - exact);
  };
  expect_order(error, 800);
}

/// Masses between two walls: mode j of n has w = 2 sqrt(k/m) sin(j pi / (2 (n + 1))) and the shape of a sine.
TEST_P(Order, OnAVibratingBar) {
  constexpr int n_masses = 7, mode = 2;
  const double m = 0.3, k = 40, end = 1;
  const double omega = 2 * std::sqrt(k / m) * std::sin(mode * std::numbers::pi / (2 * (n_masses + 1)));
  const auto shape = [&](const int i) { return 0.01 * std::sin(mode * std::numbers::pi * i / (n_masses + 1)); };
  const auto error = [&](const int n) {
    Chain model(std::vector<double>(n_masses + 2, m), {.neighbour = k});
    State state = model.state();
    Loads loads;
    const auto still = [](double) { return Vec3(Vec3::Zero()); };
    loads.supports = {{{0, n_masses + 1}, {model.rest().front(), model.rest().back()}, still}};
    for (int i = 0; i < n_masses + 2; ++i)
      state.x[i][0] += shape(i);
    run(model, state, loads, end, n);
    double largest = 0;
    for (int i = 0; i < n_masses + 2; ++i)
      largest = std::max(largest, std::abs(state.x[i][0] - model.rest()[i][0] - shape(i) * std::cos(omega * end)));
    return largest;
  };
  expect_order(error, 800);
}

TEST_P(Order, OnANonlinearOscillator) {
  const auto end_of = [&](const Integrator& integrator, const int n) {
    Chain model({1, 2}, {.anchor = 3, .cubic = 200, .neighbour = 20, .weights = Vec3(1, 2, 3)});
    State state = model.state();
    state.v[0] = Vec3(0.5, 1, -0.5);
    const auto stepper = integrator.make(model);
    for (int i = 0; i < n; ++i)
      stepper->step(state, {.gravity = Vec3(0, 0, -1), .mass_damping = 0.2, .supports = {}}, 1.0 / n);
    return state;
  };
  const State fine = end_of(integrators()[3], 40000); // velocity Verlet, error 1e-8
  const auto error = [&](const int n) { return (end_of(GetParam(), n).x[1] - fine.x[1]).norm(); };
  expect_order(error, 800);
}

/// A mass that hangs on a support which swings: x'' = w^2 (s(t) - x), in resonance with nothing.
TEST_P(Order, UnderAMovingSupport) {
  const double m = 1.5, k = 30, q = 2, end = 1, w2 = k / m, w = std::sqrt(w2), c = w2 / (w2 - q * q);
  const double x = 0.1 * c * (std::sin(q * end) - q / w * std::sin(w * end)),
               v = 0.1 * c * q * (std::cos(q * end) - std::cos(w * end));
  const auto error = [&](const int n) {
    Chain model({1, m}, {.neighbour = k});
    State state = model.state();
    state.v[0][1] = 0.1 * q;
    Loads loads;
    loads.supports = {{{0}, {model.rest()[0]}, [&](const double t) { return Vec3(0, 0.1 * std::sin(q * t), 0); }}};
    run(model, state, loads, end, n);
    return std::hypot(w * (state.x[1][1] - x), state.v[1][1] - v);
  };
  expect_order(error, 800);
}

INSTANTIATE_TEST_SUITE_P(All, Order, testing::ValuesIn(integrators()),
                         [](const auto& info) { return info.param.name; });

} // namespace
} // namespace kerf::dynamics::order_test
