#pragma once

/// Where the samples of triangles lie (atlas.h), each place once: corners, and points of sides, that triangles have in
/// common. So their colours are found once.

#include "texture/twins.h"

#include <cstdint>

namespace kerf::texture {

/// Samples of a triangle with n parts a side.
inline std::size_t n_samples(const int n) { return static_cast<std::size_t>(n + 1) * (n + 2) / 2; }

/// Calls f(i, j) for each sample in their order: the point a + i/n (b - a) + j/n (c - a) of the triangle a, b, c.
template <class Function>
void for_each_sample(const int n, const Function& f) {
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j)
      f(i, j);
}

class SamplePoints {
 public:
  /// Collects those of some triangles, by number, in their order; `corners` and `parts` are those of all. Triangles
  /// share a corner where theirs are the same to the bit, and the points of a side where both its corners and their
  /// parts are the same. The bits of a place on a side are the same whichever triangles have it, in whatever order.
  /// Memory is kept for the next ones.
  void collect(std::span<const std::size_t> triangles, std::span<const Corners> corners,
               std::span<const std::uint16_t> parts);

  const std::vector<Vec3>& places() const { return places_; } ///< rest frame [m]
  /// Of the place of each sample, triangle by triangle.
  const std::vector<std::uint32_t>& numbers() const { return numbers_; }

 private:
  /// A side between two corners, by the numbers of their places, the lower corner first.
  struct Side {
    std::uint32_t from, to;
    int n_parts;
    std::uint32_t first; ///< of the places between them
    bool operator==(const Side& other) const {
      return from == other.from && to == other.to && n_parts == other.n_parts;
    }
  };
  /// Places along a side, from one of its corners.
  struct Run {
    std::uint32_t first; ///< that after the corner
    int step;
    std::uint32_t at(const int k) const { return first + static_cast<std::uint32_t>(step * (k - 1)); }
  };
  using Slots = std::vector<std::uint32_t>; ///< numbers of what is there already, next to where a hash puts them

  template <class IsSame>
  static std::uint32_t find(Slots& slots, std::uint64_t hash, std::uint32_t number, const IsSame& is_same);
  void add(const Corners& corners, int n);
  std::uint32_t put(const Vec3& place);
  std::uint32_t number_of(const Vec3& corner);
  Run run(std::uint32_t a, std::uint32_t b, int n);

  std::vector<Vec3> places_;
  std::vector<std::uint32_t> numbers_;
  std::vector<Side> sides_;
  Slots corner_slots_, side_slots_;
};

} // namespace kerf::texture
