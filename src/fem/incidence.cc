#include "fem/incidence.h"

#include <algorithm>

namespace kerf::fem {

Incidence::Incidence(const grid::CellComplex& complex) : users_(complex.n_corners()) {
  corners_.reserve(8 * complex.n_copies());
  for (const grid::Copy& copy : complex.copies)
    for (const auto corner : copy.corners) {
      corners_.push_back(corner.value);
      ++users_[corner.value].capacity;
    }
  std::uint32_t first = 0;
  for (Range& range : users_) {
    range.first = first;
    first += range.capacity;
  }
  slots_.resize(first);
  for (std::uint32_t i = 0; i < corners_.size(); ++i) {
    Range& range = users_[corners_[i]];
    slots_[range.first + range.size++] = i;
  }
}

std::vector<std::uint32_t> Incidence::update(const grid::CellComplex& complex,
                                             const std::span<const grid::CopyId> changed) {
  std::vector<std::uint32_t> touched;
  users_.resize(complex.n_corners());
  const std::size_t n_before = n_copies();
  corners_.resize(8 * complex.n_copies());
  for (const grid::CopyId c : changed)
    for (int a = 0; a < 8; ++a) {
      const std::uint32_t user = 8 * c.value + a, corner = complex.copies[c].corners[a].value;
      const bool is_old = c.value < n_before;
      touched.push_back(corner);
      if (is_old && corners_[user] == corner)
        continue;
      if (is_old) {
        touched.push_back(corners_[user]);
        remove(corners_[user], user);
      }
      corners_[user] = corner;
      add(corner, user);
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
    slots_.resize(slots_.size() + range.capacity);
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
