#include "scene/held.h"

#include "grid/material.h"

#include <algorithm>

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
  const Points& rest = body.physics->rest();
  std::vector<std::uint32_t> inside;
  for (std::uint32_t i = 0; i < rest.size(); ++i)
    if (contains(region, rest[i]))
      inside.push_back(i);
  if (!body.physics->particles_are_corners() || inside.empty())
    return inside;

  enum class Corner : std::uint8_t { outside, asks, held };
  std::vector<Corner> corners(rest.size(), Corner::outside);
  for (const auto i : inside)
    corners[i] = Corner::asks;
  for (const auto c : ids<grid::CopyId>(body.solid.complex.n_copies())) {
    const grid::Copy& copy = body.solid.complex.copies[c];
    unsigned asking = 0;
    for (int v = 0; v < grid::cube::n_vertices; ++v)
      if (corners[copy.corners[v].value] == Corner::asks)
        asking |= 1u << v;
    const unsigned held = asking & copy.nodes; // where a corner rests there is material, or the copy is looked at
    const bool holds_all = asking != held && has_material_in(region, body.solid, copy);
    for (int v = 0; v < grid::cube::n_vertices; ++v)
      if ((holds_all ? asking : held) >> v & 1)
        corners[copy.corners[v].value] = Corner::held;
  }
  std::erase_if(inside, [&](const auto i) { return corners[i] != Corner::held; });
  return inside;
}

} // namespace kerf::scene
