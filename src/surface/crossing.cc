#include "surface/crossing.h"

#include "surface/sight.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>

namespace kerf::surface {

namespace {

namespace skeleton = grid::skeleton;
using grid::Skeleton;

grid::Sides triangles_at(const Skeleton& of, const int spoke) {
  grid::Sides triangles = 0;
  for (const int side : of.segment[spoke].sides)
    triangles |= grid::Sides(1) << (side - skeleton::first_triangle);
  return triangles;
}

class Crossings {
 public:
  Crossings(grid::Solid& solid, const View& view) : solid_(solid), view_(view), of_(view.now.skeleton()) {}

  grid::Sides run() {
    grid::Sides beside = 0;
    for_each_bit(view_.now.blades & skeleton::spokes, [&](const int spoke) {
      const grid::SkinSegment at = grid::skin_segment(solid_.grid, view_.cell, spoke);
      if (!solid_.cuts.find(at)->aside.isZero(0))
        return;
      if (const auto crossing = crossing_of(spoke, at)) {
        solid_.cuts.set_aside(at, (1 - short_of_crossing) * (*crossing - cut_plane(solid_, view_, spoke).plane.point));
        beside |= triangles_at(of_, spoke);
      }
    });
    return beside;
  }

 private:
  using Corners = std::array<Vec3, 3>;

  std::optional<Vec3> crossing_of(const int spoke, const grid::SkinSegment& at) const {
    const auto [plane, label] = cut_plane(solid_, view_, spoke);
    const auto& [first, second] = of_.segment[spoke].ends;
    const Vec3 p = grid::item_point(solid_, view_.cell, first), q = grid::item_point(solid_, view_.cell, second);
    for (const grid::LaterCut& later : solid_.cuts.later_cuts(at))
      if (later.label != label)
        for (grid::Sides left = of_.sides >> skeleton::first_triangle; left != 0; left &= left - 1) {
          const int side = skeleton::first_triangle + std::countr_zero(left);
          if (!is_crossed(side, label) || !is_crossed(side, later.label))
            continue;
          if (const auto crossing = meeting_in(corners(side), plane, {p + later.t * (q - p), later.normal});
              crossing && is_in_plane_with(side, spoke))
            return crossing;
        }
    return {};
  }

  Corners corners(const int side) const {
    const auto at = [&](const int k) { return grid::item_point(solid_, view_.cell, of_.side[side].items[k]); };
    return {at(0), at(1), at(2)};
  }

  /// Do it and both triangles at the spoke lie in one plane?
  bool is_in_plane_with(const int side, const int spoke) const {
    constexpr double round_off = 1e-12; // of h
    const auto [a, b, c] = corners(side);
    const Plane plane{a, (b - a).cross(c - a).normalized()};
    return std::ranges::all_of(of_.segment[spoke].sides, [&](const int at_spoke) {
      return std::ranges::all_of(corners(at_spoke), [&](const Vec3& p) {
        return std::abs(height(p, plane)) < round_off * solid_.grid.h();
      });
    });
  }

  /// Does a cut meet two of the triangle's segments?
  bool is_crossed(const int side, const grid::CutLabel label) const {
    const auto& segments = of_.side[side].segments;
    return std::count_if(segments.begin(), segments.begin() + 3, [&](const int segment) {
             const grid::SkinSegment at = grid::skin_segment(solid_.grid, view_.cell, segment);
             const grid::SkinCut* const cut = solid_.cuts.find(at);
             return (cut && cut->label == label) ||
                    std::ranges::any_of(solid_.cuts.later_cuts(at),
                                        [&](const grid::LaterCut& later) { return later.label == label; });
           }) > 1;
  }

  grid::Solid& solid_;
  const View& view_;
  const Skeleton& of_;
};

} // namespace

bool has_crossings(const grid::Solid& solid, const grid::CellId cell) {
  if (!solid.cuts.has_later_cuts())
    return false;
  const Skeleton& of = grid::cuts_of(solid, cell).skeleton();
  for (grid::Segments left = of.segments & skeleton::spokes; left != 0; left &= left - 1)
    if (const grid::SkinCut* const cut =
          solid.cuts.find(grid::skin_segment(solid.grid, cell, std::countr_zero(left)));
        cut && !cut->aside.isZero(0))
      return true;
  return false;
}

grid::Sides take_back_crossings(grid::Solid& solid, const View& view) {
  grid::Sides beside = 0;
  for_each_bit(view.now.blades & skeleton::spokes, [&](const int spoke) {
    const grid::SkinSegment at = grid::skin_segment(solid.grid, view.cell, spoke);
    if (!solid.cuts.find(at)->aside.isZero(0))
      beside |= triangles_at(view.now.skeleton(), spoke);
    solid.cuts.set_aside(at, Vec3::Zero());
  });
  return beside;
}

grid::Sides move_to_crossings(grid::Solid& solid, const View& view) {
  return solid.cuts.has_later_cuts() ? Crossings(solid, view).run() : 0;
}

} // namespace kerf::surface
