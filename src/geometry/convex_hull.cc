#include "geometry/convex_hull.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/convex_hull_2.h>

#include <iterator>

namespace kerf::geometry {

std::vector<Eigen::Vector2d> convex_hull(const std::vector<Eigen::Vector2d>& points) {
  using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_2;
  std::vector<Point> in, out;
  for (const Eigen::Vector2d& p : points)
    in.emplace_back(p[0], p[1]);
  CGAL::convex_hull_2(in.begin(), in.end(), std::back_inserter(out));
  std::vector<Eigen::Vector2d> hull;
  for (const Point& p : out)
    hull.emplace_back(p.x(), p.y());
  return hull;
}

} // namespace kerf::geometry
