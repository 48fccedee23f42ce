#include "cut/moving_edge.h"

#include "geometry/predicates.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <limits>
#include <tuple>

namespace kerf::cut {
namespace {

/// A segment and a piece of the polyline between two moments.
struct Encounter {
  std::array<Segment, 2> edge, piece; ///< at the two moments [m]

  /// D at a corner of the unit cube: bits 0, 1, 2 of `corner` are t, s, f.
  Vec3 difference(const int corner) const {
    const int t = corner & 1, s = corner >> 1 & 1, f = corner >> 2;
    return edge[f][t] - piece[f][s];
  }
};

/// The corners of the tetrahedra that share the cube's diagonal: from 0 to 7, one axis after the other.
constexpr std::array<std::array<int, 4>, 6> tetrahedra = {
  {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}}};

/// Whether the origin, displaced as the predicates do it, lies inside: on the same side of all four faces.
bool holds_origin(const std::array<Vec3, 4>& v) {
  const Vec3 origin = Vec3::Zero();
  const int s = geometry::side(origin, {v[1], v[2], v[3]});
  return s != 0 && s == geometry::side(origin, {v[0], v[3], v[2]}) && s == geometry::side(origin, {v[0], v[1], v[3]}) &&
         s == geometry::side(origin, {v[0], v[2], v[1]});
}

/// Where in the unit cube the linear map of a tetrahedron is zero: (t, s, f), rounded.
Vec3 zero_of(const std::array<int, 4>& corners, const std::array<Vec3, 4>& v) {
  const auto place = [](const int corner) { return Vec3(corner & 1, corner >> 1 & 1, corner >> 2); };
  Mat3 values, places;
  for (int i = 0; i < 3; ++i) {
    values.col(i) = v[i + 1] - v[0];
    places.col(i) = place(corners[i + 1]) - place(corners[0]);
  }
  const Vec3 weights = values.fullPivLu().solve(-v[0]);
  const Vec3 zero = place(corners[0]) + places * weights;
  return zero.allFinite() ? Vec3(zero.cwiseMax(0).cwiseMin(1)) : Vec3::Constant(0.5); // flat, but for rounding
}

/// Every meeting of a step, of which the one nearest to the segment's lower end is kept.
class Meetings {
 public:
  /// `duration`: of the part of the step that lies between its two moments [1].
  void add(const Encounter& encounter, const double duration) {
    std::array<Vec3, 8> differences;
    Vec3 lower = Vec3::Constant(std::numeric_limits<double>::infinity()), upper = -lower;
    for (int corner = 0; corner < 8; ++corner) {
      differences[corner] = encounter.difference(corner);
      lower = lower.cwiseMin(differences[corner]);
      upper = upper.cwiseMax(differences[corner]);
    }
    if ((lower.array() > 0).any() || (upper.array() < 0).any())
      return;
    for (const auto& corners : tetrahedra) {
      const std::array v = {differences[corners[0]], differences[corners[1]], differences[corners[2]],
                            differences[corners[3]]};
      if (holds_origin(v))
        add(encounter, duration, zero_of(corners, v));
    }
  }

  const Verdict& verdict() const { return verdict_; }

 private:
  void add(const Encounter& encounter, const double duration, const Vec3& at) {
    if (verdict_.n_crossings++ > 0 && at[0] >= verdict_.t)
      return;
    const auto& [before, after] = encounter.piece;
    const double s = at[1], f = at[2];
    const Vec3 along = (1 - f) * (before[1] - before[0]) + f * (after[1] - after[0]); // where it turns, that changes
    const Vec3 moved = (1 - s) * (after[0] - before[0]) + s * (after[1] - before[1]);
    verdict_.t = at[0];
    verdict_.normal = along.cross(moved);
    verdict_.along = duration * along;
  }

  Verdict verdict_;
};

Segment between(const Segment& before, const Segment& now, const double f) {
  return {(1 - f) * before[0] + f * now[0], (1 - f) * before[1] + f * now[1]};
}

} // namespace

Verdict meet(const BladePath& path, const Segment& before, const Segment& now) {
  Meetings meetings;
  for (std::size_t k = 1; k < path.lines.size(); ++k) {
    const Points &from = path.lines[k - 1], &to = path.lines[k];
    const std::array edge = {between(before, now, path.fractions[k - 1]), between(before, now, path.fractions[k])};
    for (std::size_t i = 0; i + 1 < from.size(); ++i)
      meetings.add({edge, {Segment{from[i], from[i + 1]}, Segment{to[i], to[i + 1]}}},
                   path.fractions[k] - path.fractions[k - 1]);
  }
  return meetings.verdict();
}

} // namespace kerf::cut
