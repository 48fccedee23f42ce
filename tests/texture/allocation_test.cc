// A colour at a point takes no memory: every allocation of this program is counted.

#include "tests/texture/solids.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

namespace {
std::atomic<std::size_t> n_allocations = 0;
}

void* operator new(const std::size_t n) {
  ++n_allocations;
  if (void* const p = std::malloc(n))
    return p;
  throw std::bad_alloc();
}
void operator delete(void* const p) noexcept { std::free(p); }
void operator delete(void* const p, std::size_t) noexcept { std::free(p); }

namespace kerf::texture {
namespace {

TEST(Allocation, AColourTakesNone) {
  const Interior inside(axis_exemplars(onion, 5, 60), ball(2), {});
  for (const auto morph : {Morph::first_order, Morph::exact_inverse, Morph::blend, Morph::nearest})
    for (const auto weights : {Weights::shepard, Weights::mean_value}) {
      const std::size_t before = n_allocations;
      float sum = 0;
      for (int i = -20; i <= 20; ++i)
        sum += inside.colour(Vec3(0.001 * i, 0.0007 * i, 0.0013 * i), {morph, weights, 1})[0];
      EXPECT_GT(sum, 0);
      EXPECT_EQ(n_allocations, before);
    }
}

} // namespace
} // namespace kerf::texture
