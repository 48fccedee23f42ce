/// Any number of threads gives the same bits, in bodies large enough to be given several.

#include "dynamics/floor.h"
#include "tests/dynamics/chain.h"
#include "tests/dynamics/integrators.h"
#include "tests/support/threads.h"

#include <deal.II/base/multithread_info.h>

#include <gtest/gtest.h>

namespace kerf::dynamics::threads_test {
namespace {

constexpr std::size_t n_masses = 20000;

State after_steps(const int n_of_threads, const std::function<std::unique_ptr<Stepper>(ElasticModel&)>& make) {
  Chain model(std::vector<double>(n_masses, 0.01), {.anchor = 1, .cubic = 10, .neighbour = 300});
  Loads loads{.gravity = Vec3(0, 0, -9.81), .mass_damping = 0.1, .stiffness_damping = 0.001, .supports = {}};
  Support support{.corners = {}, .rest = {}, .displacement = [](double) { return Vec3(Vec3::Zero()); }};
  for (const std::uint32_t i : {0, 7, 255, 256, 4095, 4096, 19999}) { // at the borders of blocks, and where none is near
    support.corners.push_back(i);
    support.rest.push_back(model.rest()[i]);
  }
  loads.supports.push_back(support);
  loads.acting.push_back(std::make_unique<Floor>(
    ContactPoints{corners_themselves(n_masses), std::vector<double>(n_masses, 1e-4)}, FloorParameters{}));
  State state = model.state();
  for (std::size_t i = 0; i < n_masses; ++i)
    state.v[i] = Vec3(static_cast<double>(i * 7919 % 13) - 6, static_cast<double>(i * 104729 % 11) - 5, 1);
  const auto stepper = make(model);
  with_threads(n_of_threads, [&] {
    for (int i = 0; i < 3; ++i)
      stepper->step(state, loads, 2e-3);
  });
  return state;
}

TEST(Threads, DoNotChangeABit) {
  const NewtonOptions searching{.max_iterations = 3, .line_search = LineSearch::backtracking};
  const std::function<std::unique_ptr<Stepper>(ElasticModel&)> makers[] = {
    [](ElasticModel& m) { return made<ImplicitEuler>(m, ImplicitEulerOptions{}); },
    [&](ElasticModel& m) { return made<Bdf2>(m, searching); },
    [](ElasticModel& m) { return made<ExplicitEuler>(m, go_on); },
    [](ElasticModel& m) { return made<SymplecticEuler>(m, ExplicitOptions{}); },
    [](ElasticModel& m) { return made<MidpointRungeKutta>(m, go_on); },
    [](ElasticModel& m) { return made<VelocityVerlet>(m, ExplicitOptions{}); },
  };
  dealii::MultithreadInfo::set_thread_limit(4); // by itself deal.II allows no more than there are processors
  for (const auto& make : makers) {
    const State one = after_steps(1, make);
    for (const int n : {2, 4}) {
      const State several = after_steps(n, make);
      EXPECT_TRUE(one.x == several.x);
      EXPECT_TRUE(one.v == several.v);
    }
    EXPECT_TRUE(one.x[n_masses / 2].allFinite());
  }
}

} // namespace
} // namespace kerf::dynamics::threads_test
