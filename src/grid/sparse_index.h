#pragma once

/// A number for a few of many keys that lie along surfaces: keys in order come in groups of 16, and only groups with a
/// number take room. What a key without number costs is a quarter of a byte.

#include "base/archive.h"
#include "base/id.h"

#include <array>

namespace kerf::grid {

template <class Key>
class SparseIndex {
 public:
  static constexpr std::uint32_t none = Id<void>::no_value;

  SparseIndex() = default;
  /// For keys below n, all without a number.
  explicit SparseIndex(const std::size_t n) : group_of_((n + size - 1) / size, none) {}

  /// none where there is no number.
  std::uint32_t operator[](const Key key) const {
    const std::uint32_t group = group_of_[key.value / size];
    return group == none ? none : groups_[group][key.value % size];
  }
  /// To be written; good until the next call.
  std::uint32_t& at(const Key key) {
    std::uint32_t& group = group_of_[key.value / size];
    if (group == none) {
      group = static_cast<std::uint32_t>(groups_.size());
      groups_.emplace_back().fill(none);
    }
    return groups_[group][key.value % size];
  }

  void archive(Archive& a) { a(group_of_, groups_); }
  std::size_t n_bytes() const {
    return group_of_.capacity() * sizeof(std::uint32_t) + groups_.capacity() * sizeof(Group);
  }

 private:
  static constexpr std::uint32_t size = 16;
  using Group = std::array<std::uint32_t, size>;

  std::vector<std::uint32_t> group_of_;
  std::vector<Group> groups_;
};

} // namespace kerf::grid
