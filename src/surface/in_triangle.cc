#include "surface/in_triangle.h"

#include "surface/crossing.h"

#include <algorithm>
#include <bit>

namespace kerf::surface {

namespace {

namespace skeleton = grid::skeleton;
using grid::Skeleton;
using grid::Solid;

Plane plane_of(const Solid& solid, const View& view, const grid::Segments cuts) {
  return cut_plane(solid, view, std::countr_zero(cuts)).plane;
}

/// The first two of some cuts that have the same label; none where all differ.
grid::Segments of_one_label(const Solid& solid, const View& view, const grid::Segments cuts) {
  const auto label = [&](const grid::Segments cut) { return cut_plane(solid, view, std::countr_zero(cut)).label; };
  for (grid::Segments left = cuts; left != 0; left &= left - 1)
    for (grid::Segments others = left & (left - 1); others != 0; others &= others - 1)
      if (label(left) == label(others))
        return (left & -left) | (others & -others);
  return 0;
}

/// Where the plane of the only cut of a triangle's sides leaves it.
std::optional<Vec3> end_of_cut(const Solid& solid, const View& view, const Skeleton::Side& side,
                               const grid::Segments cut) {
  const Plane plane = plane_of(solid, view, cut);
  const auto i = std::ranges::find(side.segments, std::countr_zero(cut)) - side.segments.begin();
  const auto at = [&](const std::ptrdiff_t k) { return grid::item_point(solid, view.cell, side.items[k % 3]); };
  const Vec3 opposite = at(i + 2);
  const double height = plane.normal.dot(opposite - plane.point);
  for (const Vec3& end : {at(i), at(i + 1)})
    if (const double of_end = plane.normal.dot(end - plane.point); (of_end > 0) != (height > 0))
      return opposite + height / (height - of_end) * (end - opposite);
  return {};
}

/// Has one of them moved along the rim to where it ends (crossing.h)?
bool ends_at_crossing(const Solid& solid, const View& view, const grid::Segments cuts) {
  bool result = false;
  for_each_bit(cuts, [&](const int segment) {
    const grid::SkinCut* const cut = solid.cuts.find(grid::skin_segment(solid.grid, view.cell, segment));
    result = result || (cut && !cut->aside.isZero(0));
  });
  return result;
}

/// On the rim between two cuts, nearest to the plane of a third one.
Vec3 on_rim(const Solid& solid, const View& view, const grid::Segments two, const grid::Segments third) {
  const Vec3 p = plane_of(solid, view, two).point, q = plane_of(solid, view, two & (two - 1)).point;
  const Plane plane = plane_of(solid, view, third);
  const double a = plane.normal.dot(p - plane.point), b = plane.normal.dot(q - plane.point);
  const double inside = ends_at_crossing(solid, view, two) ? short_of_crossing : 1e-3; // of the rim's length
  return p + (a == b ? 0.5 : std::clamp(a / (a - b), inside, 1 - inside)) * (q - p);
}

} // namespace

std::optional<Vec3> point_in_triangle(const Solid& solid, const View& view, const int triangle) {
  const Skeleton::Side& side = view.now.skeleton().side[skeleton::first_triangle + triangle];
  const grid::Segments of = border(side), now = view.now.blades & of, old = view.old_blades & of;
  const grid::Segments first = old != 0 ? old & -old : now & -now,
                       pair = of_one_label(solid, view, std::popcount(old) == 2 ? old : now);
  if (pair != 0)
    return now == pair ? mean_point_of(solid, view, pair) : on_rim(solid, view, pair, now & ~pair);
  if (std::popcount(old) == 2)
    return {};
  const Vec3 p = 0.5 * (mean_point_of(solid, view, first) +
                        end_of_cut(solid, view, side, first)
                          .value_or(middle_of(solid, view, skeleton::first_triangle + triangle)));
  if (now == first)
    return p;
  const auto at = [&](const int k) { return grid::item_point(solid, view.cell, side.items[k]); };
  return meeting_in({at(0), at(1), at(2)}, plane_of(solid, view, first), plane_of(solid, view, now & ~first))
    .value_or(p);
}

} // namespace kerf::surface
