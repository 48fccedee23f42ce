#include "cut/dents.h"

#include "grid/material.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerf::cut {

namespace {

using grid::Items;
using grid::Joined;
using grid::MaterialPiece;

struct PartByPieces {
  Items items;
  std::vector<MaterialPiece> pieces;
  double volume = 0;
};

/// What bounds a part against the cut: the triangles cut - side - cell's vertex of its pieces. Those at segments that are
/// not cut cancel.
struct Opening {
  Vec3 area = Vec3::Zero(); ///< outward, where the part has material below it [1]
  Vec3 middle = Vec3::Zero();
};
Opening opening_of(const PartByPieces& part) {
  const auto area = [](const grid::Tetrahedron& t) -> Vec3 { return 0.5 * (t[2] - t[1]).cross(t[3] - t[1]); };
  Opening opening;
  for (const auto& [t, vertex] : part.pieces)
    opening.area += area(t);
  for (const auto& [t, vertex] : part.pieces)
    opening.middle += area(t).dot(opening.area) / opening.area.squaredNorm() * (t[1] + t[2] + t[3]) / 3;
  return opening;
}

/// How often the border of a part against the cut goes around p, counter-clockwise seen against the normal.
int turns(const PartByPieces& part, const Vec3& p, const Vec3& normal) {
  double angle = 0;
  for (const auto& [t, vertex] : part.pieces) {
    const Vec3 a = t[1] - p, b = t[2] - p;
    angle += std::atan2(normal.dot(a.cross(b)), a.dot(b) - normal.dot(a) * normal.dot(b));
  }
  return static_cast<int>(std::lround(angle / (2 * std::numbers::pi)));
}

} // namespace

std::vector<Joined> dents(const grid::Solid& solid, const grid::CellId c, const std::vector<Joined>& known) {
  constexpr double round_off = 1e-14; // of a cube
  std::vector<Joined> result;
  const grid::CellCuts cuts = grid::without_joined(grid::cuts_of(solid, c));
  if (!cuts.is_cut_at_skin())
    return result;
  const grid::Parts parts = grid::parts_of(cuts);
  if (parts.n < 2)
    return result;
  std::vector<PartByPieces> all;
  for (const grid::Part& part : parts) {
    all.push_back({part.items(), grid::pieces_of(solid, c, part.items())});
    for (const MaterialPiece& piece : all.back().pieces)
      all.back().volume += grid::volume(piece.tetrahedron);
  }
  for (const PartByPieces& dent : all) {
    if (dent.volume >= -round_off ||
        std::ranges::any_of(known, [&](const Joined& group) { return (group.items & dent.items) != 0 && group.items != dent.items; }))
      continue;
    const auto [area, middle] = opening_of(dent);
    const auto around = std::ranges::find_if(
      all, [&](const PartByPieces& part) { return part.volume > 0 && turns(part, middle, area.normalized()) < 0; });
    if (around == all.end())
      continue;
    const auto same = std::ranges::find_if(result, [&](const Joined& group) { return (group.items & around->items) != 0; });
    if (same != result.end())
      same->items |= dent.items;
    else
      result.push_back({around->items | dent.items, 0});
  }
  return result;
}

} // namespace kerf::cut
