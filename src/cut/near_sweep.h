#pragma once

/// What a blade sweeps, as patches that tell whether they may meet something in a box: a few axes that may part the
/// two.

#include "cut/blade.h"
#include "cut/may_meet.h"
#include "geometry/box_tree.h"

namespace kerf::cut {

/// All that lies between four points: a triangle, one of them twice; or a piece of the blade at two moments, the second
/// one the other way round. [m]
using Patch = std::array<Vec3, 4>;

std::vector<Patch> patches(std::span<const std::array<Vec3, 3>> strip);
std::vector<Patch> patches(const BladePath& path);

class NearSweep {
 public:
  explicit NearSweep(std::vector<Patch> patches);

  /// Around all patches; no box overlaps it when there are none.
  const Box& reach() const { return reach_; }

  /// Calls f(i) for each patch that may meet something in the box, in no order that means anything.
  template <class Function>
  void for_each(const Box& box, const Function& f) const {
    if (!is_in_reach(box))
      return;
    tree_.for_each(box, [&](const std::size_t i) {
      if (may_meet(i, box))
        f(i);
    });
  }

  bool may_be_in(const Box& box) const;

 private:
  struct Axis {
    Vec3 axis;
    Interval patch;
  };

  /// Most boxes are not: told without a call.
  bool is_in_reach(const Box& box) const {
    for (int axis = 0; axis < 3; ++axis)
      if (!(box.lower[axis] <= reach_.upper[axis] && reach_.lower[axis] <= box.upper[axis]))
        return false;
    return true;
  }
  bool may_meet(std::size_t i, const Box& box) const;

  std::vector<Patch> patches_;
  std::vector<std::array<Axis, 4>> axes_; // by patch: its normal, and at right angles to its first side
  geometry::BoxTree tree_;
  Box reach_{Vec3::Constant(1e300), Vec3::Constant(-1e300)};
};

} // namespace kerf::cut
