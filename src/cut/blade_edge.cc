#include "cut/blade_edge.h"

#include "base/error.h"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace kerf::cut {
namespace {

constexpr double max_turn_of_segment = 5 * std::numbers::pi / 180; ///< of one segment
constexpr double straight = 1e-9;                       ///< sine of the angle at the second point: a line

[[noreturn]] void refuse(const std::string& value, const std::string& rule, const std::string& remedy) {
  throw ParameterError(Complaint{.path = "Edge [m]", .value = value, .rule = rule, .remedy = remedy});
}

/// Appends the arc from a through b to c, without a itself. `number` counts arcs from 1.
void add_arc(const Vec3& a, const Vec3& b, const Vec3& c, const std::size_t number, Points& polyline) {
  const std::string arc = "arc " + std::to_string(number);
  if (!a.allFinite() || !b.allFinite() || !c.allFinite())
    refuse(arc, "must be finite", "Write three numbers a point");
  if (a == b || b == c || c == a)
    refuse(arc, "must have three different points", "Move one of them; a full circle is two arcs");
  const Vec3 ab = b - a, bc = c - b, normal = ab.cross(bc);
  if (normal.norm() < straight * ab.norm() * bc.norm()) {
    if (ab.dot(bc) < 0)
      refuse(arc, "has its three points on a line, and the second not between the others", "Move the second point");
    polyline.push_back(c);
    return;
  }
  const Vec3 axis = normal.normalized(), ac = c - a;
  // Circumcentre of a triangle, from one of its corners.
  const Vec3 to_centre =
    (ac.squaredNorm() * normal.cross(ab) + ab.squaredNorm() * ac.cross(normal)) / (2 * normal.squaredNorm());
  const Vec3 u = -to_centre, w = ac - to_centre;
  double angle = std::atan2(axis.dot(u.cross(w)), u.dot(w));
  if (angle <= 0)
    angle += 2 * std::numbers::pi;
  const int n = std::max(1, static_cast<int>(std::ceil(angle / max_turn_of_segment - 1e-9)));
  for (int i = 1; i < n; ++i)
    polyline.push_back(a + to_centre + Eigen::AngleAxisd(angle * i / n, axis) * u);
  polyline.push_back(c);
}

} // namespace

Points arcs(const Points& points) {
  if (points.size() < 3 || points.size() % 2 == 0)
    refuse(std::to_string(points.size()) + " points", "must have three points for an arc, and two more for each other",
           "Write start, a point between, end; and again a point between, end");
  Points polyline = {points.front()};
  for (std::size_t i = 0; i + 2 < points.size(); i += 2)
    add_arc(points[i], points[i + 1], points[i + 2], i / 2 + 1, polyline);
  return polyline;
}

} // namespace kerf::cut
