// Between cuts the steps of a run allocate nothing, also while blades move: every intermediate value has its memory
// from the steps before. And there is not much of it.

#include "base/parallel.h"
#include "tests/scene/trials.h"

#include <malloc.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>

// Sanitizers have their own.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

// In place of the C library's, whose own are behind them: what any library of this program allocates is counted.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);
}

namespace {

std::atomic<bool> is_counting = false;
std::atomic<std::size_t> n_allocations = 0, n_bytes = 0, most_bytes = 0;

void* counted(void* const p) {
  if (is_counting.load(std::memory_order_relaxed))
    ++n_allocations;
  const std::size_t now = n_bytes += malloc_usable_size(p);
  for (std::size_t most = most_bytes; now > most && !most_bytes.compare_exchange_weak(most, now);) {
  }
  return p;
}
void gone(void* const p) { n_bytes -= malloc_usable_size(p); }

} // namespace

extern "C" {
void* malloc(const std::size_t n) { return counted(__libc_malloc(n)); }
void* calloc(const std::size_t n, const std::size_t size) { return counted(__libc_calloc(n, size)); }
void* realloc(void* const p, const std::size_t n) {
  gone(p);
  return counted(__libc_realloc(p, n));
}
void* memalign(const std::size_t alignment, const std::size_t n) { return counted(__libc_memalign(alignment, n)); }
void free(void* const p) {
  gone(p);
  __libc_free(p);
}
void* aligned_alloc(const std::size_t alignment, const std::size_t n) { return memalign(alignment, n); }
int posix_memalign(void** const p, const std::size_t alignment, const std::size_t n) {
  *p = memalign(alignment, n);
  return *p ? 0 : ENOMEM;
}
}

namespace kerf::scene::steps_test {
namespace {

/// In the last of the steps.
std::size_t allocations_in_a_step(const std::string& text, const int n_steps) {
  set_n_threads(1);
  World world = world_of(text);
  Timings seconds;
  for (int step = 1; step < n_steps; ++step)
    advance(world, step, seconds);
  n_allocations = 0;
  is_counting = true;
  advance(world, n_steps, seconds);
  is_counting = false;
  set_n_threads(2);
  return n_allocations;
}

/// A bar that is held at an end, cut half through in the first step, and swings under its weight.
std::string cut_bar(const Keys& keys, const double dt) {
  const std::string inside = material(1e5, 0.3) + section("Support wall", box("-1, -1, -1", "0.04, 1, 1")) +
                             section("Damping", {"Mass damping [1/s] = 0.5"});
  return steps(dt, 100) + section("Gravity", {"Acceleration [m/s^2] = 0, 0, -9.81"}) +
         section("Body bar", bar_keys() + keys, inside) +
         section("Cut surface half", {"Shape = rectangle", "Point [m] = 0.5, 0.1, 0.2", "First side [m] = 0, 1, 0",
                                      "Second side [m] = 0, 0, 0.21"});
}

TEST(Allocations, AreCounted) {
  n_allocations = 0;
  is_counting = true;
  const std::vector<double> values(100);
  is_counting = false;
  EXPECT_EQ(n_allocations, 1u);
  EXPECT_EQ(values.size(), 100u);
}

/// A blade moves above the cut bar, farther than the four cubes within which skin may be.
std::string cut_bar_and_blade(const Keys& keys, const double dt) {
  return cut_bar(keys, dt) +
         section("Blade near", {"Edge [m] = 0, -0.1, 0; 0, 0.3, 0", "Spine [m] = 0, 0, 0.08", "Times [s] = 0, 1000",
                                "Positions [m] = 0.25, 0, 0.7; 0.25, 0, 0.3"});
}

struct Trial {
  std::string name;
  Keys keys;
  double dt;
};

class Allocations : public testing::TestWithParam<Trial> {};

TEST_P(Allocations, NoneInAStepWithoutACut) {
  EXPECT_EQ(allocations_in_a_step(cut_bar(GetParam().keys, GetParam().dt), 30), 0u);
}

TEST_P(Allocations, NoneInAStepInWhichABladeMovesFarFromTheBody) {
  EXPECT_EQ(allocations_in_a_step(cut_bar_and_blade(GetParam().keys, GetParam().dt), 30), 0u);
}

/// The most that there is at a time of a body and its implicit steps, a cell. Cells with skin are a fifth of this cube.
TEST(Memory, OfACell) {
  set_n_threads(1);
  const std::size_t before = n_bytes;
  World world = world_of(steps(0.01, 3) + section("Gravity", {"Acceleration [m/s^2] = 0, 0, -1"}) +
                         section("Body cube", {"Mesh = " + mesh_path("cube.off"), "Cube edge [m] = 0.0081"},
                                 material(1e5, 0.3) + section("Support wall", box("-1, -1, -1", "1, 1, -0.09"))));
  Timings seconds;
  most_bytes = 0;
  for (int step = 1; step <= 3; ++step)
    advance(world, step, seconds);
  set_n_threads(2);
  const auto n_cells = double(world.bodies[0].solid.complex.n_copies());
  EXPECT_LT(double(most_bytes - before) / n_cells, 2400);
}

INSTANTIATE_TEST_SUITE_P(
  Steps, Allocations,
  testing::Values(Trial{"fem", {"Element = enhanced"}, 0.01}, Trial{"trilinear", {"Element = trilinear"}, 0.01},
                  Trial{"Newmark", {"Integrator = Newmark"}, 0.01},
                  Trial{"generalised_alpha", {"Integrator = generalised alpha"}, 0.01},
                  Trial{"BDF2", {"Integrator = BDF2"}, 0.01},
                  Trial{"symplectic", {"Integrator = symplectic Euler"}, 1e-4},
                  Trial{"Verlet", {"Integrator = velocity Verlet"}, 1e-4}, Trial{"points", {"Backend = pba"}, 0.01},
                  Trial{"springs", {"Backend = mass-spring"}, 0.01}, Trial{"lattice", {"Backend = lattice"}, 0.002}),
  [](const auto& trial) { return trial.param.name; });

} // namespace
} // namespace kerf::scene::steps_test

#endif
