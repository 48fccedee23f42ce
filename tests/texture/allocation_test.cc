// A colour at a point takes no memory: every allocation of this program is counted.

#include "tests/texture/solids.h"
#include "texture/atlas.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

namespace {
std::atomic<std::size_t> n_allocations = 0;
}

// None of them is inlined: the compiler would see malloc() or free() on one side alone, and warn.
[[gnu::noinline]] void* operator new(const std::size_t n) {
  ++n_allocations;
  if (void* const p = std::malloc(n))
    return p;
  throw std::bad_alloc();
}
/// What std::stable_sort asks for.
[[gnu::noinline]] void* operator new(const std::size_t n, const std::nothrow_t&) noexcept {
  ++n_allocations;
  return std::malloc(n);
}
[[gnu::noinline]] void operator delete(void* const p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* const p, std::size_t) noexcept { std::free(p); }

namespace kerf::texture::allocation_test {
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

/// What a triangle is filled from is found once and for all its samples: memory is taken by triangles, not by points.
TEST(Allocation, FinerSamplesOfATriangleTakeNoMoreOfThem) {
  const Interior inside(axis_exemplars(onion, 5, 60), ball(2), {});
  const Detail detail(inside);
  const Points rest = {Vec3(0, 0, 0.01), Vec3(0.02, 0, 0.01), Vec3(0, 0.02, 0.012)};
  const std::vector<Triangle> triangles = {{0, 1, 2}};
  const std::vector<std::uint16_t> labels = {1};
  for (const Detail* const used : {static_cast<const Detail*>(nullptr), &detail}) {
    const auto allocations = [&](const double resolution) {
      Atlas atlas(resolution);
      const std::size_t before = n_allocations;
      atlas.fill({rest, triangles, labels}, {&inside, used, nullptr, used ? 1e-3 : 0});
      EXPECT_GT(atlas.colours().size(), 10u);
      return n_allocations - before;
    };
    EXPECT_EQ(allocations(0.005), allocations(0.0005)); // 28 and 1,711 samples
  }
}

} // namespace
} // namespace kerf::texture::allocation_test
