#pragma once

/// Which corners a physics works on, and how it counts them. Those of crumbs (crumbs.h) move with their rigid bodies:
/// among a thousand crumbs most corners are theirs, and every vector of a solver, every sum over corners, would have
/// them.

#include "grid/solid.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace kerf::grid {

enum class Counted {
  all,      ///< corners have their own numbers
  deforming ///< those of crumbs, and lapsed ones, have none where there are crumbs; unless nothing would be left
};

/// Numbers 0, 1, ... of those corners, in their order. Said by the solid alone, however it came to be what it is.
class CornerNumbers {
 public:
  static constexpr std::uint32_t none = CornerId::no_value;

  CornerNumbers() = default;
  CornerNumbers(const Solid& solid, const Counted counted) : n_(solid.complex.n_corners()) {
    if (counted == Counted::all || !solid.crumbs.any())
      return;
    number_.assign(n_, 0);
    for (const Lapse& lapse : solid.complex.lapsed)
      number_[lapse.corner.value] = none;
    for (std::uint32_t c = 0; c < n_; ++c)
      if (number_[c] != none && !solid.crumbs.holds(CornerId(c))) {
        number_[c] = static_cast<std::uint32_t>(corners_.size());
        corners_.push_back(c);
      } else {
        number_[c] = none;
      }
    if (corners_.empty() || corners_.size() == n_) {
      number_.clear();
      corners_.clear();
    } else {
      n_ = corners_.size();
    }
  }

  bool are_all() const { return number_.empty(); }
  /// Whether each corner that had a number before has it still, so that new numbers come after those.
  bool extend(const CornerNumbers& before) const {
    return are_all() ? before.are_all() && before.n_ <= n_
                     : before.corners_.size() <= corners_.size() && !before.are_all() &&
                         std::equal(before.corners_.begin(), before.corners_.end(), corners_.begin());
  }
  std::size_t size() const { return n_; }
  /// Of a corner; `none` where it is not counted.
  std::uint32_t operator[](const std::uint32_t corner) const { return are_all() ? corner : number_[corner]; }
  bool counts(const std::uint32_t corner) const { return (*this)[corner] != none; }
  /// The corner of a number.
  std::uint32_t corner(const std::size_t number) const {
    return are_all() ? static_cast<std::uint32_t>(number) : corners_[number];
  }
  /// By corner; nothing where they are all.
  std::span<const std::uint32_t> numbers() const { return number_; }

  /// From values by corner to values by number.
  template <class T>
  void gather(const std::vector<T>& of_corners, std::vector<T>& of_numbers) const {
    of_numbers.resize(n_);
    for (std::size_t i = 0; i < n_; ++i)
      of_numbers[i] = of_corners[corner(i)];
  }
  /// And back: other corners keep what they have.
  template <class T>
  void spread(const std::vector<T>& of_numbers, std::vector<T>& of_corners) const {
    for (std::size_t i = 0; i < n_; ++i)
      of_corners[corner(i)] = of_numbers[i];
  }

 private:
  std::size_t n_ = 0;
  std::vector<std::uint32_t> number_, corners_; // empty where they are all
};

} // namespace kerf::grid
