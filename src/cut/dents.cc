#include "cut/dents.h"

#include "cut/sides.h"
#include "grid/material.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>

namespace kerf::cut {

namespace {

using grid::Items;
using grid::MaterialPiece;

constexpr double round_off = 1e-12; // of a cube, and of its sides

struct PartByPieces {
  grid::Part part;
  std::vector<MaterialPiece> pieces;
  double volume = 0;

  Items items() const { return part.items(); }
};

/// What bounds a part against the cut: the triangles cut - side - cell's vertex of its pieces. Those at segments that
/// are not cut cancel.
struct Opening {
  Vec3 inward; ///< unit; for a dent towards where the cut leaves it
  Vec3 middle; ///< in coordinates of the cell [1]
};

/// None where that has no area.
std::optional<Opening> opening_of(const PartByPieces& dent) {
  const auto area = [](const grid::Tetrahedron& t) -> Vec3 { return 0.5 * (t[2] - t[1]).cross(t[3] - t[1]); };
  Vec3 all = Vec3::Zero(), middle = Vec3::Zero();
  for (const auto& [t, vertex] : dent.pieces)
    all += area(t);
  if (!(all.norm() > round_off))
    return {};
  for (const auto& [t, vertex] : dent.pieces)
    middle += area(t).dot(all) / all.squaredNorm() * (t[1] + t[2] + t[3]) / 3;
  return Opening{all.normalized(), middle}; // outward of a part with positive volume, and so inward of a dent
}

/// How often the border of a part against the cut goes around p, counter-clockwise seen from where the normal points.
int turns(const PartByPieces& part, const Vec3& p, const Vec3& normal) {
  double angle = 0;
  for (const auto& [t, vertex] : part.pieces) {
    const Vec3 a = t[1] - p, b = t[2] - p;
    angle += std::atan2(normal.dot(a.cross(b)), a.dot(b) - normal.dot(a) * normal.dot(b));
  }
  return static_cast<int>(std::lround(angle / (2 * std::numbers::pi)));
}

/// Has a part anything where a dent lies, seen from the cut? What is beyond the cut has not.
bool is_beside(const PartByPieces& part, const Opening& opening) {
  return std::ranges::any_of(part.pieces, [&](const MaterialPiece& piece) {
    return opening.inward.dot(piece.tetrahedron[0] - opening.middle) > round_off;
  });
}

} // namespace

std::vector<Dent> dents(const grid::Solid& solid, const grid::CellId c) {
  std::vector<Dent> result;
  const grid::CellCuts cuts = grid::without_joined(grid::cuts_of(solid, c));
  if (!cuts.is_cut_at_skin())
    return result;
  const grid::Parts parts = grid::parts_of(cuts);
  if (parts.n < 2 || std::ranges::all_of(parts, [](const grid::Part& part) { return part.nodes != 0; }))
    return result;
  if (!all_by_sides(solid, c).empty())
    return result;
  std::vector<PartByPieces> all;
  for (const grid::Part& part : parts) {
    all.push_back({part, grid::pieces_of(solid, c, part.items(), grid::VerticesOfCuts::amid_cuts)});
    for (const MaterialPiece& piece : all.back().pieces)
      all.back().volume += grid::volume(piece.tetrahedron);
  }
  for (const PartByPieces& dent : all) {
    if (dent.part.nodes != 0 || dent.volume >= -round_off)
      continue;
    const auto opening = opening_of(dent);
    if (!opening)
      continue;
    const auto around = std::ranges::find_if(all, [&](const PartByPieces& part) {
      return part.volume > 0 && turns(part, opening->middle, opening->inward) < 0 && is_beside(part, *opening);
    });
    if (around != all.end())
      result.push_back({dent.items(), around->items()});
  }
  return result;
}

} // namespace kerf::cut
