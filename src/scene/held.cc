#include "scene/held.h"

#include "base/parallel.h"
#include "grid/material.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <utility>

namespace kerf::scene {

namespace {

/// By the vertices of its tetrahedra.
bool has_material_in(const Region& region, const grid::Solid& solid, const grid::Copy& copy) {
  const Vec3 origin = solid.grid.origin(copy.cell);
  bool has = false;
  grid::for_each_tetrahedron(solid, copy, [&](const grid::Tetrahedron& t, int) {
    has = has ||
          std::any_of(t.begin(), t.end(), [&](const Vec3& p) { return contains(region, origin + solid.grid.h() * p); });
  });
  return has;
}

} // namespace

std::vector<std::uint32_t> particles_in(const Body& body, const Region& region) {
  std::vector<std::uint32_t> all(body.physics->rest().size());
  std::iota(all.begin(), all.end(), 0);
  return particles_in(body, region, std::move(all));
}

std::vector<std::uint32_t> particles_in(const Body& body, const Region& region, std::vector<std::uint32_t> among) {
  const Points& rest = body.physics->rest();
  std::vector<std::uint32_t> inside = std::move(among);
  std::erase_if(inside, [&](const auto i) { return !contains(region, rest[i]); });
  if (!body.physics->particles_are_corners() || inside.empty())
    return inside;

  std::vector<std::uint8_t> asks(rest.size(), 0), is_held(rest.size(), 0);
  for (const auto i : inside)
    asks[i] = 1;
  constexpr std::size_t worth = 4096; // copies from which on a second thread pays
  parallel_for(
    body.solid.complex.n_copies(),
    [&](const std::size_t c) {
      const grid::Copy& copy = body.solid.complex.copies[grid::CopyId(c)];
      unsigned asking = 0;
      for (int v = 0; v < grid::cube::n_vertices; ++v)
        asking |= unsigned(asks[copy.corners[v].value]) << v;
      if (asking == 0)
        return;
      const unsigned held = asking & copy.nodes; // where a corner rests there is material, or the copy is looked at
      const bool holds_all = asking != held && has_material_in(region, body.solid, copy);
      for (int v = 0; v < grid::cube::n_vertices; ++v)
        if ((holds_all ? asking : held) >> v & 1) // of several copies at once
          std::atomic_ref(is_held[copy.corners[v].value]).store(1, std::memory_order_relaxed);
    },
    worth);
  std::erase_if(inside, [&](const auto i) { return is_held[i] == 0; });
  return inside;
}

} // namespace kerf::scene
