#include "texture/free_places.h"

#include <iterator>

namespace kerf::texture {

void FreePlaces::add(const std::size_t first, const std::size_t n) {
  length_of_.emplace(first, n);
  by_length_.emplace(n, first);
}

void FreePlaces::remove(const Run run) {
  by_length_.erase({run->second, run->first});
  length_of_.erase(run);
}

std::size_t FreePlaces::take(const std::size_t n) {
  const auto shortest = by_length_.lower_bound({n, 0});
  if (shortest == by_length_.end())
    return std::exchange(end_, end_ + n);
  const auto [length, first] = *shortest;
  remove(length_of_.find(first));
  if (length > n)
    add(first + n, length - n);
  return first;
}

void FreePlaces::give_back(std::size_t first, std::size_t n) {
  if (const Run after = length_of_.find(first + n); after != length_of_.end()) {
    n += after->second;
    remove(after);
  }
  if (const Run next = length_of_.lower_bound(first); next != length_of_.begin())
    if (const Run before = std::prev(next); before->first + before->second == first) {
      first = before->first;
      n += before->second;
      remove(before);
    }
  if (first + n == end_)
    end_ = first;
  else
    add(first, n);
}

void FreePlaces::archive(Archive& a) {
  a(end_, length_of_);
  if (!a.reads())
    return;
  by_length_.clear();
  for (const auto& [first, n] : length_of_)
    by_length_.emplace(n, first);
}

} // namespace kerf::texture
