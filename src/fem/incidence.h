#pragma once

/// Which copies hold which corners, in both directions, kept up to date as cuts change a few copies at a time. Copies
/// of crumbs (grid/crumbs.h) hold none.

#include "grid/solid.h"

#include <span>
#include <vector>

namespace kerf::fem {

class Incidence {
 public:
  explicit Incidence(const grid::Solid& solid);

  /// Takes over copies that are new, or hold other corners now. Returns the corners of them, before or now, ascending:
  /// for all others nothing has changed. Costs as much as there are changed copies, beside corners' moving up.
  std::vector<std::uint32_t> update(const grid::Solid& solid, std::span<const grid::CopyId> changed);

  std::size_t n_copies() const { return corners_.size() / 8; }
  std::size_t n_corners() const { return users_.size(); }
  bool is_used(const std::size_t copy) const { return corners_[8 * copy] != unused; }
  /// The 8 corners of a copy that is used, in deal.II's vertex order.
  const std::uint32_t* corners(const std::size_t copy) const { return corners_.data() + 8 * copy; }
  /// 8 copy + vertex of all that hold a corner, ascending: the order in which sums over copies are taken.
  std::span<const std::uint32_t> users(const std::size_t corner) const {
    return {slots_.data() + users_[corner].first, users_[corner].size};
  }

 private:
  static constexpr std::uint32_t unused = grid::CornerId::no_value;
  struct Range {
    std::uint32_t first = 0, size = 0, capacity = 0;
  };

  void add(std::uint32_t corner, std::uint32_t user);
  void remove(std::uint32_t corner, std::uint32_t user);

  std::vector<std::uint32_t> corners_; // 8 a copy
  std::vector<Range> users_;           // by corner: its part of slots_
  std::vector<std::uint32_t> slots_;
};

} // namespace kerf::fem
