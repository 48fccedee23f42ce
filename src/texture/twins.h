#pragma once

/// Triangles that lie on each other: both sides of a cut, at rest. What one shows, the other does.

#include "base/vec.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace kerf::texture {

using Corners = std::array<Vec3, 3>;

/// The same for points that are equal.
std::uint64_t hash_of(const Vec3& point);

/// A triangle, and an earlier one with the same corners, to the bit.
struct Twin {
  std::size_t number, first;
  std::array<int, 3> corner; ///< of the earlier one, for each corner of the triangle
};

struct Sides {
  std::vector<std::size_t> painted; ///< triangles that lie on no earlier one
  std::vector<Twin> twins;
};

/// Of some triangles, by number. `corners` and `labels` are those of all; triangles of the skin have no twins.
Sides find_sides(std::span<const std::size_t> triangles, std::span<const Corners> corners,
                 std::span<const std::uint16_t> labels);

/// The number of sample (i, j) of a triangle with n parts a side: rows of i, as for_each_sample() has them.
inline std::size_t sample_number(const int n, const int i, const int j) {
  return static_cast<std::size_t>(i * (n + 1) - i * (i - 1) / 2 + j);
}

/// The number that sample (i, j) of a triangle with n parts a side has in the one that it lies on.
inline std::size_t sample_of_first(const Twin& twin, const int n, const int i, const int j) {
  std::array<int, 3> parts = {};
  const std::array<int, 3> own = {n - i - j, i, j};
  for (int a = 0; a < 3; ++a)
    parts[twin.corner[a]] = own[a];
  return sample_number(n, parts[1], parts[2]);
}

} // namespace kerf::texture
