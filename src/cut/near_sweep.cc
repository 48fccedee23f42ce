#include "cut/near_sweep.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace kerf::cut {

namespace {

std::vector<Box> boxes_around(const std::vector<Patch>& patches) {
  std::vector<Box> boxes(patches.size());
  std::transform(patches.begin(), patches.end(), boxes.begin(),
                 [](const Patch& patch) { return geometry::box_around(patch); });
  return boxes;
}

/// The axes that part a flat patch, or one that is but a line, from a box, beside those of the box itself.
std::array<Vec3, 4> axes_of(const Patch& patch) {
  const Vec3 along = patch[1] - patch[0];
  return {(patch[2] - patch[0]).cross(patch[3] - patch[1]), along.cross(Vec3::UnitX()), along.cross(Vec3::UnitY()),
          along.cross(Vec3::UnitZ())};
}

} // namespace

std::vector<Patch> patches(const std::span<const std::array<Vec3, 3>> strip) {
  std::vector<Patch> result;
  for (const auto& [a, b, c] : strip)
    result.push_back({a, b, c, c});
  return result;
}

std::vector<Patch> patches(const BladePath& path) {
  std::vector<Patch> result;
  for (std::size_t k = 1; k < path.lines.size(); ++k)
    for (std::size_t i = 1; i < path.lines[k].size(); ++i)
      result.push_back({path.lines[k - 1][i - 1], path.lines[k - 1][i], path.lines[k][i], path.lines[k][i - 1]});
  return result;
}

NearSweep::NearSweep(std::vector<Patch> patches) : patches_(std::move(patches)), tree_(boxes_around(patches_)) {
  for (const Patch& patch : patches_) {
    auto& axes = axes_.emplace_back();
    std::ranges::transform(axes_of(patch), axes.begin(), [&](const Vec3& axis) { return Axis{axis, {patch, axis}}; });
    for (const Vec3& p : patch) {
      reach_.lower = reach_.lower.cwiseMin(p);
      reach_.upper = reach_.upper.cwiseMax(p);
    }
  }
}

bool NearSweep::may_be_in(const Box& box) const {
  if (!is_in_reach(box))
    return false;
  bool is_near = false;
  tree_.for_each(box, [&](const std::size_t i) { is_near = is_near || may_meet(i, box); });
  return is_near;
}

bool NearSweep::may_meet(const std::size_t i, const Box& box) const {
  return std::none_of(axes_[i].begin(), axes_[i].end(),
                      [&](const Axis& a) { return are_apart(a.patch, Interval(box, a.axis), a.axis); });
}

} // namespace kerf::cut
