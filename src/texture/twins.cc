#include "texture/twins.h"

#include <bit>
#include <optional>
#include <unordered_map>

namespace kerf::texture {

std::uint64_t hash_of(const Vec3& point) {
  std::uint64_t mixed = 0;
  for (const double x : point) {
    mixed = (mixed ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x9e3779b97f4a7c15ull; // + 0: -0 is 0
    mixed ^= mixed >> 29;
  }
  return mixed;
}

namespace {

/// The same for any order of the corners.
std::uint64_t hash_of_triangle(const Corners& corners) {
  return hash_of(corners[0]) + hash_of(corners[1]) + hash_of(corners[2]);
}

/// Which corner of `b` lies on each of `a`.
std::optional<std::array<int, 3>> same_corners(const Corners& a, const Corners& b) {
  std::array<int, 3> at;
  for (int i = 0; i < 3; ++i) {
    at[i] = 0;
    while (at[i] < 3 && a[i] != b[at[i]])
      ++at[i];
    if (at[i] == 3)
      return std::nullopt;
  }
  if (at[0] == at[1] || at[1] == at[2] || at[2] == at[0])
    return std::nullopt; // corners that coincide
  return at;
}

} // namespace

Sides find_sides(const std::span<const std::size_t> triangles, const std::span<const Corners> corners,
                 const std::span<const std::uint16_t> labels) {
  Sides sides;
  std::unordered_map<std::uint64_t, std::size_t> first;
  for (const std::size_t t : triangles) {
    const std::size_t earlier = labels[t] > 0 ? first.emplace(hash_of_triangle(corners[t]), t).first->second : t;
    const auto same = earlier != t ? same_corners(corners[t], corners[earlier]) : std::nullopt;
    if (same)
      sides.twins.push_back({t, earlier, *same});
    else
      sides.painted.push_back(t);
  }
  return sides;
}

} // namespace kerf::texture
