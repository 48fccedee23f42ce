#include "fem/incidence.h"

#include "base/loan.h"

#include <algorithm>

namespace kerf::fem {

Incidence::Incidence(const grid::Solid& solid) : users_(solid.complex.n_corners()) {
  const auto& complex = solid.complex;
  corners_.reserve(8 * complex.n_copies());
  for (const auto c : ids<grid::CopyId>(complex.n_copies()))
    for (const auto corner : complex.copies[c].corners) {
      const bool is_used = !solid.crumbs.holds(c);
      corners_.push_back(is_used ? corner.value : unused);
      if (is_used)
        ++users_[corner.value].capacity;
    }
  std::uint32_t first = 0;
  for (Range& range : users_) {
    range.first = first;
    first += range.capacity;
  }
  slots_.resize(first);
  for (std::uint32_t i = 0; i < corners_.size(); ++i) {
    if (corners_[i] == unused)
      continue;
    Range& range = users_[corners_[i]];
    slots_[range.first + range.size++] = i;
  }
}

std::vector<std::uint32_t> Incidence::update(const grid::Solid& solid, const std::span<const grid::CopyId> changed) {
  const auto& complex = solid.complex;
  std::vector<std::uint32_t> touched;
  grow(users_, complex.n_corners());
  grow(corners_, 8 * std::size_t(complex.n_copies()), unused);
  for (const grid::CopyId c : changed)
    for (int a = 0; a < 8; ++a) {
      const std::uint32_t user = 8 * c.value + a, before = corners_[user], corner = complex.copies[c].corners[a].value,
                          now = solid.crumbs.holds(c) ? unused : corner;
      touched.push_back(corner);
      if (before == now)
        continue;
      if (before != unused) {
        touched.push_back(before);
        remove(before, user);
      }
      corners_[user] = now;
      if (now != unused)
        add(now, user);
    }
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  return touched;
}

void Incidence::add(const std::uint32_t corner, const std::uint32_t user) {
  Range& range = users_[corner];
  if (range.size == range.capacity) { // moves to the end; what it leaves is not used again
    const Range before = range;
    range = {static_cast<std::uint32_t>(slots_.size()), before.size, std::max(8u, 2 * before.capacity)};
    grow(slots_, slots_.size() + range.capacity);
    std::copy_n(slots_.begin() + before.first, before.size, slots_.begin() + range.first);
  }
  const auto begin = slots_.begin() + range.first, end = begin + range.size;
  const auto place = std::upper_bound(begin, end, user);
  std::copy_backward(place, end, end + 1);
  *place = user;
  ++range.size;
}

void Incidence::remove(const std::uint32_t corner, const std::uint32_t user) {
  Range& range = users_[corner];
  const auto begin = slots_.begin() + range.first, end = begin + range.size;
  std::copy(std::lower_bound(begin, end, user) + 1, end, std::lower_bound(begin, end, user));
  --range.size;
}

} // namespace kerf::fem
