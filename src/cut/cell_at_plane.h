#pragma once

/// A cell that a plane passes, in which a cut may end (fronts.h, advance.h).

#include "base/function_ref.h"
#include "cut/cut_surface.h"

namespace kerf::cut {

using Polygon = std::vector<Vec3>;

double area(const Polygon& polygon);
Vec3 mean(const Polygon& points);
/// Of the plane nearest to points, unit; the sign has no meaning.
Vec3 normal(const Polygon& points);

struct HalfSpace {
  Vec3 outward;
  double height; ///< outward . p <= height

  double beyond(const Vec3& p) const { return outward.dot(p) - height; }
};
/// What of a convex polygon lies where `beyond` is not positive; between(p, q, t) is on the way from p to q.
template <class Point, class Beyond, class Between>
std::vector<Point> clipped(const std::vector<Point>& polygon, const Beyond& beyond, const Between& between) {
  std::vector<Point> result;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double at_p = beyond(p), at_q = beyond(q);
    if (at_p <= 0)
      result.push_back(p);
    if ((at_p < 0) != (at_q < 0) && at_p != 0 && at_q != 0)
      result.push_back(between(p, q, at_p / (at_p - at_q)));
  }
  return result;
}
/// What of a polygon lies in a half-space.
Polygon clipped(const Polygon& polygon, const HalfSpace& side);

/// The corners of a cell at rest [m].
std::array<Vec3, 8> rest_of(const grid::Solid& solid, grid::CellId c);

/// What a front has passed of its cell: `least` where it has only opened a vertex there (openings.h); more than `most` it
/// has not until the cell is cut, so that what hangs together never comes apart. Were it .98, the rest would hold the cut
/// back by .035 cubes [1].
constexpr double least_passed = 0.02, most_passed = 0.999;

class CellAtPlane {
 public:
  /// The cell's corners at `x`, and the plane there: at rest or as they are now [m]. The plane may be bent: then above it
  /// is what lies above it by more than d . bend d / 2, with d from the plane's point and `bend` its curvature, symmetric
  /// and without a part along the normal [1/m].
  CellAtPlane(const grid::Solid& solid, grid::CellId c, const Plane& plane, const std::array<Vec3, 8>& x,
              const Mat3& bend = Mat3::Zero());

  /// Nodes and points of the skin that lie no farther off the plane than this [m] go to the side that cuts tell.
  void follow_cuts(double room);

  bool is_met() const { return above_ != 0 && above_ != 0xff; }

  /// Do all nodes and points of the skin lie farther off the plane than margin(where they lie) [m], and those that blades
  /// have parted on either side of it?
  bool is_clear(FunctionRef<double(const Vec3&)> margin) const;

  /// Where the plane meets the cube, around, there and at rest, point by point. A plane that only grazes the cell is
  /// moved into it by a little, so that its section has an area.
  struct Section {
    Polygon there, rest;
  };
  Section section() const;

  /// What of the cell's material lies in the plane, there, in pieces; they fill it once.
  std::vector<Polygon> material() const;

  /// The front of a cut that has come as far as `passed` of the section says.
  grid::Front front(const Section& section, double passed) const;

  /// The segments whose ends the plane parts, but that are not cut.
  grid::Segments ahead() const;

 private:
  double height(const Vec3& p) const {
    const Vec3 d = p - plane_.point;
    return height_above(plane_, p) - 0.5 * d.dot(bend_ * d);
  }
  double level() const;
  std::array<double, grid::skeleton::n_items> heights_of_items(const grid::CellCuts& cuts) const;
  Vec3 position(int item) const;
  Vec3 mapped(const Vec3& xi) const;

  const grid::Solid& solid_;
  grid::CellId cell_;
  Plane plane_;
  Mat3 bend_;
  std::array<Vec3, 8> x_;
  std::array<double, 8> height_;
  unsigned above_ = 0;
  double room_; ///< what lies nearer to the plane is on the side that cuts tell [m]
};

/// Would a part of the cell hold on to a neighbour by points of the skin alone? Neighbours that no blade has cut do not
/// say which part holds those (grid/parts.h).
bool hangs_by_skin(const grid::Solid& solid, const grid::Front& front);

} // namespace kerf::cut
