#include "cut/in_plane.h"

#include "geometry/convex_hull.h"

#include <Eigen/Geometry>

namespace kerf::cut {

InPlane::InPlane(const Vec3& point, const Vec3& normal, const double h)
  : origin(point), u(normal.unitOrthogonal() / h), v(normal.cross(u)), w(normal / h) {}

Polygon hull(const Points& points, const InPlane& in_plane) {
  std::vector<Eigen::Vector2d> flat;
  for (const Vec3& p : points)
    flat.push_back(in_plane(p).head<2>());
  Polygon hull;
  for (const Eigen::Vector2d& p : geometry::convex_hull(flat))
    hull.push_back(in_plane.point(p));
  return hull;
}

int draw(const Polygon& piece, const InPlane& in_plane, Raster& raster) {
  int n_new = 0;
  for (std::size_t i = 2; i < piece.size(); ++i)
    n_new += raster.draw({in_plane(piece[0]), in_plane(piece[i - 1]), in_plane(piece[i])}, off_plane);
  return n_new;
}

} // namespace kerf::cut
