#include "surface/front_end.h"

#include "grid/cube.h"

#include <algorithm>
#include <array>

namespace kerf::surface {

namespace cube = grid::cube;
using grid::CellId;
using grid::Front;
using grid::Solid;

namespace {

constexpr double inside = 0.02; // of a cube: the least distance from the sides, as triangles are to have an area

/// What the plane of a front crosses of a face, from behind the front on.
struct Crossed {
  Vec3 behind, ahead;
  double end; ///< where the front ends, from one to the other; less than 0 or more than 1 beyond them [1]

  Vec3 at(const double t) const { return behind + t * (ahead - behind); }
};

std::optional<Crossed> crossed(const Solid& solid, const Front& front, const CellId c, const int face) {
  const auto nodes = solid.grid.nodes(c);
  std::array<Vec3, 2> ends;
  std::size_t n = 0;
  for (const int line : cube::face_lines[face]) {
    const Vec3 p = solid.grid.position(nodes[cube::line_vertices[line][0]]),
               q = solid.grid.position(nodes[cube::line_vertices[line][1]]);
    const double at_p = front.normal.dot(p - front.point), at_q = front.normal.dot(q - front.point);
    if ((at_p >= 0) != (at_q >= 0) && n < 2)
      ends[n++] = p + at_p / (at_p - at_q) * (q - p);
  }
  if (n < 2)
    return {};
  double first = front.onward.dot(ends[0]), second = front.onward.dot(ends[1]);
  if (second < first) {
    std::swap(first, second);
    std::swap(ends[0], ends[1]);
  }
  const double least = inside * solid.grid.h(); // along the end itself it crosses nowhere
  const double t = second - first > least ? (front.end - first) / (second - first) : front.end > first ? 2 : -1;
  return Crossed{ends[0], ends[1], t};
}

bool is_told(const Front* const front) { return front && front->onward != Vec3::Zero(); }

} // namespace

std::optional<Vec3> end_in_face(const Solid& solid, const CellId c, const int face) {
  for (const CellId of : solid.grid.cells(solid.grid.faces(c)[face]))
    if (const Front* const front = of.valid() ? solid.cuts.front(of) : nullptr; is_told(front))
      if (const auto found = crossed(solid, *front, c, face))
        return found->at(std::clamp(found->end, inside, 1 - inside));
  return {};
}

std::optional<Vec3> end_in_cell(const Solid& solid, const CellId c) {
  const Front* const front = solid.cuts.front(c);
  if (!is_told(front))
    return {};
  Vec3 on_end = Vec3::Zero(), all = Vec3::Zero(), farthest = front->point;
  int n_on_end = 0, n = 0;
  double most = -1;
  for (int face = 0; face < cube::n_faces; ++face)
    if (const auto found = crossed(solid, *front, c, face)) {
      all += found->at(0.5);
      ++n;
      if (found->end >= 0 && found->end <= 1) {
        on_end += found->at(found->end);
        ++n_on_end;
      }
      for (const Vec3& p : {found->behind, found->ahead}) {
        const double far = front->end - front->onward.dot(p);
        if (most < 0 || std::abs(far) < most) {
          most = std::abs(far);
          farthest = p;
        }
      }
    }
  if (n == 0)
    return {};
  const Vec3 end = n_on_end > 0 ? Vec3(on_end / n_on_end) : farthest;
  return end + 2 * inside * (all / n - end);
}

} // namespace kerf::surface
