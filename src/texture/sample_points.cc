#include "texture/sample_points.h"

#include <algorithm>
#include <bit>

namespace kerf::texture {

namespace {

constexpr std::uint32_t no_number = 0xffffffff;

bool is_lower(const Vec3& p, const Vec3& q) {
  return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
}

} // namespace

void SamplePoints::collect(const std::span<const std::size_t> triangles, const std::span<const Corners> corners,
                           const std::span<const std::uint16_t> parts) {
  std::size_t n = 0;
  for (const std::size_t t : triangles)
    n += n_samples(parts[t]);
  places_.clear();
  places_.reserve(n);
  numbers_.clear();
  numbers_.reserve(n);
  sides_.clear();
  sides_.reserve(3 * triangles.size());
  for (Slots* const slots : {&corner_slots_, &side_slots_})
    slots->assign(std::bit_ceil(6 * triangles.size() + 1), no_number);
  for (const std::size_t t : triangles)
    add(corners[t], parts[t]);
}

void SamplePoints::add(const Corners& corners, const int n) {
  const std::array<std::uint32_t, 3> corner = {number_of(corners[0]), number_of(corners[1]), number_of(corners[2])};
  const Run first = run(corner[0], corner[1], n), second = run(corner[0], corner[2], n),
            third = run(corner[1], corner[2], n);
  const Vec3 u = corners[1] - corners[0], v = corners[2] - corners[0];
  for_each_sample(n, [&](const int i, const int j) {
    const int k = n - i - j;
    if (i == n || j == n || k == n)
      numbers_.push_back(corner[i == n ? 1 : j == n ? 2 : 0]);
    else if (j == 0)
      numbers_.push_back(first.at(i));
    else if (i == 0)
      numbers_.push_back(second.at(j));
    else if (k == 0)
      numbers_.push_back(third.at(j));
    else
      numbers_.push_back(put(corners[0] + double(i) / n * u + double(j) / n * v));
  });
}

std::uint32_t SamplePoints::put(const Vec3& place) {
  places_.push_back(place);
  return static_cast<std::uint32_t>(places_.size() - 1);
}

/// The number of something earlier that is the same; `number`, which is kept, where there is none.
template <class IsSame>
std::uint32_t SamplePoints::find(Slots& slots, const std::uint64_t hash, const std::uint32_t number,
                                 const IsSame& is_same) {
  const std::size_t mask = slots.size() - 1;
  std::size_t at = (hash * 0x9e3779b97f4a7c15ull >> 32) & mask;
  while (slots[at] != no_number && !is_same(slots[at]))
    at = (at + 1) & mask;
  if (slots[at] == no_number)
    slots[at] = number;
  return slots[at];
}

std::uint32_t SamplePoints::number_of(const Vec3& corner) {
  const auto next = static_cast<std::uint32_t>(places_.size());
  const std::uint32_t number =
    find(corner_slots_, hash_of(corner), next, [&](const std::uint32_t other) { return places_[other] == corner; });
  return number == next ? put(corner) : number;
}

SamplePoints::Run SamplePoints::run(const std::uint32_t a, const std::uint32_t b, const int n) {
  const bool turned = is_lower(places_[b], places_[a]);
  const Side side{turned ? b : a, turned ? a : b, n, static_cast<std::uint32_t>(places_.size())};
  const auto next = static_cast<std::uint32_t>(sides_.size());
  const std::uint64_t hash = (static_cast<std::uint64_t>(side.from) << 32 | side.to) * 31 + static_cast<unsigned>(n);
  const std::uint32_t number =
    find(side_slots_, hash, next, [&](const std::uint32_t other) { return sides_[other] == side; });
  if (number == next) {
    sides_.push_back(side);
    const Vec3 from = places_[side.from], along = places_[side.to] - from;
    for (int k = 1; k < n; ++k)
      put(from + double(k) / n * along);
  }
  const std::uint32_t first = sides_[number].first;
  return turned ? Run{first + static_cast<std::uint32_t>(n) - 2, -1} : Run{first, 1};
}

} // namespace kerf::texture
